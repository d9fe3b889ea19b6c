"""The named layouts (docs/conventions.md lists them); those of libraries have the names of their charts."""

from __future__ import annotations

from collections.abc import Mapping

from liegen.errors import DefinitionError

from .layout import Layout, Stored


def _everywhere(name: str, layout: Layout, definition: str) -> Stored:
    return Stored(name, layout, layout, definition)


OWN = _everywhere("xyzw", Layout(), "liegen's own storage: quaternion (x, y, z, w), translation; (cos, sin).")
_TRANSLATION_FIRST = Layout(first="translation")
_YAW = Layout(plane="angle", first="translation")
_MATRIX = Layout("matrix", "matrix")
_HOMOGENEOUS = Layout("matrix", "matrix", "4x4")
_AFFINE = Layout("matrix", "matrix", "3x4")

#: By name, in the order of the documentation.
LAYOUTS: Mapping[str, Stored] = {
    s.name: s
    for s in (
        OWN,
        _everywhere("wxyz", Layout("wxyz"), "Quaternion (w, x, y, z), translation."),
        _everywhere("matrix", _MATRIX, "Rotation matrix row by row, then the translation."),
        _everywhere("matrix-col", Layout("matrix", "matrix", order="column"), "The same, column by column."),
        _everywhere("4x4", _HOMOGENEOUS, "[[R, t], [0, 1]] row by row (3x3 in the plane); R for rotations."),
        _everywhere("4x4-col", Layout("matrix", "matrix", "4x4", "column"), "The same, column by column."),
        _everywhere("3x4", _AFFINE, "[R, t] row by row (2x3 in the plane); R for rotations."),
        _everywhere("3x4-col", Layout("matrix", "matrix", "3x4", "column"), "The same, column by column."),
        _everywhere("gtsam", _HOMOGENEOUS, "What matrix() of Rot3, Pose3, Rot2 and Pose2 returns in Python."),
        _everywhere("symforce", Layout(),
                    "to_storage(): quaternion (x, y, z, w), position; (cos, sin, x, y)."),
        _everywhere("sophus", Layout(), "data(): quaternion (x, y, z, w), translation; (cos, sin, x, y)."),
        _everywhere("manif", _TRANSLATION_FIRST,
                    "coeffs(): translation, quaternion (x, y, z, w) or (cos, sin)."),
        Stored("ceres", Layout("wxyz"), _YAW,
               "Blocks of ProductManifold<QuaternionManifold, EuclideanManifold<3>>: quaternion "
               "(w, x, y, z), position; in the plane x, y, yaw."),
        Stored("g2o", _TRANSLATION_FIRST, _YAW,
               "toVectorQT and .g2o files: x, y, z, quaternion (x, y, z, w); in the plane x, y, angle."),
        Stored("ros", _TRANSLATION_FIRST, _YAW,
               "geometry_msgs/Pose: position, orientation (x, y, z, w); Pose2D: x, y, theta."),
    )
}  # fmt: skip


def stored(layout: object, what: str) -> Stored:
    """The layout of a name, or of a Layout, which then counts for plane and space.

    Raises DefinitionError, with ``what`` in front, for anything else.
    """
    if isinstance(layout, Stored):
        return layout
    if isinstance(layout, Layout):
        return Stored(layout.description, layout, layout)
    if isinstance(layout, str) and layout in LAYOUTS:
        return LAYOUTS[layout]
    known = ", ".join(LAYOUTS)
    raise DefinitionError(f"{what}: unknown layout {layout!r}; one of {known}, or a liegen.Layout")
