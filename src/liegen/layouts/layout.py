"""``Layout``: the choices that the storage of rotations and poses consists of, and ``Stored``: named ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from liegen.charts.choices import Choices
from liegen.manifolds import ManifoldForm

Rotation = Literal["xyzw", "wxyz", "matrix"]
Plane = Literal["cos-sin", "angle", "matrix"]
Pose = Literal["parts", "4x4", "3x4"]
Order = Literal["row", "column"]
First = Literal["rotation", "translation"]


@dataclass(frozen=True)
class Layout(Choices):
    """The numbers that stand for a rotation or a pose where generated code is called.

    ``rotation``: of space: unit quaternion (x, y, z, w) or (w, x, y, z), or the 3x3 matrix R. ``plane``: a
    rotation of the plane: (cos, sin), the angle [rad], or the 2x2 matrix. ``pose``: parts, the rotation so
    stored and the translation, ``first`` says which comes first; or the matrix [[R, t], [0, 1]] (4x4, in the
    plane 3x3), or its upper rows [R, t] (3x4, in the plane 2x3). ``order``: matrices row by row, as arrays of
    two dimensions, or column by column, as flat arrays. Extended and Galilean poses are the rotation so
    stored, then the rest as ever. Raises DefinitionError for any other choice.
    """

    rotation: Rotation = "xyzw"
    plane: Plane = "cos-sin"
    pose: Pose = "parts"
    order: Order = "row"
    first: First = "rotation"


@dataclass(frozen=True)
class Stored:
    """A layout by name: of SO3, SE3 and what is made of them (``space``), of SO2 and SE2 (``plane``)."""

    name: str
    space: Layout
    plane: Layout
    definition: str = ""

    def layout(self, form: ManifoldForm) -> Layout:
        """That of a manifold."""
        return self.plane if form.name in ("SO2", "SE2") else self.space
