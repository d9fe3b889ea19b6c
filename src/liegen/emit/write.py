"""Writing a generated tree: all of it or nothing, and never over a file that liegen did not write."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from liegen.errors import OutputError

from .journal import Changes, NotUndoneError, apply, left_behind, locked, recovered, why
from .manifest import check_owner, check_shared, manifest_path, manifests, read_manifest
from .tree import folders, on_disk

#: Foreign files that an error message names, and characters of a path.
NAMED, SHOWN = 5, 200


@dataclass(frozen=True)
class Written:
    """What :func:`write_tree` did: paths that were written, left as they were, and removed.

    ``undone``: whether a run that was killed had left half of its changes, which were put back first.
    """

    written: tuple[str, ...]
    unchanged: tuple[str, ...]
    removed: tuple[str, ...]
    undone: bool = False


def write_tree(files: Mapping[str, str], directory: Path) -> Written:
    """Write the files of :func:`render` into a folder, which is made if need be.

    Files that the old manifest lists and ``files`` does not have are removed. Files of other packages in the
    folder stay, each package has its own manifest. All changes happen or none, see
    :mod:`liegen.emit.journal`: a failure puts back what was there, and what a killed process left half done
    is put back first. A second process waits. Raises :class:`OutputError`, with nothing changed, where the
    folders hold files that liegen did not write or that belong to another package, or where writing fails.
    """
    shown = _shown(directory)
    try:
        _check_place(directory)
        with _made(directory), locked(directory):
            undone = recovered(directory)
            return _write(files, directory, bool(undone))
    except NotUndoneError as error:
        raise OutputError(
            f"cannot write to {shown}: {error}. These could not be put back, so the folder is half written; "
            "mend that and run liegen again: it puts back the rest first"
        ) from error
    except OSError as error:
        raise OutputError(f"cannot write to {shown}: {why(error)}; nothing was changed") from error


def put_back(directory: Path) -> bool:
    """Undo what a killed run left half done in a folder: whether there was such a run.

    Waits for a run that is alive. Raises :class:`OutputError` where that fails.
    """
    try:
        if not left_behind(directory):
            return False
        with locked(directory):
            return bool(recovered(directory))
    except OSError as error:
        raise OutputError(
            f"a run of liegen was killed while it wrote to {_shown(directory)}; "
            f"what it changed cannot be put back: {why(error)}"
        ) from error


def _write(files: Mapping[str, str], directory: Path, undone: bool) -> Written:
    manifest = manifest_path(files)
    own = read_manifest(directory / manifest)
    others = [m for m in manifests(directory) if m.path.name != manifest]
    check_owner(files[manifest], own)
    check_shared(files, others)
    listed = set(own.files) if own else set[str]()
    theirs = {path for other in others for path in other.files}
    present = set(on_disk(directory, folders([*files, *listed]))) - theirs
    same = {path for path in [*present, manifest] if path in files and _same(directory / path, files[path])}
    _refuse_foreign(sorted(present - listed - same), directory)
    removed = tuple(sorted((listed & present) - set(files)))
    fresh = [path for path in files if path not in same and path != manifest]
    fresh += [] if manifest in same else [manifest]
    if fresh or removed:
        changes = _changes(directory, fresh, removed)
        apply(directory, files, changes)
    return Written(tuple(fresh), tuple(sorted(same)), removed, undone)


def _changes(directory: Path, fresh: Sequence[str], removed: Sequence[str]) -> Changes:
    for path in fresh:
        if (directory / path).is_dir() and not (directory / path).is_symlink():
            raise OutputError(
                f"{directory / path} is a folder where a file is to be written; nothing was changed. "
                "Remove it, or choose another folder"
            )
    had = [path for path in fresh if (directory / path).exists() or (directory / path).is_symlink()]
    made = [top for top in folders(fresh) if not (directory / top).exists()]
    return Changes(tuple(fresh), tuple(removed), (*had, *removed), tuple(made))


def _check_place(directory: Path) -> None:
    if "\0" in str(directory):
        raise OutputError("the path of an output folder cannot hold a null character")
    try:
        directory.absolute()
    except FileNotFoundError:
        raise OutputError(
            "the current folder was removed; change to another one, or give the output folder's full path"
        ) from None
    existing = next((p for p in (directory, *directory.parents) if p.exists() or p.is_symlink()), None)
    if existing and not existing.is_dir():
        said = f"{_shown(existing)} is a {'file' if existing.exists() else 'link to nothing'}"
        said += "" if existing == directory else f", so nothing can be written to {_shown(directory)}"
        raise OutputError(f"{said}; choose another folder")
    _check_no_part(directory)


def _check_no_part(directory: Path) -> None:
    """Raise OutputError for a folder that another tree has for its files, such as its ``c``."""
    place = directory.resolve()
    try:
        above = manifests(place.parent)
    except OutputError:  # a file that is damaged lists nothing
        return
    for manifest in above:
        if any(path.startswith(f"{place.name}/") for path in manifest.files):
            raise OutputError(
                f"{_shown(directory)} is a part of the tree of {manifest.source or 'the library'}, as "
                f"{manifest.path.name} in the folder above it lists; nothing was changed. "
                "Choose another folder"
            )


def _shown(directory: Path) -> str:
    text = str(directory)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}... ({len(text)} characters)"


def _same(path: Path, text: str) -> bool:
    return path.is_file() and not path.is_symlink() and path.read_bytes() == text.encode()


def _refuse_foreign(foreign: Sequence[str], directory: Path) -> None:
    if foreign:
        names = ", ".join(foreign[:NAMED]) + (f" and {len(foreign) - NAMED} more" if foreign[NAMED:] else "")
        raise OutputError(
            f"{directory} holds files that liegen did not write: {names}; nothing was changed. "
            "Choose another folder, or move these files away"
        )


@contextmanager
def _made(directory: Path) -> Generator[None]:
    """Make the folder and those above, and take away again those that were made when the block fails."""
    made: list[Path] = []
    try:
        for place in [*reversed(directory.parents), directory]:
            if not place.exists():
                place.mkdir(exist_ok=True)
                made.append(place)
        yield
    except BaseException:
        for place in reversed(made):
            with suppress(OSError):
                place.rmdir()
        raise
