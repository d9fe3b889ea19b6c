"""Checks that every name of a factor is one that every target can spell."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Sequence

from liegen.errors import DefinitionError
from liegen.kernel import Kernel

from .targets import TARGETS

#: Names that generated code, or whoever imports it, gives a meaning of its own.
RESERVED = frozenset({"res", "out", "np"}).union(*(target.reserved for target in TARGETS))
#: How the output of a factor, and the single output of a function, is called: reserved for just that.
UNNAMED = frozenset({"res", "out"})
FILES = frozenset[str]().union(*(target.files for target in TARGETS))
#: A field of a named tuple must not hide one of its methods.
TUPLE_METHODS = frozenset({"count", "index"})

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_TEMPORARY = re.compile(r"t[0-9]+")


def check_names(kernels: Sequence[Kernel], package: str) -> None:
    """Return nothing. Raises :class:`DefinitionError` with the factor, the name, the line and the cure."""
    _check_package(package)
    for kernel in kernels:
        _check_kernel(kernel)
    _check_together(kernels, package)


def _complaint(name: str) -> str:
    """Why a name cannot be used anywhere, or nothing."""
    if not _IDENTIFIER.fullmatch(name):
        return "is no C identifier (letters, digits and underscores, a letter first)"
    if "__" in name:
        return "holds a double underscore, which C++ keeps for itself"
    languages = [language for t in TARGETS for language, known in t.keywords.items() if name in known]
    return f"is a {languages[0]} keyword" if languages else ""


def _reserved(name: str) -> str:
    if name in RESERVED:
        return "is reserved for the generated code"
    return "is the name of a temporary in the generated code" if _TEMPORARY.fullmatch(name) else ""


def _refuse(subject: str, name: str, complaint: str) -> None:
    if complaint:
        raise DefinitionError(f"{subject} {complaint}; rename it, for example to {_proposal(name)!r}")


def _proposal(name: str) -> str:
    stem = re.sub(r"_D_|[^A-Za-z0-9]+", "_", name).strip("_")
    stem = stem if stem[:1].isalpha() else f"v_{stem}".rstrip("_")
    return f"{stem}_1" if stem == name or _complaint(stem) or _reserved(stem) else stem


def _check_package(package: str) -> None:
    complaint = _complaint(package)
    if not complaint and package == "c":
        complaint = "is the name of the folder of the C code"
    if not complaint and package in FILES:
        complaint = "would make a header that hides one of C's own"
    if not complaint and package in {"liegen", "numpy", *sys.stdlib_module_names}:
        complaint = "would hide the Python module of that name"
    _refuse(f"package name {package!r}", package, complaint)


def _check_kernel(kernel: Kernel) -> None:
    where = f"{kernel.name} ({kernel.site})"
    complaint = _complaint(kernel.name) or _reserved(kernel.name)
    if not complaint and kernel.name in FILES:
        complaint = "would make a file that hides one of C's headers or of the package's modules"
    _refuse(f"factor {kernel.name!r} ({kernel.site}): its name", kernel.name, complaint)
    outputs = [o.name for o in kernel.outputs]
    called = _public(kernel)
    seen: set[str] = set()
    for name in (a.name for a in kernel.arguments):
        complaint = _complaint(name) or _reserved(name) or _clash(name, seen, outputs)
        if not complaint and name in called:
            complaint = "is also the name of a generated function"
        _refuse(f"{where}: argument {name!r}", name, complaint)
        seen.add(name)
    seen = set()
    for name in outputs:
        complaint = _complaint(name) or ("" if name in UNNAMED else _reserved(name)) or _clash(name, seen, ())
        if not complaint and name in TUPLE_METHODS:
            complaint = "is a method of every named tuple"
        _refuse(f"{where}: output {name!r}", name, complaint)
        seen.add(name)


def _public(kernel: Kernel) -> list[str]:
    """What the code of a kernel defines in any language."""
    return sorted({name for target in TARGETS for name in target.public(kernel)})


def _clash(name: str, seen: Iterable[str], outputs: Iterable[str]) -> str:
    if name in seen:
        return "occurs twice"
    if name in outputs:
        return "is also the name of an output"
    return (
        "looks like the name of a Jacobian ('_D_' stands between an output and a variable)"
        if "_D_" in name
        else ""
    )


def _check_together(kernels: Sequence[Kernel], package: str) -> None:
    """Two factors must not define one name, on file systems that ignore case either."""
    owners: dict[str, tuple[Kernel, str]] = {}
    shared = {s.path.format(package=package).lower() for t in TARGETS for s in t.package_sheets}
    for kernel in kernels:
        own = [s.path.format(package=package, factor=kernel.name) for t in TARGETS for s in t.factor_sheets]
        both = [path for path in own if path.lower() in shared]
        if both:
            raise DefinitionError(
                f"factor {kernel.name!r} ({kernel.site}) would make the same file as the package "
                f"{package!r}, {both[0]}; rename one of them"
            )
        for name in _public(kernel):
            other, theirs = owners.setdefault(name.lower(), (kernel, name))
            if other is not kernel:
                raise DefinitionError(_together(kernel, name, other, theirs))


def _together(kernel: Kernel, name: str, other: Kernel, theirs: str) -> str:
    both = f"factors {other.name!r} ({other.site}) and {kernel.name!r} ({kernel.site})"
    if kernel.name == other.name:
        return f"{both} have one name; rename one of them"
    if kernel.name.lower() == other.name.lower():
        return f"{both} differ only in case, so some file systems give them one file; rename one of them"
    made = theirs if name == theirs else f"{theirs} and {name}"
    return f"{both} would both generate {made}; rename one of them"
