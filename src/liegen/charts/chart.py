"""``Chart``: the choices that a chart of rotations and poses consists of, and ``Preset``: a library's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from liegen.manifolds import ManifoldForm

from .choices import Choices

Side = Literal["right", "left"]
RotationMap = Literal["exp", "cayley", "quaternion-vector"]
Scale = Literal[1, 2]
Translation = Literal["coupled", "body", "world"]
Order = Literal["own", "rotation-first", "translation-first"]


@dataclass(frozen=True)
class Chart(Choices):
    """The chart of a rotation R or a pose (R, t), with coordinates w of the rotation, v of the translation.

    ``side``: right turns about the body's axes, R' = R m(k w); left about the world's, R' = m(k w) R.
    ``rotation``: the map m. ``exp`` takes a rotation vector; ``cayley`` the vector 2 tan(a/2) u and
    ``quaternion-vector`` 2 sin(a/2) u of a rotation by the angle a about u (both to first order the
    rotation vector). ``scale``: the factor k; with 2 the coordinates are half angles to first order.
    ``translation``: coupled is the pose's own exponential, x exp(d) or exp(d) x; body is t' = t + R v;
    world is t' = t + v. ``order``: own is rotation first in SE3 and translation first in SE2.
    Raises DefinitionError for any other choice. A coupled translation with a map that is not exp is refused
    where a pose is in the chart.
    """

    side: Side = "right"
    rotation: RotationMap = "exp"
    scale: Scale = 1
    translation: Translation = "coupled"
    order: Order = "own"


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
