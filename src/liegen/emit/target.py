"""``Target``: what one language needs to be emitted. A new language is one more row, nothing else changes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from liegen.kernel import Kernel
from liegen.names import macro


@dataclass(frozen=True)
class Options:
    """What the caller chose: package, the command that regenerates it, the Jacobians' layout, the scalars."""

    package: str
    regenerate: str
    layout: str = "row"
    scalar: str = "double"


@dataclass(frozen=True)
class Sheet:
    """A template and the path of what it makes, a pattern in ``package`` and ``factor``.

    ``scalar``: made only where this scalar is chosen.
    """

    template: str
    path: str
    scalar: str = ""

    def made(self, options: Options) -> bool:
        """Whether the caller's choice includes it."""
        return self.scalar in ("", options.scalar)


@dataclass(frozen=True)
class Target:
    """A language: its printer (from a kernel to the names that a template lays out) and its files.

    ``public`` lists what the code of a kernel defines for its users, without a prefix that all share.
    ``files`` are names whose file would hide another one; no factor may be called so. ``package_names``
    are what the package's templates lay out beside the factors. What a language and the templates keep for
    themselves is listed in ``liegen/names/keywords.py``.
    """

    name: str
    printer: Callable[[Kernel, Options], Mapping[str, object]]
    public: Callable[[Kernel], tuple[str, ...]]
    files: frozenset[str]
    factor_sheets: tuple[Sheet, ...]
    package_sheets: tuple[Sheet, ...]
    package_names: Mapping[str, object] = field(default_factory=dict[str, object])


def words(text: str) -> frozenset[str]:
    """A set of words."""
    return frozenset(text.split())


def scalar_names(kernel: Kernel) -> tuple[str, ...]:
    """A name for every stored scalar, in order: ``x_qx`` of an SE3 ``x``, ``z_0`` of a scalar ``z``.

    A name that the kernel already uses, or a header of C, gets underscores appended.
    """
    used = {*(a.name for a in kernel.arguments), *(port.name for port in kernel.jacobians.outputs)}
    names: list[str] = []
    for argument in kernel.arguments:
        for scalar in argument.storage if argument.size > 1 else ("0",):
            name = f"{argument.name.rstrip('_')}_{scalar}"
            while name in used or macro(name):
                name += "_"
            used.add(name)
            names.append(name)
    return tuple(names)
