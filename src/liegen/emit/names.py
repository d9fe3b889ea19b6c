"""Checks that every name of a factor is one that every target can spell."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from liegen.errors import DefinitionError
from liegen.kernel import Kernel
from liegen.names import (
    PACKAGE_SYMBOLS,
    check_arguments,
    check_factor_name,
    check_outputs,
    complaint,
    macro,
    refuse,
    shown,
    taken,
)

from .targets import TARGETS

FILES = frozenset[str]().union(*(target.files for target in TARGETS))


def check_names(kernels: Sequence[Kernel], package: str) -> None:
    """Return nothing. Raises :class:`DefinitionError` with the factor, the name, the line and the cure."""
    _check_package(package)
    for kernel in kernels:
        _check_kernel(kernel)
        _check_symbols(kernel, package)
    _check_together(kernels, package)


def _check_package(package: str) -> None:
    why = complaint(package)
    if not why and package == "c":
        why = "is the name of the folder of the C code"
    if not why and package in FILES:
        why = "would make a header that hides one of C's own"
    if not why and package in {"liegen", "numpy", *sys.stdlib_module_names}:
        why = "would hide the Python module of that name"
    refuse(f"package name {shown(package)}", package, why)


def _check_kernel(kernel: Kernel) -> None:
    where, site = f"{kernel.name} ({kernel.site})", str(kernel.site)
    check_factor_name(kernel.name, site)
    why = "would make a file that hides one of C's headers or of the package's modules"
    refuse(f"factor {kernel.name!r} ({site}): its name", kernel.name, why if kernel.name in FILES else "")
    outputs, called = [o.name for o in kernel.outputs], _public(kernel)
    check_outputs(where, outputs)
    check_arguments(where, [a.name for a in kernel.arguments], outputs)
    for name in (a.name for a in kernel.arguments):
        why = "is also the name of a generated function" if name in called else ""
        refuse(f"{where}: argument {name!r}", name, why)


def _check_symbols(kernel: Kernel, package: str) -> None:
    """The names in C with the package before them: not those of C's library, nor of the package itself."""
    for name in _public(kernel):
        symbol, upper = f"{package}_{name}", f"{package}_{name}_H".upper()
        own = name in PACKAGE_SYMBOLS or upper.removeprefix(f"{package}_".upper()) in PACKAGE_SYMBOLS
        if own or symbol in taken()["declarations"] or macro(symbol):
            whose = "the package itself" if own else "C's library"
            raise DefinitionError(
                f"factor {kernel.name!r} ({kernel.site}) in the package {package!r} would make {symbol} in "
                f"C, which is a name of {whose}; rename one of them"
            )
    taken_by = {f"{package}_{name}" for name in (*PACKAGE_SYMBOLS, *_public(kernel))}
    taken_by.add(f"{package}_RESTRICT".upper())
    ports = [port.name for port in kernel.jacobians.outputs]
    for name in (*(a.name for a in kernel.arguments), *ports):
        if name in taken_by:
            raise DefinitionError(
                f"{kernel.name} ({kernel.site}): {name!r} is also a name in the C of the package "
                f"{package!r}; rename it, or the package"
            )


def _public(kernel: Kernel) -> list[str]:
    """What the code of a kernel defines in any language."""
    return sorted({name for target in TARGETS for name in target.public(kernel)})


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
