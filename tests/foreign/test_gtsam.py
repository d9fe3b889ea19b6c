"""Factors of an installed GTSAM: BetweenFactorPose3 is right, BearingFactor3D at zero residual only."""

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "gtsam_factors.py"
installed = pytest.mark.skipif(
    importlib.util.find_spec("gtsam") is None, reason="no GTSAM here (pip install gtsam)"
)


def checked(name, function):
    command = [sys.executable, "-m", "liegen", "check-jacobian", name, "--against", f"{EXAMPLE}:{function}"]
    done = subprocess.run([*command, "--json"], capture_output=True, text=True, check=False)
    return json.loads(done.stdout)


@installed
def test_between_is_right():
    assert checked("between_se3", "between")["passed"]


@installed
def test_bearing_is_wrong_away_from_zero_residual():
    res, by_x, by_y = checked("bearing_se3_r3_gtsam", "bearing")["findings"]
    assert res["correct"]
    for found in (by_x, by_y):
        assert not found["correct"]
        assert found["correct_at_zero"]
        assert found["worst"] > 0.1
        assert found["differences"] == []
