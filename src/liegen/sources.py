"""Factors from a Python file, from a dotted module, or from the library."""

from __future__ import annotations

import ast
import difflib
import hashlib
import importlib
import importlib.util
import os
import sys
from collections.abc import Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

from liegen.define import Function
from liegen.errors import DefinitionError, Site, SourceError
from liegen.modules import group_functions, group_named
from liegen.user_code import guarded

AnyFunction = Function[..., Any]
LIBRARY = "liegen.library"


def load(source: str | None, groups: Iterable[str] = ()) -> tuple[AnyFunction, ...]:
    """The factors and functions of a source, in the order of their definition.

    ``None`` is the library, a path that ends in ``.py`` a file (its folder is put on ``sys.path``, so that it
    may import its neighbours), anything else a dotted module. What a source imports with an ``import``
    statement is not its own and does not count; a package's imports from its own modules do. A result of
    ``vary``, ``fix`` or ``bind`` counts where it gets its name. With names of ``groups`` there is no source:
    these are the functions of their modules. Raises SourceError for a source that cannot be imported or has
    no factor and for an unknown group, DefinitionError for a factor that liegen refuses and for two with one
    name.
    """
    names = tuple(dict.fromkeys(groups))
    if names:
        return _of_groups(source, names)
    name = source if source is not None else LIBRARY
    module, tree = _import_file(Path(name)) if _is_file(name) else _import_module(name)
    _refuse_redefinitions(module, tree)
    foreign = _imported_names(tree, module)
    values: dict[str, Any] = vars(module)
    functions: dict[str, AnyFunction] = {
        key: value for key, value in values.items() if _is_function(value) and key not in foreign
    }
    _refuse_twins(module, tree, functions)
    if not functions:
        raise SourceError(f"{name} defines no factor; write one with @factor (from liegen import factor)")
    return tuple({id(f): f for f in functions.values()}.values())


def _of_groups(source: str | None, names: Sequence[str]) -> tuple[AnyFunction, ...]:
    if source is not None:
        raise SourceError(f"give either the source {source} or --group {names[0]}, not both")
    return tuple(f for name in names for f in group_functions(group_named(name)))


def select(functions: Sequence[AnyFunction], names: Iterable[str]) -> tuple[AnyFunction, ...]:
    """The functions with the given names, in their own order; all of them when no name is given.

    Raises SourceError for an unknown name, with the names that come near.
    """
    wanted = list(names)
    known = [f.name for f in functions]
    for name in wanted:
        if name not in known:
            near = difflib.get_close_matches(name.lower(), known, 3) or [k for k in known if name in k]
            hint = f"did you mean {' or '.join(near)}? " if near else ""
            raise SourceError(f"there is no factor {name!r}; {hint}there are: {', '.join(known)}")
    return tuple(f for f in functions if not wanted or f.name in wanted)


def _is_function(value: Any) -> bool:
    return isinstance(value, Function)


def _is_file(source: str) -> bool:
    return source.endswith(".py") or "/" in source or "\\" in source or Path(source).is_file()


_GIVE = "give a Python file with factors, or a dotted module"


def _refuse_folder(name: str) -> None:
    if name and Path(name).is_dir():
        raise SourceError(f"{name} is a folder; {_GIVE}")


def _import_file(path: Path) -> tuple[ModuleType, ast.Module]:
    """Run a file as a module under a name of its own, so that it hides no other module.

    Its folder comes first on ``sys.path`` while the file runs, and last afterwards: a neighbour with the name
    of a package does not hide what liegen itself still has to load.
    """
    _refuse_folder(str(path))
    if not path.is_file():
        raise SourceError(f"{path} does not exist; {_GIVE}")
    place = path.resolve()
    key = hashlib.sha256(os.fsencode(place)).hexdigest()[:8]
    module = ModuleType(f"_liegen_{place.stem}_{key}")
    module.__file__ = str(place)
    try:
        text = place.read_bytes()
    except OSError as error:
        raise SourceError(f"{path} cannot be read: {error.strerror}") from None
    with guarded(str(path), str(place)), _first_on_path(str(place.parent)):
        tree = ast.parse(text, str(place))
        code = compile(text, str(place), "exec", dont_inherit=True)
        sys.modules[module.__name__] = module
        exec(code, vars(module))
    return module, tree


@contextmanager
def _first_on_path(folder: str) -> Generator[None]:
    importlib.import_module("casadi")  # needed while factors are traced, with the folder in front
    if folder in sys.path:
        yield
        return
    sys.path.insert(0, folder)
    try:
        yield
    finally:
        sys.path[:] = [entry for entry in sys.path if entry != folder] + [folder]


def _import_module(name: str) -> tuple[ModuleType, ast.Module]:
    """Import a dotted module as ``python -m`` would: the current folder counts."""
    if not all(part.isidentifier() for part in name.split(".")):
        _refuse_folder(name)
        raise SourceError(f"{name!r} is neither a Python file nor a dotted module")
    with _first_on_path(str(Path.cwd())):
        return _imported(name)


def _imported(name: str) -> tuple[ModuleType, ast.Module]:
    spec: Any = _spec(name)
    if spec is None or spec.origin is None:
        _refuse_folder(name)
    if spec is None:
        file = Path(*name.split(".")).with_suffix(".py")
        hint = f"; did you mean the file {file}?" if file.is_file() else "; a file ends in .py"
        raise SourceError(f"there is no module {name!r}{hint}")
    with guarded(name, str(spec.origin)):
        module = importlib.import_module(name)
        return module, _tree(module)


def _spec(name: str) -> Any:
    """Where a module is; None where there is none. Runs the packages above."""
    with guarded(name, ""):
        try:
            return importlib.util.find_spec(name)
        except ModuleNotFoundError as error:
            if error.name is not None and (name + ".").startswith(error.name + "."):
                return None
            raise


def _tree(module: ModuleType) -> ast.Module:
    """The module's source, empty where there is none."""
    file = vars(module).get("__file__")
    source = Path(file).read_bytes() if file and file.endswith(".py") else b""
    return ast.parse(source)


def _imported_names(tree: ast.Module, module: ModuleType) -> set[str]:
    """Names that import statements bind at the module's top, those from a package's own modules left out."""
    is_package = "__path__" in vars(module)
    names: set[str] = set()
    for node in _top_level(tree.body):
        if isinstance(node, ast.Import):
            names |= {alias.asname or alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            own = node.level == 1 or (node.module or "").startswith(module.__name__ + ".")
            if not (is_package and own):
                names |= {n for alias in node.names for n in _bound(alias, node, module)}
    return names


def _bound(alias: ast.alias, node: ast.ImportFrom, module: ModuleType) -> list[str]:
    if alias.name != "*":
        return [alias.asname or alias.name]
    package = module.__name__ if "__path__" in vars(module) else module.__name__.rpartition(".")[0]
    name = importlib.util.resolve_name("." * node.level + (node.module or ""), package)
    other = sys.modules.get(name)
    return [key for key, value in vars(other).items() if vars(module).get(key) is value] if other else []


def _top_level(body: Sequence[ast.stmt]) -> Iterable[ast.stmt]:
    """Statements that run when the module is imported, with those inside of if, try and with."""
    for node in body:
        yield node
        if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            inner = [n for n in ast.iter_child_nodes(node) if isinstance(n, (ast.stmt, ast.ExceptHandler))]
            for n in inner:
                yield from _top_level(n.body if isinstance(n, ast.ExceptHandler) else [n])


def _refuse_redefinitions(module: ModuleType, tree: ast.Module) -> None:
    """Two ``def`` of one name: Python keeps the second alone, silently."""
    first: dict[str, int] = {}
    file = _file_name(module)
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and node.decorator_list:
            before = first.setdefault(node.name, node.lineno)
            if before != node.lineno and _is_function(vars(module).get(node.name)):
                raise DefinitionError(
                    f"{Site(file, node.lineno)}: there is another factor {node.name!r} "
                    f"at {Site(file, before)}; rename one of them"
                )


def _refuse_twins(module: ModuleType, tree: ast.Module, functions: Mapping[str, AnyFunction]) -> None:
    """Two different factors that call themselves the same, as results of vary, fix and bind may."""
    first: dict[str, str] = {}
    file, lines = _file_name(module), _bindings(tree)
    for key, f in functions.items():
        other = first.setdefault(f.name, key)
        if functions[other] is not f:
            places = " and ".join(f"{k} ({Site(file, lines[k])})" if k in lines else k for k in (other, key))
            raise DefinitionError(
                f"{places} are two factors with the name {f.name!r}; rename one of them, "
                "with name=... in @factor, @function, vary, fix or bind"
            )


def _bindings(tree: ast.Module) -> dict[str, int]:
    """The line where each name is first defined."""
    lines: dict[str, int] = {}
    for node in _top_level(tree.body):
        targets = node.targets if isinstance(node, ast.Assign) else []
        names = [target.id for target in targets if isinstance(target, ast.Name)]
        for name in [node.name] if isinstance(node, ast.FunctionDef) else names:
            lines.setdefault(name, node.lineno)
    return lines


def _file_name(module: ModuleType) -> str:
    return Path(getattr(module, "__file__", None) or module.__name__).name
