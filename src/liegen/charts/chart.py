"""``Chart``: the choices that a chart of rotations and poses consists of, and ``Preset``: a library's."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Literal, get_args, get_type_hints

from liegen.errors import DefinitionError
from liegen.manifolds import ManifoldForm
from liegen.manifolds.node import here

Side = Literal["right", "left"]
RotationMap = Literal["exp", "cayley", "quaternion-vector"]
Scale = Literal[1, 2]
Translation = Literal["coupled", "body", "world"]
Order = Literal["own", "rotation-first", "translation-first"]


@dataclass(frozen=True)
class Chart:
    """The chart of a rotation R or a pose (R, t), with coordinates w of the rotation, v of the translation.

    ``side``: right turns about the body's axes, R' = R m(k w); left about the world's, R' = m(k w) R.
    ``rotation``: the map m. ``exp`` takes a rotation vector; ``cayley`` the vector 2 tan(a/2) u and
    ``quaternion-vector`` 2 sin(a/2) u of a rotation by the angle a about u (both to first order the
    rotation vector). ``scale``: the factor k; with 2 the coordinates are half angles to first order.
    ``translation``: coupled is the pose's own exponential, x exp(d) or exp(d) x; body is t' = t + R v;
    world is t' = t + v. ``order``: own is rotation first in SE3 and translation first in SE2.
    Raises DefinitionError for any other choice, and for a coupled translation with a map that is not exp.
    """

    side: Side = "right"
    rotation: RotationMap = "exp"
    scale: Scale = 1
    translation: Translation = "coupled"
    order: Order = "own"

    def __post_init__(self) -> None:
        hints = get_type_hints(type(self))
        for choice in fields(self):
            value, possible = getattr(self, choice.name), get_args(hints[choice.name])
            if value not in possible:
                raise DefinitionError(
                    f"{here()}: Chart({choice.name}={value!r}): {choice.name} is one of "
                    f"{', '.join(map(repr, possible))}"
                )

    @property
    def description(self) -> str:
        """The choices as keyword arguments; default ones are left out."""
        stated = {f.name: getattr(self, f.name) for f in fields(self) if getattr(self, f.name) != f.default}
        return f"Chart({', '.join(f'{name}={value!r}' for name, value in stated.items())})"


@dataclass(frozen=True)
class Preset:
    """The charts of a library: of SO3 and SE3 (``space``), of SO2 and SE2 (``plane``)."""

    name: str
    space: Chart
    plane: Chart
    definition: str = ""  # what it assumes of the library, one sentence or two

    def chart(self, form: ManifoldForm) -> Chart:
        """The chart of a rotation, pose or similarity."""
        return self.plane if form.name in ("SO2", "SE2", "Sim2") else self.space
