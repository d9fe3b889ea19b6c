"""``Source``: everything that liegen emits for one factor, a value that can be sent to another process."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from functools import cached_property

from liegen.emit import render
from liegen.emit.floats import conditions_source, floats_source
from liegen.emit.gathers import gathers_source
from liegen.emit.header import doc_lines, interface_doc
from liegen.emit.loops import NUMBERS, Method, Number, loops_source, methods
from liegen.emit.numpy_target import camel
from liegen.emit.precision import SINGLE
from liegen.emit.sums import sums_source
from liegen.emit.target import Options
from liegen.kernel import Kernel

#: The prefix of the C symbols and the name of the NumPy package.
PACKAGE = "liegen_compiled"
#: What is compiled on its own, when it is first called: value and status on doubles, the Jacobians with all
#: that gathers, single precision. Without variables the value has what gathers.
VALUE, JACOBIANS, SINGLES = "value", "jacobians", "single precision"
_SINGLE, _DOUBLE = NUMBERS


@dataclass(frozen=True)
class Parameter:
    """An argument in the order of a call; ``default`` stands for a keyword that a call leaves out."""

    name: str
    manifold: str
    shape: tuple[int, ...]
    keyword: bool
    default: tuple[float, ...] | None = None


@dataclass(frozen=True, eq=False)
class Source:
    """A factor as text: C with the loops that NumPy calls, NumPy code, statements on floats.

    ``c`` are the files of each part that is compiled on its own, ``docs`` and ``records`` the docstring of
    each method and the name of the tuple that it returns, if it does.
    """

    name: str
    parameters: tuple[Parameter, ...]
    methods: tuple[Method, ...]
    docs: Mapping[str, str]
    records: Mapping[str, str]
    requirements: tuple[str, ...]
    c: Mapping[str, Mapping[str, str]]
    numpy: Mapping[str, str]
    floats: str
    conditions: str

    @property
    def whole(self) -> str:
        """The part with the batch of all outputs in double precision, and what gathers."""
        return JACOBIANS if JACOBIANS in self.c else VALUE

    def offered(self, part: str) -> tuple[Method, ...]:
        """The methods that a part has."""
        names = (VALUE, "status") if part == VALUE else (JACOBIANS,)
        return tuple(m for m in self.methods if part == SINGLES or m.name in names)

    @cached_property
    def digest(self) -> str:
        """SHA-256 of all of it; two sources of one digest are equal."""
        return hashlib.sha256(json.dumps(asdict(self), sort_keys=True).encode()).hexdigest()

    def __getstate__(self) -> dict[str, object]:
        """Without the digest: who restores a source works it out anew."""
        return {f.name: getattr(self, f.name) for f in fields(self)}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Source) and self.digest == other.digest

    def __hash__(self) -> int:
        return hash(self.digest)


def emitted(kernel: Kernel, *, summed: bool = False) -> Source:
    """Everything that is emitted for a factor, ``summed``: with sums over factors.

    Raises DefinitionError for names that a language refuses.
    """
    options = Options(PACKAGE, f"liegen.compile({kernel.name})", scalar=SINGLE.type)
    files = render(
        [kernel], ("c", "numpy"), package=PACKAGE, regenerate=options.regenerate, scalar=options.scalar
    )
    several = len(kernel.outputs) > 1
    return Source(
        name=kernel.name,
        parameters=tuple(
            Parameter(a.name, a.manifold, a.shape, a in kernel.keywords, a.default)
            for a in (*kernel.positional, *kernel.keywords)
        ),
        methods=methods(kernel),
        docs={
            "value": "\n".join(interface_doc(kernel, kernel.value)),
            "jacobians": "\n".join(interface_doc(kernel, kernel.jacobians)),
            "status": "\n".join([*doc_lines(kernel), "", "Bits of the requirements that do not hold."]),
        },
        records={
            **({"value": f"{camel(kernel.name)}Outputs"} if several else {}),
            "jacobians": f"{camel(kernel.name)}Jacobians",
        },
        requirements=tuple(r.message for r in kernel.value.requirements),
        c=_parts(kernel, options, files, summed=summed),
        numpy={
            path.removeprefix(f"{PACKAGE}/"): text
            for path, text in files.items()
            if path.startswith(f"{PACKAGE}/") and path.endswith(".py")
        },
        floats=floats_source(kernel),
        conditions=conditions_source(kernel),
    )


def _parts(
    kernel: Kernel, options: Options, files: Mapping[str, str], *, summed: bool
) -> Mapping[str, Mapping[str, str]]:
    """The C of each part; texts that are equal are one string."""
    name, double = kernel.name, f"{kernel.name}_batch.c"
    c = {path.removeprefix("c/"): text for path, text in files.items() if path.startswith("c/")}
    del c[f"{name}.c"]  # the functions of a single element, which no loop calls
    headers = {path: text for path, text in c.items() if path.endswith(".h")}
    single = next(path for path in c if path.endswith(".c") and path != double)

    def loops(of: Kernel, names: tuple[str, ...], number: Number) -> dict[str, str]:
        return {f"{name}_loops.c": loops_source(of, options, names, number)}

    whole = {
        **headers,
        double: c[double],
        f"{name}_gathers.c": gathers_source(kernel, options),
        **({f"{name}_sums.c": sums_source(kernel, options)} if summed else {}),
    }
    singles = {
        SINGLES: {
            **headers,
            single: c[single],
            **loops(kernel, tuple(m.name for m in methods(kernel)), _SINGLE),
        }
    }
    if not kernel.variables:
        return {VALUE: {**whole, **loops(kernel, (VALUE, "status"), _DOUBLE)}, **singles}
    alone = _without_jacobians(kernel)
    rendered = render([alone], ("c",), package=PACKAGE, regenerate=options.regenerate)
    value = {path.removeprefix("c/"): text for path, text in rendered.items() if path.startswith("c/")}
    del value[f"{name}.c"]
    value = {path: c[path] if c.get(path) == text else text for path, text in value.items()}
    return {
        VALUE: {**value, **loops(alone, (VALUE, "status"), _DOUBLE)},
        JACOBIANS: {**whole, **loops(kernel, (JACOBIANS,), _DOUBLE)},
        **singles,
    }


def _without_jacobians(kernel: Kernel) -> Kernel:
    """The value alone, called in the same way."""
    arguments = tuple(replace(a, variable=False, named=not a.variable) for a in kernel.arguments)
    return replace(kernel, arguments=arguments, jacobians=kernel.value)
