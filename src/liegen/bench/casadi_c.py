"""CasADi's own C: of liegen's expressions, and of its own differentiation through the storage."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from liegen.algebra.casadi_backend import ca
from liegen.algebra.linear import Matrix, product
from liegen.derive import lowered
from liegen.differentiate import STRATEGIES, Expressions, expressions, jacobians
from liegen.differentiate.local import local_blocks
from liegen.manifolds import Operation

from .variant import AnyFunction, Task, Variant, fastest, offsets

NAME = "CasADi"
#: The expressions of liegen: CasADi prints them.
RULES = "liegen's rules"
Blocks = Mapping[tuple[str, str], Matrix]


def variants(task: Task) -> tuple[Variant, ...]:
    """Its C of the same expressions as liegen's, and of automatic differentiation through the storage.

    A factor with noise or a loss has none: these are applied after the Jacobians that CasADi sees.
    """
    function = task.function
    if function.weighting:
        return ()
    values = expressions(function.graph)

    def ruled() -> Blocks:
        return jacobians(function.graph, values, STRATEGIES["reverse"])

    return (
        _variant(task, "casadi_rules", RULES, values, ruled),
        _variant(
            task,
            "casadi_storage",
            "AD through the storage",
            values,
            lambda: through_storage(function, values),
        ),
    )


def through_storage(function: AnyFunction, values: Expressions) -> dict[tuple[str, str], Matrix]:
    """The whole function as one operation without a rule."""
    graph = function.graph
    inputs = [values.inputs[p.name] for p in graph.parameters]
    found: dict[tuple[str, str], Matrix] = {}
    for name, node in graph.outputs:
        result = values.scalars[id(node)]
        whole = ca.Function("whole", [ca.vertcat(*x) for x in inputs], [ca.vertcat(*result)])

        def value(*coords: Any, whole: Any = whole) -> tuple[Any, ...]:
            return tuple(ca.vertsplit(whole.call([ca.vertcat(*c) for c in coords], True, False)[0]))

        operation = Operation(function.name, node.manifold, value, None, "")
        manifolds = [p.manifold for p in graph.parameters]
        wanted = [p.variable for p in graph.parameters]
        blocks = local_blocks(operation, result, inputs, manifolds, wanted)
        for p, chain in zip(graph.parameters, blocks, strict=True):
            if chain is not None:
                found[name, p.name] = product(chain)
    return found


def _variant(task: Task, name: str, note: str, values: Expressions, derive: Callable[[], Blocks]) -> Variant:
    graph = task.function.graph
    blocks = derive()
    text, seconds = fastest(lambda: _generated(task, name, values, derive()))
    call = (
        f"const double *arg[] = {{{', '.join(f'a + {k}' for k in offsets(task.inputs))}}};",
        f"double *res[] = {{{', '.join(f'b + {k}' for k in offsets(task.outputs))}}};",
        f"{name}(arg, res, NULL, NULL, 0);",
    )
    prototype = f"int {name}(const double **, double **, long long int *, double *, int);"
    counts = lowered(graph, values, blocks).op_counts()
    return Variant(
        NAME, ca.__version__, note, prototype, call, {f"{name}.c": text}, counts, seconds,
        borrowed=note == RULES,
    )  # fmt: skip


def _generated(task: Task, name: str, values: Expressions, blocks: Blocks) -> str:
    inputs = [ca.vertcat(*symbols) for symbols in values.inputs.values()]
    outputs = [ca.vertcat(*values.scalars[id(node)]) for _, node in task.function.graph.outputs]
    outputs += [ca.densify(ca.vertcat(*(x for row in block for x in row))) for block in blocks.values()]
    generator = ca.CodeGenerator(name)
    generator.add(ca.Function(name, inputs, outputs))
    return str(generator.dump())
