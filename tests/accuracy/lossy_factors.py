"""Textbook formulas that lose digits near the identity, and one that does not."""

from liegen import R1, SE3, SO3, cos, factor, norm, sin


@factor
def textbook(x: SO3, *, z: R1):
    """(1 - cos a) / a^2 of the angle a of x, minus z."""
    a = norm(x.log())
    return (1 - cos(a)) / (a * a) - z


@factor
def stable(x: SO3, *, z: R1):
    """The same by the half angle."""
    a = norm(x.log()) / 2
    return (sin(a) / a) * (sin(a) / a) / 2 - z


@factor(chart="sophus")
def stated(x: SE3, *, z: SE3):
    """States its chart itself."""
    return z.local(x)
