"""The proof of the reference's logarithms by expm, group axioms, storage, charts."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pytest
from reference_tools import MANIFOLDS, ORDER, ROTATION, gap, hat, tangent

import liegen.manifolds as lm
from liegen.manifolds import R2, S2, SE2, SE3, SO2, SO3, Cal3_S2, Cal3Bundler, Cal3DS2
from liegen.verify import reference
from liegen.verify.reference.logarithms import Branch
from liegen.verify.reference.matrix import expm, skew
from liegen.verify.reference.spaces import GROUPS

mp: Any = mpmath.mp


@pytest.fixture(autouse=True)
def _working_precision() -> Any:
    with mp.workdps(reference.DIGITS):
        yield


def angles() -> dict[str, Any]:
    pi = +mp.pi
    return {
        "0": mp.zero,
        "1e-300": mp.mpf("1e-300"),
        "1e-160": mp.mpf("1e-160"),
        "1e-12": mp.mpf("1e-12"),
        "1e-3": mp.mpf("1e-3"),
        "1": mp.one,
        "half pi": pi / 2,
        "2": mp.mpf(2),
        "3.1": mp.mpf("3.1"),
        "pi - 1e-8": pi - mp.mpf("1e-8"),
        "pi - 1e-20": pi - mp.mpf("1e-20"),
        "pi - 1e-40": pi - mp.mpf("1e-40"),
        "pi": pi,
    }


@pytest.mark.parametrize("size", [1e-9, 1.0, 40.0])
def test_expm_agrees_with_mpmath(size: float) -> None:
    g = np.random.default_rng(1)
    a = tuple(tuple(mp.mpf(float(x)) for x in row) for row in g.normal(size=(4, 4)) * size / 4)
    with mp.workdps(160):
        expected = mp.expm(mp.matrix([list(row) for row in a]))
    scale = max(abs(x) for x in expected)
    assert gap(expm(a), tuple(tuple(expected[i, j] for j in range(4)) for i in range(4))) < 1e-65 * scale


@pytest.mark.parametrize("name", list(MANIFOLDS))
@pytest.mark.parametrize("angle", list(angles()))
@pytest.mark.parametrize("length", [3.0, 1e-170, 1e6])
def test_expm_of_log_is_the_element(name: str, angle: str, length: float) -> None:
    """The proof of the logarithm; hat and expm are all that it rests on."""
    for seed in range(5):
        d = tangent(name, angles()[angle], seed, length)
        T = expm(hat(name, d))
        v = GROUPS[name].log(T, Branch())
        assert gap(expm(hat(name, v)), T) < mp.mpf("1e-45")
        size = mp.sqrt(sum(x * x for x in v[ROTATION[name]]))
        assert size <= mp.pi + mp.mpf("1e-60")
        if (
            angle != "pi"
        ):  # where the logarithm is unique it is the tangent vector itself, relative to its size
            for part in (ROTATION[name], *_translation(name)):
                large = max(abs(x) for x in d[part])
                assert gap(v[part], d[part]) <= mp.mpf("1e-45") * large


def _translation(name: str) -> list[slice]:
    return {
        "SE2": [slice(0, 2)],
        "SE3": [slice(3, 6)],
        "SE23": [slice(3, 6), slice(6, 9)],
        "Gal3": [slice(3, 6), slice(6, 9), slice(9, 10)],
        "Sim2": [slice(0, 2), slice(3, 4)],
        "Sim3": [slice(3, 6), slice(6, 7)],
    }.get(name, [])


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, -1, 0), (0, 0, 1), (3, -4, 0)])
def test_half_turns_about_exact_axes(axis: tuple[int, ...]) -> None:
    n = math.hypot(*axis)
    R = reference.from_coords(SO3, [*(x / n for x in axis), 0.0])
    v = GROUPS["SO3"].log(R, Branch())
    assert gap(expm(skew(v)), R) < mp.mpf("1e-45")
    w = GROUPS["SO3"].log(R, Branch(flip=True))
    assert gap(w, tuple(-x for x in v)) < mp.mpf("1e-60")


@pytest.mark.parametrize("name", list(MANIFOLDS))
def test_group_axioms_and_storage(name: str) -> None:
    manifold, group = MANIFOLDS[name], GROUPS[name]
    a, b, c = (group.exp(tangent(name, mp.mpf(angle), seed)) for seed, angle in enumerate((0.7, 2.9, 5.0)))
    assert gap(group.compose(a, group.compose(b, c)), group.compose(group.compose(a, b), c)) < mp.mpf("1e-70")
    unit = group.exp((mp.zero,) * ORDER[name])
    assert gap(unit, reference.from_coords(manifold, np.asarray(manifold.identity()))) == 0  # type: ignore[attr-defined]
    assert gap(group.compose(a, group.inverse(a)), unit) < mp.mpf("1e-70")
    assert gap(group.compose(group.inverse(a), a), unit) < mp.mpf("1e-70")
    stored = reference.to_coords(manifold, a)
    assert gap(reference.from_coords(manifold, stored), a) < 1e-14


@pytest.mark.parametrize("k", range(4))
def test_quaternions_of_every_largest_component(k: int) -> None:
    q = np.array([0.1, -0.2, 0.3, 0.15])
    q[k] = -2.0
    q /= np.linalg.norm(q)
    R = reference.from_coords(SO3, q)
    assert reference.to_coords(SO3, R, q) == pytest.approx(q, abs=2e-16)
    assert reference.to_coords(SO3, R, -q) == pytest.approx(-q, abs=2e-16)
    assert reference.to_coords(SO3, R)[3] >= 0
    assert gap(reference.from_coords(SO3, -q), R) == 0
    assert gap(reference.from_coords(SO3, 1.7 * q), R) < 1e-15  # normalised


def test_rotations_match_scipy() -> None:
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    g = np.random.default_rng(4)
    for _ in range(20):
        q, d, v = g.normal(size=4), g.normal(size=3), g.normal(size=3)
        q /= np.linalg.norm(q)
        moved = reference.retract(SO3, q, d)
        expected = rotation.from_quat(q) * rotation.from_rotvec(d)
        assert rotation.from_quat(moved).as_matrix() == pytest.approx(expected.as_matrix(), abs=1e-14)
        assert float(np.dot(moved, q)) > 0 or np.linalg.norm(d) > 2
        turned = reference.from_coords(SO3, q)
        assert [float(sum(a * b for a, b in zip(row, v, strict=True))) for row in turned] == pytest.approx(
            rotation.from_quat(q).apply(v), abs=1e-14
        )


@pytest.mark.parametrize("manifold", [R2, SO2, SO3, SE2, SE3, S2, Cal3_S2, Cal3DS2, Cal3Bundler])
def test_local_inverts_retract_in_doubles(manifold: type[lm.Manifold]) -> None:
    g = np.random.default_rng(7)
    for _ in range(5):
        x = g.normal(size=manifold.form.size)
        unit = {"SO2": 2, "SE2": 2, "SO3": 4, "SE3": 4, "S2": 3}.get(manifold.form.name, 0)
        x[:unit] /= np.linalg.norm(x[:unit]) if unit else 1
        d = g.normal(size=manifold.form.dim) * 0.5
        y = reference.retract(manifold, x, d)
        assert reference.local(manifold, x, y) == pytest.approx(d, abs=2e-15)
        assert len(y) == manifold.form.size


def test_sphere_basis_is_gtsams() -> None:
    """At n = (0, 0, 1) the axis is x: b1 = n x ex = ey, b2 = n x b1 = -ex."""
    assert reference.retract(S2, (0, 0, 1), (math.pi / 2, 0)) == pytest.approx((0, 1, 0), abs=1e-16)
    assert reference.retract(S2, (0, 0, 1), (0, math.pi / 2)) == pytest.approx((-1, 0, 0), abs=1e-16)
    assert reference.local(S2, (0, 0, 1), (0, 0, -1)) == pytest.approx((math.pi, 0))
    n = np.array([0.5, -0.2, 0.8]) / np.linalg.norm([0.5, -0.2, 0.8])
    b1 = np.cross(n, [0, 1, 0]) / np.linalg.norm(np.cross(n, [0, 1, 0]))
    assert reference.retract(S2, n, (0.3, 0)) == pytest.approx(
        math.cos(0.3) * n + math.sin(0.3) * b1, abs=1e-15
    )
