"""The points where the mathematics defines no value, why, and what the emitted code gives there."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.manifolds import ManifoldForm, Node
from liegen.samples import CASES, Draw, default_sampler
from liegen.trace import Graph
from liegen.verify.backends import Backend, Workspace, backends
from liegen.verify.compiled import STATUS
from liegen.verify.draws import (
    TRIES,
    AnyFunction,
    Sample,
    Values,
    batch,
    draw_one,
    generator_for,
    program_domain,
    stored,
)
from liegen.verify.sphere_slack import has_sphere

from .conditioning import takes_vector_part

Array = NDArray[np.float64]
#: Arguments at such a point; None where no way to them is known.
Place = Callable[[AnyFunction], Values | None]


@dataclass(frozen=True)
class Undefined:
    """A point: the functions that have it, where it is, why nothing is defined, what the code gives there."""

    where: str
    reason: str
    returns: str
    functions: tuple[str, ...]


@dataclass(frozen=True)
class _Rule:
    where: str
    reason: str
    applies: Callable[[Graph], bool]
    place: Place
    returns: str = ""  # said instead of what one sample shows


def undefined_points(function: AnyFunction, workplace: Workspace) -> tuple[Undefined, ...]:
    """The points of a function, with what its code gives at an example of each."""
    computed = [b for b in backends(function.kernel, workplace) if b.name in ("C", "C, value", "NumPy")]
    rules = [*(r for r in _RULES if r.applies(function.graph)), *_of_domain(function.graph)]
    return tuple(
        Undefined(r.where, r.reason, r.returns or _given(r.place(function), computed), (function.name,))
        for r in rules
    )


def _given(values: Values | None, computed: Sequence[Backend]) -> str:
    if values is None:
        return "not evaluated"
    said: dict[str, list[str]] = {}
    for backend in computed:
        for name, array in backend.evaluate(batch((Sample("", values),))).items():
            text = f"{int(array[0])}" if name == STATUS else _in_words(array[0])
            if text not in said.setdefault("C status" if name == STATUS else name, []):
                said["C status" if name == STATUS else name].append(text)
    return ", ".join(f"{name} {' or '.join(texts)}" for name, texts in said.items())


def _in_words(array: Array) -> str:
    if np.isnan(array).all():
        return "NaN"
    if not np.isfinite(array).all():
        return "partly not finite"
    return "0" if not array.any() else "finite"


def _named(*names: str) -> Callable[[Graph], bool]:
    return lambda graph: any(n.operation.name in names for n in graph.nodes())


def _turning(form: ManifoldForm) -> bool:
    return form.turns or any(map(_turning, form.parts))


def _logs(graph: Graph) -> Iterator[Node]:
    return (n for n in graph.nodes() if n.operation.name in ("log", "local"))


def _half_turn(graph: Graph) -> bool:
    return any(_turning(n.operands[0].manifold.form) for n in _logs(graph))


def _antipode(graph: Graph) -> bool:
    return any(has_sphere(n.operands[0].manifold.form) for n in _logs(graph))


def _moving_basis(graph: Graph) -> bool:
    """Whether the residual is given in a tangent basis that moves with a variable."""
    fixed = {p.node for p in graph.parameters if not p.variable}
    return any(has_sphere(n.operands[0].manifold.form) and n.operands[0] not in fixed for n in _logs(graph))


def _singular(graph: Graph) -> bool:
    """Whether an inverse Jacobian is taken that is not constant."""
    inverses = [n for n in graph.nodes() if n.operation.name in ("Jr_inv", "Jl_inv")]
    return any(n.operands[0].manifold.form.dim > 1 for n in inverses)


def _vector_part(graph: Graph) -> bool:
    return any(map(takes_vector_part, graph.nodes()))


def _first(function: AnyFunction) -> Values:
    return draw_one(function, Draw(generator_for("undefined", function.name)), CASES[0]).values


def _opposite(function: AnyFunction) -> Values | None:
    """The first of the library's and the default samples by pi whose directions are opposite: z = -z."""
    graph, values = function.graph, dict(_first(function))
    spheres = [p.name for p in graph.parameters if p.manifold.form.name == "S2"]
    if len(spheres) == 2:
        return values | {spheres[1]: tuple(-c for c in values[spheres[0]])}
    if len(spheres) != 1 or not {"x", "y"} <= values.keys():
        return None
    # from the origin without rotation, the direction of a point on an axis is exact
    x = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    y = (*values["y"][:-3], 0.0, 0.0, 2.0)
    return values | {"x": x, "y": y, spheres[0]: (0.0, 0.0, -1.0)}


def _coincident(function: AnyFunction) -> Values | None:
    """The position of y at that of x."""
    values = dict(_first(function))
    if not {"x", "y"} <= values.keys():
        return None
    n = 2 if len(values["y"]) in (2, 4) else 3
    return values | {"y": (*values["y"][:-n], *values["x"][-n:])}


def _whole_turn(function: AnyFunction) -> Values | None:
    return {name: (*((2 * np.pi,) * len(v)),) for name, v in _first(function).items()}


def _long(function: AnyFunction) -> Values:
    return {name: (3.0,) * len(v) if name == "d" else v for name, v in _first(function).items()}


def _of_domain(graph: Graph) -> list[_Rule]:
    return [
        _Rule(d.message, "outside the domain that the factor states with require(...)", bool, _outside)
        for d in graph.domain
    ]


def _outside(function: AnyFunction) -> Values | None:
    inside, graph = program_domain(function), function.graph
    manifolds: dict[str, Any] = {p.name: p.manifold for p in graph.parameters}
    draw, sampler = Draw(generator_for("outside", function.name)), default_sampler(manifolds)
    drawn = (stored(function, sampler(draw, CASES[0])) for _ in range(TRIES))
    return next((v for v in drawn if not inside(graph, v)), None)


_RULES: tuple[_Rule, ...] = (
    _Rule(
        "relative rotation (argument of log) by exactly pi",
        "there are two logarithms of length pi, u and -u, with different Jacobians",
        _half_turn,
        lambda _: None,
        "one of the two with its Jacobians, and that one is compared: in space the vector part of the stored "
        "quaternion product with w >= 0 gives the sign (at w = 0 as it stands), in the plane atan2 does "
        "(+pi for a sine of +0)",
    ),
    _Rule(
        "opposite directions on S2",
        "every tangent of length pi leads to the antipode; near it the error is that of the stored unit "
        "vectors over the sine of the angle",
        _antipode,
        _opposite,
    ),
    _Rule(
        "directions with two equal smallest components, where a basis on S2 is that of a variable",
        "the tangent basis jumps from one coordinate axis to the next (a tie takes x, then y, then z)",
        _moving_basis,
        lambda _: None,
        "value and Jacobian in the basis of the tie rule",
    ),
    _Rule(
        "a distance of 0",
        "the gradient of a norm: every unit vector is a subgradient",
        _named("norm"),
        _coincident,
    ),
    _Rule(
        "a bearing to coincident positions",
        "a zero vector has no direction",
        _named("direction"),
        _coincident,
    ),
    _Rule(
        "rotation by 2 pi n, n >= 1",
        "Jr and Jl are singular",
        _singular,
        _whole_turn,
        "not finite, or as large as the rounding of 2 pi makes it",
    ),
    _Rule(
        "retract by the vector part v of a quaternion (g2o: v = d) with |v| >= 1",
        "no unit quaternion has a longer vector part, and half a turn, |v| = 1, has no Jacobian; near it "
        "w = sqrt(1 - |v|^2) = cos(angle/2) has the error of the stored v over w, the Jacobian by d over "
        "w^2, and within 1e-6 of w = 0 no digits are left",
        _vector_part,
        _long,
    ),
)  # fmt: skip


def merged(points: Sequence[Undefined]) -> tuple[Undefined, ...]:
    """The same points of several functions, taken together."""
    names: dict[tuple[str, str, str], dict[str, None]] = {}
    for p in points:
        names.setdefault((p.where, p.reason, p.returns), {}).update(dict.fromkeys(p.functions))
    return tuple(Undefined(*key, tuple(functions)) for key, functions in names.items())
