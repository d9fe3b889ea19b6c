"""Factors of an installed GTSAM, and of a small stand-in that shows how noise is taken out."""

import importlib.util
import json
import sys
import types
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from liegen import library
from liegen.cli import app
from liegen.errors import SourceError, ToolError
from liegen.foreign import compare, foreign
from liegen.foreign.gtsam_values import ROWS, from_gtsam, to_gtsam
from liegen.foreign.signature import Argument
from liegen.samples import Draw

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples" / "gtsam_factors.py"
MISSING = "Jr^-1(res) is missing (right at zero residual only)"
installed = pytest.mark.skipif(
    importlib.util.find_spec("gtsam") is None, reason="no GTSAM here (pip install gtsam)"
)


def run(name, place, *options):
    return CliRunner().invoke(app, ["check-jacobian", name, "--against", place, *options])


def checked(name, place, *options):
    done = run(name, place, "--json", *options)
    assert done.exit_code in (0, 1), done.output
    return json.loads(done.stdout)


def corrects_jr():
    """Whether this GTSAM multiplies by Jr^-1, as 4.3 does and 4.2 does not."""
    import gtsam

    return hasattr(gtsam, "Gal3")


# GTSAM itself


@installed
@pytest.mark.parametrize(
    ("name", "place"),
    [
        ("between_se3", "gtsam:BetweenFactorPose3"), ("between_se3", f"{EXAMPLES}:between"),
        ("between_so3", "gtsam:BetweenFactorRot3"), ("prior_se3", f"{EXAMPLES}:prior"),
    ],
)  # fmt: skip
def test_between_is_right_since_it_has_jr(name, place):
    found = checked(name, place)
    if corrects_jr():
        assert found["passed"]
        assert all(f["worst"] < 1e-13 for f in found["findings"])
    else:
        res, *jacobians = found["findings"]
        assert res["correct"]
        assert all(f["differences"] == [MISSING] for f in jacobians)


@installed
def test_a_between_without_jr_is_found():
    res, *jacobians = checked("between_se3", f"{EXAMPLES}:approximate", "--given", "z=z")["findings"]
    assert res["correct"]
    assert all(f["differences"] == [MISSING] and f["correct_at_zero"] for f in jacobians)


@installed
@pytest.mark.parametrize("place", ["gtsam:BearingFactor3D", f"{EXAMPLES}:bearing"])
def test_bearing_is_wrong_away_from_zero_residual(place):
    res, by_x, by_y = checked("bearing_se3_r3_gtsam", place)["findings"]
    assert res["correct"]
    for found in (by_x, by_y):
        assert not found["correct"]
        assert found["correct_at_zero"]
        assert found["worst"] > 0.1
        assert found["differences"] == []


@installed
@pytest.mark.parametrize(
    ("name", "place"),
    [
        ("projection_cal3_s2", f"{EXAMPLES}:camera"), ("range_se3_r3", "gtsam:RangeFactor3D"),
        ("range_se2_r2", "gtsam:RangeFactor2D"), ("between_r3", "gtsam:BetweenFactorPoint3"),
        ("between_so2", "gtsam:BetweenFactorRot2"), ("bearing_se2_r2", "gtsam:BearingFactor2D"),
    ],
)  # fmt: skip
def test_others_are_right(name, place):
    assert checked(name, place)["passed"]


@installed
def test_values_go_to_gtsam_and_back():
    import gtsam

    import liegen

    draw = Draw(np.random.default_rng(4))
    rows = {name: row for name, row in ROWS.items() if hasattr(gtsam, row.name)}
    for name in (*rows, "R1", "R2", "R3", "R6"):
        manifold = getattr(liegen, name)
        stored = np.asarray(draw.element(manifold), dtype=np.float64)
        form = manifold.form
        argument = Argument("x", form.name, True, issubclass(manifold, liegen.R), form.dim, (form.size,))
        back = from_gtsam(argument, to_gtsam(gtsam, argument, stored))
        sign = np.sign(back[:4] @ stored[:4]) if manifold.form.quaternions else 1.0
        back[:4] *= sign if manifold.form.quaternions else 1.0
        np.testing.assert_allclose(back, stored, rtol=0, atol=1e-12 * max(1, np.abs(stored).max()))


# a stand-in


class Values(dict):
    def insert(self, key, value):
        self[key] = value


class Noise:
    def __init__(self, R):
        self._R = R

    def R(self):
        return self._R


class Robust(Noise):
    pass


class Linear:
    def __init__(self, A, b):
        self._A, self._b = A, b

    def jacobian(self):
        return self._A, self._b


class BetweenFactorPoint3:
    """Whitens as GTSAM does; ``error`` is a mistake in the Jacobian by the second key."""

    error = 0.0

    def __init__(self, first, second, measured, noise):
        self._keys, self._measured, self._noise = [first, second], measured, noise

    def keys(self):
        return self._keys

    def measured(self):
        return self._measured

    def noiseModel(self):
        return self._noise

    def unwhitenedError(self, values):
        x, y = (values[k] for k in self._keys)
        return y - x - self._measured

    def linearize(self, values):
        J = np.hstack([-np.eye(3), np.eye(3) + self.error])
        return Linear(self._noise.R() @ J, -self._noise.R() @ self.unwhitenedError(values))


class Wrong(BetweenFactorPoint3):
    error = 0.25


@pytest.fixture
def gtsam(monkeypatch):
    unit = types.SimpleNamespace(Create=lambda n: Noise(np.eye(n)))
    module = types.ModuleType("gtsam")
    module.noiseModel = types.SimpleNamespace(Unit=unit)
    for cls in (Values, BetweenFactorPoint3, Wrong):
        monkeypatch.setattr(cls, "__module__", "gtsam")
        setattr(module, cls.__name__, cls)
    R = np.array([[2.0, 0.3, -1.0], [0.0, 0.5, 4.0], [0.0, 0.0, 7.0]])
    z = np.array([1.0, -2.0, 0.5])
    module.right = BetweenFactorPoint3(5, 3, z, Noise(R))
    module.wrong = Wrong(5, 3, z, Noise(R))
    module.robust = BetweenFactorPoint3(5, 3, z, Robust(R))
    module.measurement = z
    monkeypatch.setitem(sys.modules, "gtsam", module)
    return module


def test_noise_is_taken_out_of_the_jacobians(gtsam):
    found = compare(library.between_r3, foreign("gtsam:right", library.between_r3))
    assert found.passed
    assert max(f.worst for f in found.findings) < 1e-14
    res, by_x, by_y = compare(library.between_r3, foreign("gtsam:wrong", library.between_r3)).findings
    assert res.correct
    assert by_x.correct
    assert by_y.worst == pytest.approx(0.25, rel=1e-12)


def test_the_measurement_is_that_of_the_object(gtsam):
    found = foreign("gtsam:right", library.between_r3)
    np.testing.assert_array_equal(np.asarray(found.given["z"]), gtsam.measurement)
    res, *_ = compare(library.between_r3, found).findings
    assert "z = [1.0, -2.0, 0.5]" in res.sample
    assert res.correct_at_zero  # variables are moved to where the residual of this z is zero


def test_classes(gtsam):
    found = foreign("gtsam:BetweenFactorPoint3", library.between_r3)
    assert found.given == {}
    assert compare(library.between_r3, found).passed
    assert not compare(library.between_r3, foreign("gtsam:Wrong", library.between_r3)).passed
    with pytest.raises(ToolError, match=r"BetweenFactorPoint3\(key_x, z, noise\) is not how it is made"):
        compare(library.prior_r3, foreign("gtsam:BetweenFactorPoint3", library.prior_r3))


@pytest.mark.parametrize(
    ("function", "given", "says"),
    [
        (library.prior_r3, {}, "gtsam:right has 2 keys, prior_r3 has the variables x"),
        (library.between_r2, {}, "gtsam:right tells no R2 for the argument 'z' of between_r2"),
        (library.between_r2, {"z": "nothing"}, "gtsam has no 'nothing'"),
    ],
)
def test_what_does_not_fit_the_formula_is_told(gtsam, function, given, says):
    with pytest.raises(SourceError, match=says):
        foreign("gtsam:right", function, given)


@pytest.mark.parametrize(
    ("name", "options", "says"),
    [
        ("between_r3", ["--given", "w=z"], "with one of between_r3's given arguments: z"),
        ("between_r3", ["--given", "z"], "write ARGUMENT=NAME"),
        ("between_r3", ["--chart", "none"], "unknown"),
    ],
)
def test_wrong_use_is_explained(gtsam, name, options, says):
    done = run(name, "gtsam:right", *options)
    assert done.exit_code == 2
    assert says in done.output


def test_a_robust_loss_cannot_be_taken_out(gtsam):
    with pytest.raises(ToolError, match="gtsam:robust: its Robust noise cannot be taken out"):
        compare(library.between_r3, foreign("gtsam:robust", library.between_r3))


def test_a_manifold_that_gtsam_lacks(gtsam):
    with pytest.raises(ToolError, match="the installed GTSAM has no Pose3, which 'z' needs"):
        compare(library.prior_se3, foreign("gtsam:BetweenFactorPoint3", library.prior_se3))


def test_what_is_no_factor_is_a_function(gtsam):
    with pytest.raises(SourceError, match="gtsam has no function 'measurement'"):
        foreign("gtsam:measurement", library.between_r3)
