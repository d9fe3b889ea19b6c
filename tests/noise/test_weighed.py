"""Whitened and robust factors: numbers, gradients, kinks, generated code, bad input."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from loss_reference import RHO
from mpmath import mp, mpf

from liegen import R1, R3, R9, DefinitionError, factor, function
from liegen.emit import render
from liegen.library import between_se2, between_se3, prior_r3
from liegen.noise import LOSSES, MODES, NOISES
from liegen.program.rewrite import Builder
from liegen.uncertainty import packed
from liegen.verify import verify
from liegen.verify.backends import load_package
from liegen.verify.mutate import mutants

RNG = np.random.default_rng(7)
NAMED = [(loss, mode, shape) for loss in LOSSES for mode in MODES for shape in LOSSES[loss].shapes]


def pose():
    q = RNG.normal(size=4)
    return [*(q / np.linalg.norm(q)), *RNG.normal(size=3)]


X, Y, Z = pose(), pose(), pose()
S = RNG.normal(size=(6, 6))


@pytest.mark.parametrize(
    ("noise", "given", "matrix"),
    [
        ("full", S, np.triu(S)),
        ("packed", packed(S), np.triu(S)),
        ("diagonal", S[0], np.diag(S[0])),
        ("isotropic", S[0, :1], S[0, 0] * np.eye(6)),
    ],
)
def test_whitening_is_a_product(noise, given, matrix):
    plain = between_se3.jacobians(X, Y, z=Z)
    white = between_se3.whitened(noise).jacobians(X, Y, z=Z, sqrt_info=given)
    for name, value in plain.items():
        np.testing.assert_allclose(white[name], matrix @ value, rtol=0, atol=1e-13)


def test_below_the_diagonal_nothing_is_read():
    dirty = np.triu(S) + np.tril(np.full((6, 6), np.nan), -1)
    found = between_se3.whitened("full").jacobians(X, Y, z=Z, sqrt_info=dirty)
    assert all(np.isfinite(x).all() for x in found.values())


def test_generated_numpy_takes_a_matrix(tmp_path: Path):
    kernel = between_se3.whitened("full", "huber").kernel
    for path, text in render([kernel], ["numpy"], package="made", regenerate="").items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(text)
    package = load_package(tmp_path / "made")
    found = package.between_se3_jacobians(X, Y, z=Z, sqrt_info=np.stack([S, 2 * S]), k=[1.345])
    assert found.res.shape == (2, 6)
    assert found.res_D_x.shape == (2, 6, 6)
    mine = between_se3.whitened("full", "huber").jacobians(X, Y, z=Z, sqrt_info=S, k=[1.345])
    np.testing.assert_allclose(found.res_D_y[0], mine["res_D_y"], rtol=1e-13)
    with pytest.raises(ValueError, match=r"argument sqrt_info: expected shape \(..., 6, 6\), got \(36,\)"):
        package.between_se3(X, Y, z=Z, sqrt_info=S.ravel(), k=[1.0])


@pytest.mark.parametrize(("loss", "mode", "shape"), NAMED, ids=str)
def test_gradient_of_the_cost(loss, mode, shape):
    """r = x - z and S diagonal: the cost is a function of three numbers, differentiated by mpmath."""
    scale = 1.5
    made = prior_r3.whitened("diagonal", loss, mode)
    info = np.array([1.0, 0.5, 2.0])
    direction = np.array([2.0, 1.0, 2.0]) / 3.0
    parameters = dict(zip(LOSSES[loss].parameters, ([p] for p in (*shape, scale)), strict=True))
    # 0, |u| = 1.5 (the kinks of Huber and Tukey), both sides of it, far out
    for length in (
        0.0,
        1e-160,
        1e-9,
        0.3,
        np.nextafter(1.5, 0),
        1.5,
        np.nextafter(1.5, 2),
        2.7,
        9.0,
        1e3,
        1e100,
    ):
        if length > 1e3 and shape and shape[0] > 2:
            continue  # rho overflows
        u = length * direction
        x = u / info
        found = made.jacobians(x, z=[0.0, 0.0, 0.0], sqrt_info=info, **parameters)
        got = found["res_D_x"].T @ found["res"]
        with mp.workdps(60):
            r = [mpf(float(a)) * mpf(float(b)) for a, b in zip(info, x, strict=True)]
            s = mp.fdot(r, r)
            h = (s + scale**2) * mpf(10) ** -25
            rho = [RHO[loss](t, *map(mpf, (*shape, scale))) for t in (s + h, s - h)]
            slope = (rho[0] - rho[1]) / (2 * h)
            exact = [float(slope * a * mpf(float(b))) for a, b in zip(r, info, strict=True)]
        size = max(abs(e) for e in exact)
        triggs = 64 if mode == "triggs" else 1  # the correction cancels up to its limit of alpha
        np.testing.assert_allclose(got, exact, rtol=0, atol=2e-14 * size * triggs + 1e-24 * length)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("loss", LOSSES)
def test_slope_at_zero_is_one(loss, mode):
    """The weighed Jacobian at r = 0 is the whitened one; SymForce's pseudo-Huber has 0 there."""
    made = prior_r3.whitened(None, loss, mode)
    for shape in LOSSES[loss].shapes:
        values = dict(zip(LOSSES[loss].parameters, ([p] for p in (*shape, 1.3)), strict=True))
        found = made.jacobians([0.0, 0, 0], z=[0.0, 0, 0], **values)
        np.testing.assert_array_equal(found["res_D_x"], np.eye(3))
        np.testing.assert_array_equal(found["res"], np.zeros(3))


def test_triggs_is_the_exact_second_order_where_it_is_definite():
    """J^T J along r is rho' + 2 s rho''; Ceres' documentation, section Theory of loss functions."""
    s, c = 0.25, 1.5
    found = prior_r3.whitened(None, "cauchy", "triggs").jacobians([0.5, 0, 0], z=[0.0, 0, 0], c=[c])
    slope, curvature = 1 / (1 + s / c**2), -1 / c**2 / (1 + s / c**2) ** 2
    JtJ = found["res_D_x"].T @ found["res_D_x"]
    np.testing.assert_allclose(JtJ, np.diag([slope + 2 * s * curvature, slope, slope]), rtol=1e-14)


def test_triggs_is_limited_where_the_curvature_is_negative():
    found = prior_r3.whitened(None, "huber", "triggs").jacobians([4.0, 0, 0], z=[0.0, 0, 0], k=[1.0])
    np.testing.assert_allclose(found["res"], [0.5 * 64 * 4, 0, 0], rtol=1e-15)
    np.testing.assert_allclose(found["res_D_x"], np.diag([0.5 / 64, 0.5, 0.5]), rtol=1e-13)


@pytest.mark.parametrize("noise", NOISES)
def test_whitened_factors_pass_all_checks(noise):
    report = verify([between_se2.whitened(noise)], samples=16)
    assert report.passed
    assert {"value", "Jacobian", "differences", "Taylor"} <= {
        c.name for c in report.factors[0].checks if c.checked
    }


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("loss", LOSSES)
def test_robust_factors_pass_and_say_what_does_not_apply(loss, mode):
    (report,) = verify([between_se2.whitened("full", loss, mode)], samples=12).factors
    assert report.passed
    checks = {c.name: c for c in report.checks}
    assert checks["gradient"].checked
    assert checks["gradient"].kept >= 10
    assert checks["Jacobian"].checked
    assert checks["Jacobian"].kept >= 10
    assert "does not apply" in checks["differences"].note


def test_the_gradient_check_can_fail():
    made = prior_r3.whitened("full", "cauchy", "irls")
    caught = total = 0
    for _, program in list(mutants(made.kernel.jacobians, 3))[:40]:
        broken = prior_r3.whitened("full", "cauchy", "irls", name="broken")
        broken.__dict__["kernel"] = replace(made.kernel, name="broken", jacobians=program)
        (report,) = verify([broken], samples=6).factors
        total, caught = total + 1, caught + (not report.passed)
    assert caught >= 0.9 * total


@pytest.mark.parametrize("mode", MODES)
def test_the_jacobian_is_held_against_its_definition(mode):
    """A column moved across the residual leaves J^T r as it is."""
    made = prior_r3.whitened("full", "cauchy", mode)
    program = made.kernel.jacobians
    builder = Builder()
    builder.code.extend(program.code)
    res, J = program.results
    moved = list(J)
    size = builder.const(1e-6)
    moved[0] = builder.emit("sub", (J[0], builder.emit("mul", (size, res[1]))))
    moved[3] = builder.emit("add", (J[3], builder.emit("mul", (size, res[0]))))
    wrong = replace(program, code=tuple(builder.code), results=(res, tuple(moved)))
    broken = prior_r3.whitened("full", "cauchy", mode, name="broken")
    broken.__dict__["kernel"] = replace(made.kernel, name="broken", jacobians=wrong)
    for weighed, right in ((made, True), (broken, False)):
        (report,) = verify([weighed], samples=6).factors
        checks = {c.name: c.passed for c in report.checks}
        assert checks["gradient"]
        assert checks["Jacobian"] is right


def test_header_and_explain_say_noise_loss_mode_and_frame():
    text = "\n".join(between_se3.whitened("full", "huber", "triggs").kernel.noise)
    for words in ("noise: full", "loss: huber", "mode: triggs", "in the body frame of z"):
        assert words in text


def test_bad_names_list_those_that_exist():
    with pytest.raises(
        DefinitionError, match="unknown noise 'fulll'; choose from full, packed, diagonal, isotropic"
    ):
        between_se3.whitened("fulll")
    with pytest.raises(
        DefinitionError, match="unknown loss 'hubert'; choose from huber, pseudo-huber, cauchy"
    ):
        between_se3.whitened(loss="hubert")
    with pytest.raises(DefinitionError, match="unknown mode 'x'; choose from irls, triggs"):
        between_se3.whitened(loss="huber", mode="x")
    with pytest.raises(DefinitionError, match="give loss= too"):
        factor(mode="irls")


def test_bad_uses():
    with pytest.raises(DefinitionError, match=r"is also what noise or loss adds .*; rename the argument"):

        @factor(noise="isotropic")
        def own(x: R1, *, sqrt_info: R1):
            return x - sqrt_info

    @function
    def f(x: R3) -> R3:
        return 2.0 * x

    with pytest.raises(DefinitionError, match="is a @function"):
        f.whitened("full")
    with pytest.raises(DefinitionError, match=r"shape \(..., 6, 6\) is needed"):
        between_se3.whitened("full")(X, Y, z=Z, sqrt_info=np.eye(3))
    white = prior_r3.whitened("full")
    with pytest.raises(DefinitionError, match="give noise= and loss= to the outer factor"):

        @factor
        def outer(x: R3, *, z: R3, S: R9):
            return white(x, z=z, sqrt_info=S)


def test_the_decorator_whitens():
    @factor(noise="isotropic", loss="cauchy")
    def distance(x: R1, *, z: R1):
        return x - z

    r, c, w = 3.0, 2.0, 0.5
    found = distance.jacobians([r], z=[0.0], sqrt_info=[w], c=[c])
    root = 1 / np.sqrt(1 + (w * r / c) ** 2)
    np.testing.assert_allclose(found["res"], [root * w * r], rtol=1e-15)
    np.testing.assert_allclose(found["res_D_x"], [[root * w]], rtol=1e-15)
