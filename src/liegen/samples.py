"""Arguments for verification: what is drawn, and at which special cases.

A sampler is a function ``(draw, case) -> {argument: typed value}``. Factors of the library state their own,
so that the residual has the rotation that the case asks for; ``default_sampler`` serves any other factor.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from liegen.arguments import coerced
from liegen.coefficients import tables
from liegen.define import Function
from liegen.errors import DefinitionError
from liegen.exits import no_exit
from liegen.manifolds import Manifold, Value
from liegen.manifolds.given import spoken
from liegen.manifolds.node import raised_in_user_code
from liegen.text import exception_text, printable
from liegen.trace import Parameter, constant

Sampler = Callable[["Draw", "Case"], Mapping[str, Value]]


@dataclass(frozen=True)
class Case:
    """A kind of sample.

    ``angle``: rotation [rad] of the residual (or between the arguments), None for any. ``offset``: length of
    its translation [m], None for any. ``spread``: size of positions [m]. ``negate``: at least one rotation is
    stored as -q. ``apart``: positions are that far from each other too, and their small residual is what is
    left of large numbers: no method in double precision has more digits of it than rounding leaves.
    """

    name: str
    angle: float | None = None
    offset: float | None = None
    spread: float = 1.0
    negate: bool = False
    apart: bool = False


_SWITCHES = tuple(math.sqrt(s) for s in (tables.STUMPFF3_END, tables.STUMPFF5_END, tables.INVERSE_END))
#: Rotation angles at which digits get lost elsewhere: around 0, at both sides of every switch, around pi.
ANGLES: tuple[float, ...] = (
    1e-160, 1e-12, 1e-8, 1e-5, 1e-3, 0.1, 1.0, np.pi - 1e-3, np.pi - 1e-6, np.pi - 1e-8, np.pi,
    *(side * angle for angle in _SWITCHES for side in (1 - 1e-9, 1 + 1e-9)),
)  # fmt: skip

CASES: tuple[Case, ...] = (
    Case("random"),
    Case("tens of metres", spread=30.0),
    Case("identity", angle=0.0, offset=0.0),
    Case("zero rotation", angle=0.0),
    *(Case(f"angle {angle!r}", angle=angle) for angle in ANGLES),
    Case("coincident", offset=0.0),
    *(Case(f"offset {length!r}", offset=length) for length in (1e-170, 1e-8)),
    Case("kilometres", spread=1e3),
    Case("thousands of kilometres", spread=1e6),
    Case("thousands of kilometres apart", spread=1e6, apart=True),
    Case("negated quaternions", negate=True),
)


@dataclass(frozen=True)
class Draw:
    """A source of random elements with a fixed seed."""

    generator: np.random.Generator

    def uniform(self, low: float, high: float) -> float:
        """A number in [low, high)."""
        return float(self.generator.uniform(low, high))

    def unit(self, n: int) -> NDArray[np.float64]:
        """A unit vector with n components."""
        v = self.generator.normal(size=n)
        return v / np.linalg.norm(v)

    def vector(self, n: int, length: float | None = None, spread: float = 1.0) -> NDArray[np.float64]:
        """A vector of the given length, or of a size around ``spread``."""
        return self.unit(n) * length if length is not None else self.generator.normal(size=n) * spread

    def element(self, manifold: type[Manifold], spread: float = 1.0) -> Any:
        """Any element: rotations uniform, positions of size ``spread``, calibrations of a usual camera."""
        return manifold.from_storage(manifold.form.draw(self, spread))

    def tangent(self, manifold: type[Manifold], case: Case) -> NDArray[np.float64]:
        """A tangent vector whose rotation has the case's angle, whose translation the case's offset."""
        angle = self.uniform(0, 3.0) if case.angle is None else case.angle
        return np.array(manifold.form.draw_tangent(self, angle, case.offset))


def sampler_of(function: Function[..., Any]) -> Sampler:
    """What draws the arguments of a factor: its own sampler, or the default one.

    What its own sampler gives may be arrays and numbers, as in a call of the factor. What it does wrong is a
    DefinitionError that names the factor, the sampler and the argument.
    """
    parameters = function.plain.parameters
    own = function.sampler
    if own is None:
        manifolds: dict[str, Any] = {p.name: p.manifold for p in parameters}
        return default_sampler(manifolds)
    name = printable(getattr(own, "__name__", type(own).__name__))
    what = f"{function.graph.site}: {function.name}: its sampler {name}"
    # It may serve the formula with other arguments bound too.
    known = {s.name for s in function.declared} | {p.name for p in function.graph.parameters}

    def sample(draw: Draw, case: Case) -> Mapping[str, Value]:
        try:
            with no_exit():
                given = cast(object, own(draw, case))
                values = {**cast(Mapping[str, Any], given)} if isinstance(given, Mapping) else None
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # a user's function may raise anything
            site = raised_in_user_code(error)
            at = f" at {site}" if site else "; it is called with (draw, case)"
            raise DefinitionError(
                f"{what} raised {exception_text(error)}{at}, in the case {case.name!r}"
            ) from error
        names = ", ".join(p.name for p in parameters)
        if values is None:
            got = spoken(cast(object, given))
            raise DefinitionError(f"{what} gave {got}; it must return {{argument: value}} for {names}")
        for argument in values:
            if argument not in known:
                shown = printable(repr(argument), 60)
                raise DefinitionError(
                    f"{what} gave a value for {shown}, which is no argument; it has {names}"
                )
        return values | {p.name: _given(what, p, values) for p in parameters}

    return sample


def _given(what: str, parameter: Parameter, values: Mapping[str, Any]) -> Value:
    """The typed value of one argument, which must be one finite element."""
    name, manifold = parameter.name, parameter.manifold
    if name not in values:
        raise DefinitionError(
            f"{what} gave nothing for {name!r}; it must return a {manifold.__name__} for it"
        )
    stored = parameter.storage
    value = coerced(
        f"{what}: what it gave for {name!r}", manifold, stored, stored.shape or (stored.size,), values[name]
    )
    constant(value, f"{what}: what it gave for {name!r}")
    return value


def default_sampler(manifolds: Mapping[str, type[Manifold]]) -> Sampler:
    """Samples of any factor.

    Elements of one class keep the case's rotation or offset from the first of them; an element of a group
    that is alone in its class has the case's rotation from the identity. The rest is random.
    """

    def sample(draw: Draw, case: Case) -> dict[str, Value]:
        kinds = [m.form.name for m in manifolds.values()]
        base: dict[str, Any] = {}
        values: dict[str, Value] = {}
        for name, manifold in manifolds.items():
            kind = manifold.form.name
            form = manifold.form
            if kind not in base and case.angle is not None and kinds.count(kind) == 1 and form.turns:
                base[kind] = _identity(manifold)
            asked = case.offset if form.flat else case.angle
            if kind in base and asked is not None:
                values[name] = base[kind].retract(draw.tangent(manifold, case))
            else:
                values[name] = draw.element(manifold, case.spread)
                base.setdefault(kind, values[name])
        return values

    return sample


def _identity(manifold: Any) -> Any:
    return manifold.identity()


def negated(values: Mapping[str, Value], draw: Draw, *, always: bool = False) -> dict[str, Value]:
    """The same rotations, some of them by the other quaternion; at least one where ``always``."""
    names = [name for name, v in values.items() if v.form.quaternions]
    chosen = {name for name in names if draw.uniform(0, 1) < 0.5}
    if always and names and not chosen:
        chosen = {names[int(draw.uniform(0, len(names)))]}
    return {name: other_quaternion(v) if name in chosen else v for name, v in values.items()}


def other_quaternion(v: Value) -> Value:
    """The same element with -q for each of its quaternions."""
    coords = list(v.coords)
    for start in v.form.quaternions:
        coords[start : start + 4] = [-c for c in coords[start : start + 4]]
    return type(v).holding(coords)
