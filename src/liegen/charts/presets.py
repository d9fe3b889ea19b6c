"""The named presets, each with the definition that it assumes (docs/conventions.md has the same list)."""

from __future__ import annotations

from collections.abc import Mapping

from liegen.errors import DefinitionError

from .chart import Chart, Preset

_TRANSLATION_FIRST = Chart(order="translation-first")
_WORLD_YAW = Chart(translation="world", order="translation-first")

GTSAM = Preset(
    "gtsam",
    Chart(),
    Chart(),
    "GTSAM 4.3 as built by default: the exponential of the group on the right; Pose3 rotation first, Pose2 "
    "translation first. liegen's default.",
)

#: By name, in the order of the documentation.
PRESETS: Mapping[str, Preset] = {
    p.name: p
    for p in (
        GTSAM,
        Preset(
            "gtsam-4.2",
            Chart(),
            Chart(translation="body"),
            "GTSAM 4.2 as built by default: Rot2, Rot3 and Pose3 as in 4.3; Pose2 adds the translation in "
            "the body, t' = t + R v. (Pose3 of a build without GTSAM_POSE3_EXPMAP: "
            'Chart(translation="body").)',
        ),
        Preset(
            "symforce",
            Chart(translation="world", order="rotation-first"),
            Chart(translation="world", order="rotation-first"),
            "SymForce's retract and local_coordinates: rotation on the right by the exponential, "
            "translation added in the world; rotation first, in Pose2 too.",
        ),
        Preset(
            "sophus",
            _TRANSLATION_FIRST,
            _TRANSLATION_FIRST,
            "Sophus: x * exp(d), the exponential of the group; translation first.",
        ),
        Preset(
            "manif",
            _TRANSLATION_FIRST,
            _TRANSLATION_FIRST,
            "manif's rplus and rminus: x * Exp(d), the exponential of the group; translation first.",
        ),
        Preset(
            "ceres",
            Chart(side="left", scale=2, translation="world", order="rotation-first"),
            _WORLD_YAW,
            "Ceres: ProductManifold of a quaternion manifold and EuclideanManifold<3>: q' = q(d) q with "
            "q(d) = (sin|d| d/|d|, cos|d|), so d is half of the rotation vector, in the world; translation "
            "added in the world; rotation first. Poses of the plane as in its example pose_graph_2d: x, y "
            "and yaw added.",
        ),
        Preset(
            "g2o",
            Chart(rotation="quaternion-vector", scale=2, translation="body", order="translation-first"),
            _WORLD_YAW,
            "g2o: VertexSE3 multiplies by fromVectorMQT(d) on the right: translation first, in the body; the "
            "rotation is the vector part of a unit quaternion. VertexSE2: x, y and yaw added in the world.",
        ),
        Preset(
            "ros",
            Chart(side="left", translation="world", order="translation-first"),
            _WORLD_YAW,
            "The covariance of geometry_msgs/PoseWithCovariance: translation first, along the fixed axes of "
            "the header's frame; the rotation turns about the same axes, R' = exp(w) R (the message says "
            '"fixed axis", which fixes it to first order only).',
        ),
    )
}


def preset(chart: object, what: str) -> Preset:
    """The preset of a name, or of a Chart, which then counts for plane and space.

    Raises DefinitionError, with ``what`` in front, for anything else.
    """
    if isinstance(chart, Preset):
        return chart
    if isinstance(chart, Chart):
        return Preset(chart.description, chart, chart)
    if isinstance(chart, str) and chart in PRESETS:
        return PRESETS[chart]
    raise DefinitionError(f"{what}: unknown chart {chart!r}; one of {', '.join(PRESETS)}, or a liegen.Chart")
