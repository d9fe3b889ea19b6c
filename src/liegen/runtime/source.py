"""``Source``: everything that liegen emits for one factor, a value that can be sent to another process."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from functools import cached_property

from liegen.emit import render
from liegen.emit.floats import conditions_source, floats_source
from liegen.emit.gathers import gathers_source
from liegen.emit.header import doc_lines, interface_doc
from liegen.emit.loops import Method, loops_source, methods
from liegen.emit.numpy_target import camel
from liegen.emit.precision import SINGLE
from liegen.emit.sums import sums_source
from liegen.emit.target import Options
from liegen.kernel import Kernel

#: The prefix of the C symbols and the name of the NumPy package.
PACKAGE = "liegen_compiled"


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

    ``docs`` and ``records`` are the docstring of each method and the name of the tuple that it returns, if it
    does.
    """

    name: str
    parameters: tuple[Parameter, ...]
    methods: tuple[Method, ...]
    docs: Mapping[str, str]
    records: Mapping[str, str]
    requirements: tuple[str, ...]
    c: Mapping[str, str]
    numpy: Mapping[str, str]
    floats: str
    conditions: str

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
    c = {path.removeprefix("c/"): text for path, text in files.items() if path.startswith("c/")}
    del c[f"{kernel.name}.c"]  # the functions of a single element, which no loop calls
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
        c={
            **c,
            f"{kernel.name}_loops.c": loops_source(kernel, options),
            f"{kernel.name}_gathers.c": gathers_source(kernel, options),
            **({f"{kernel.name}_sums.c": sums_source(kernel, options)} if summed else {}),
        },
        numpy={
            path.removeprefix(f"{PACKAGE}/"): text
            for path, text in files.items()
            if path.startswith(f"{PACKAGE}/") and path.endswith(".py")
        },
        floats=floats_source(kernel),
        conditions=conditions_source(kernel),
    )
