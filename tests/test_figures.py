"""Figures that the project promises: operation counts of the checked-in code."""

import json
from pathlib import Path

import pytest

MANIFEST = Path(__file__).resolve().parents[1] / "generated" / "liegen_factors.json"
FACTORS = json.loads(MANIFEST.read_text())["factors"]


@pytest.mark.parametrize(
    ("name", "most"), [("between_se3", 412), ("between_se2", 70), ("projection_cal3_s2", 97)]
)
def test_operations_with_jacobians(name, most):
    counted = FACTORS[name]["jacobians"]
    assert counted["operations"] == sum(counted["operations_by_kind"].values()) <= most


def test_a_residual_costs_less_than_its_jacobians():
    assert all(f["value"]["operations"] <= f["jacobians"]["operations"] for f in FACTORS.values())
