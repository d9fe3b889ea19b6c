"""``FrameReport``: in which frames a factor's residual, its Jacobians' columns and its noise are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class FrameReport:
    """What follows from the frames of the arguments.

    A frame is a declared name (``B``) or, where none is known, a description (``the body frame of x``).
    """

    #: Whether any name or annotation declares a frame.
    typed: bool = False
    #: Frames of each argument that has any, declared or inferred: (outer, inner) of a map, one of a vector.
    arguments: Mapping[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]])
    #: For each output the frame of its tangent, of its Jacobians' rows and of its noise, if any.
    rows: Mapping[str, str] = field(default_factory=dict[str, str])
    #: For each variable the frame of the columns of its Jacobians.
    columns: Mapping[str, str] = field(default_factory=dict[str, str])
    #: How the name of each argument was read, or why it was not.
    names: tuple[str, ...] = ()
    #: The report as text, a line for each argument, output and Jacobian.
    lines: tuple[str, ...] = ()

    @property
    def residual(self) -> str | None:
        """The frame of a factor's residual; None for numbers and pixels, which are in no frame."""
        return self.rows.get("res")

    @property
    def noise(self) -> str | None:
        """The frame in which the residual's noise (covariance, square-root information) must be given."""
        return self.residual
