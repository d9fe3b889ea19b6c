"""The reference's independence, differences at kinks and at pi, branches, undefined values."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from reference_tools import (
    MANIFOLDS,
    PRIORS,
    bearing_gtsam,
    gap,
    hat,
    prior_s2_gtsam,
    prior_so2,
    prior_so3,
    tangent,
)

from liegen.decorate import factor
from liegen.manifolds import R1, R2, R3, S2, SO3, Vector
from liegen.manifolds.functions import (
    abs as vabs,
)
from liegen.manifolds.functions import (
    acos,
    atan2,
    log,
    maximum,
    minimum,
    sqrt,
    where,
)
from liegen.manifolds.vector import norm, stack
from liegen.trace import require
from liegen.verify import reference
from liegen.verify.reference.matrix import expm, matmul, skew

mp: Any = mpmath.mp


@pytest.fixture(autouse=True)
def _working_precision() -> Any:
    with mp.workdps(reference.DIGITS):
        yield


# --- independence -------------------------------------------------------------------------------------------


def test_it_imports_nothing_of_the_code_under_test() -> None:
    """At run time only itself and mpmath; types of liegen only for the type checker."""
    folder = Path(reference.__file__).parent
    for file in sorted(folder.glob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        for statement in tree.body:
            if isinstance(statement, ast.ImportFrom):
                assert statement.level == 1 or not (statement.module or "").startswith("liegen"), file.name
            if isinstance(statement, ast.Import):
                assert not any(a.name.startswith("liegen") for a in statement.names), file.name
        calls = {n.attr for n in ast.walk(tree) if isinstance(n, ast.Attribute)}
        assert not calls & {"value", "blocks", "adjoint", "Jr_inv"}, file.name


# --- differences --------------------------------------------------------------------------------------------


@factor
def kinks(x: R3, y: R3) -> Vector:
    return stack(
        vabs(x[0]),
        minimum(x[0], y[0]),
        maximum(x[0], y[0]),
        norm(x - y),
        where(x[0] < y[0], 2 * x[0], 5 * x[0]),
    )


def test_ties_take_the_mean_of_both_sides() -> None:
    sample = {"x": (0.0, 1.0, -2.0), "y": (0.0, 1.0, -2.0)}
    J = reference.jacobians(kinks.graph, sample)
    first = [float(row[0]) for row in J["res", "x"]]
    assert first == pytest.approx(
        [0, 0.5, 0.5, 0, 5], abs=1e-20
    )  # where: the side that is taken, x < y is false
    assert [float(row[0]) for row in J["res", "y"]] == pytest.approx([0, 0.5, 0.5, 0, 0], abs=1e-20)


@pytest.mark.parametrize("distance", [1e-170, 1e-308, 1e-40, 1e-20, 1e-8])
def test_the_step_stays_below_the_distance_to_a_kink(distance: float) -> None:
    sample = {"x": (distance, 0.0, 2 * distance), "y": (0.0, 0.0, 0.0)}
    J = reference.jacobians(kinks.graph, sample)["res", "x"]
    assert gap([row[0] for row in J], [1, 0, 1, 1 / mp.sqrt(5), 5]) < mp.mpf("1e-45")
    assert gap(J[3], [1 / mp.sqrt(5), 0, 2 / mp.sqrt(5)]) < mp.mpf("1e-45")


@factor
def rotated_distance(R: SO3, p: R3, q: R3) -> Vector:
    """The norm of q up to rounding: rotation and its inverse."""
    return norm(R.unrotate(R @ p) - p + q)


def test_rounding_is_no_distance_from_a_kink() -> None:
    J = reference.jacobians(
        rotated_distance.graph, {"R": (0.1, 0.2, 0.3, 0.9), "p": (1.0, 2.0, 3.0), "q": (0, 0, 0)}
    )
    assert all(gap(rows, [[0, 0, 0]]) < mp.mpf("1e-40") for rows in J.values())


def right_jacobian_inverse(phi: Any) -> Any:
    """I + [phi]x/2 + (1/a^2 - (1 + cos a)/(2 a sin a)) [phi]x^2 (micro Lie, eq. 144), in its limit at pi."""
    a = mp.sqrt(sum(x * x for x in phi))
    W = skew(phi)
    D = (
        1 / a**2 - (1 + mp.cos(a)) / (2 * a * mp.sin(a))
        if a < 3.14159
        else 1 / a**2 - mp.tan((mp.pi - a) / 2) / (2 * a)
    )
    W2 = matmul(W, W)
    return [[(i == j) + W[i][j] / 2 + D * W2[i][j] for j in range(3)] for i in range(3)]


@pytest.mark.parametrize("flip", [False, True])
@pytest.mark.parametrize("w", [0.0, 1e-20, 1e-9, -1e-9, 0.3])
def test_jacobians_unwrap_at_pi(w: float, flip: bool) -> None:
    sample = {"x": (0.6, 0.0, -0.8, w), "z": (0.0, 0.0, 0.0, 1.0)}
    (r,) = reference.outputs(prior_so3.graph, sample, flip=flip).values()
    J = reference.jacobians(prior_so3.graph, sample, flip=flip)["res", "x"]
    assert gap(J, right_jacobian_inverse(r)) < mp.mpf("1e-45")


@factor
def heading(v: R2) -> Vector:
    return stack(atan2(v[1], v[0]), v)


@pytest.mark.parametrize("flip", [False, True])
@pytest.mark.parametrize("y", [0.0, 1e-30, -1e-30])
def test_atan2_unwraps_and_flips(y: float, flip: bool) -> None:
    found = reference.outputs(heading.graph, {"v": (-2.0, y)}, flip=flip)["res"][0]
    assert abs(found - mp.pi * (1 if (y >= 0) != flip else -1)) < mp.mpf("1e-29")
    J = reference.jacobians(heading.graph, {"v": (-2.0, y)}, flip=flip)["res", "v"]
    assert gap(J[0], [-mp.mpf(y) / (4 + mp.mpf(y) ** 2), -2 / (4 + mp.mpf(y) ** 2)]) < mp.mpf("1e-45")


def test_flip_takes_the_other_logarithm() -> None:
    sample = {"x": (0.6, 0.0, -0.8, 1e-9), "z": (0.0, 0.0, 0.0, 1.0)}
    (a,), (b,) = (reference.outputs(prior_so3.graph, sample, flip=f).values() for f in (False, True))
    size = mp.sqrt(sum(x * x for x in a))
    assert gap(b, [x - 2 * mp.pi * x / size for x in a]) < mp.mpf("1e-60")
    assert gap(expm(skew(b)), expm(skew(a))) < mp.mpf("1e-60")
    plane = {"x": (-1.0, 1e-9), "z": (1.0, 0.0)}
    ((u,),), ((v,),) = (reference.outputs(prior_so2.graph, plane, flip=f).values() for f in (False, True))
    assert u > 3
    assert abs(v - (u - 2 * mp.pi)) < mp.mpf("1e-60")
    away = {"x": (0.6, 0.0, -0.8, 0.1), "z": (0.0, 0.0, 0.0, 1.0)}
    assert gap(*(reference.outputs(prior_so3.graph, away, flip=f)["res"] for f in (False, True))) == 0


@pytest.mark.parametrize("manifold", ["SO2", "SO3", "SE2", "SE3"])
def test_near_continues_across_the_cut(manifold: str) -> None:
    graph = PRIORS[manifold].graph
    d = [float(x) for x in tangent(manifold, mp.pi, 3)]
    sample = {"x": reference.retract(MANIFOLDS[manifold], unit(manifold), d), "z": unit(manifold)}
    base = reference.evaluate(graph, sample)
    step = [1e-3] * len(d)
    for sign in (1, -1):
        moved = reference.retract(MANIFOLDS[manifold], sample["x"], [sign * s for s in step])
        near = reference.evaluate(graph, {**sample, "x": moved}, base)
        assert gap(near.outputs["res"], base.outputs["res"]) < 0.2
        free = reference.outputs(graph, {**sample, "x": moved})["res"]
        assert gap(expm(hat(manifold, near.outputs["res"])), expm(hat(manifold, free))) < mp.mpf("1e-45")


def unit(manifold: str) -> list[float]:
    return [float(c) for c in np.asarray(MANIFOLDS[manifold].identity())]  # type: ignore[attr-defined]


@pytest.mark.parametrize("n", [(0.0, 0.0, 1.0), (0.6, 0.6, 0.5291502622129182), (1.0, 0.0, 0.0)])
def test_sphere_bases_do_not_jump_at_ties(n: tuple[float, ...]) -> None:
    """At equal components the basis at n changes its axis; the derivative follows the axis taken at n."""
    z = reference.retract(S2, n, (0.3, -0.4))
    J = reference.jacobians(prior_s2_gtsam.graph, {"x": n, "z": z})["res", "x"]
    assert max(abs(float(e)) for row in J for e in row) < 3
    at = reference.jacobians(prior_s2_gtsam.graph, {"x": n, "z": n})["res", "x"]
    assert gap(at, [[1, 0], [0, 1]]) < mp.mpf("1e-45")


# --- domain and undefined values ----------------------------------------------------------------------------


@factor
def guarded(p: R3, *, z: R1) -> Vector:
    require(p[2] > 0, "behind")
    require(z <= p[0], "beyond")
    return stack(p[:2] / p[2], sqrt(p[0]), log(p[1]), acos(p[0])) - z


def test_domain() -> None:
    assert reference.holds(guarded.graph, {"p": (0.5, 1, 2), "z": (0.5,)}) == (True, True)
    assert reference.holds(guarded.graph, {"p": (0.5, 1, -2), "z": (0.6,)}) == (False, False)


def test_undefined_values_are_nan() -> None:
    found = reference.outputs(guarded.graph, {"p": (-2.0, -1.0, 0.0), "z": (0.0,)})["res"]
    assert all(mp.isnan(x) for x in found)
    J = reference.jacobians(guarded.graph, {"p": (-2.0, -1.0, 0.0), "z": (0.0,)})["res", "p"]
    assert all(mp.isnan(J[i][0]) for i in (0, 2, 4))


def test_undefined_directions_are_nan() -> None:
    sample = {"x": (0, 0, 0, 1, 1, 2, 3), "y": (1, 2, 3), "z": (0, 0, 1)}
    assert all(mp.isnan(x) for x in reference.outputs(bearing_gtsam.graph, sample)["res"])
