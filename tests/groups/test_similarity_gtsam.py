"""Sim2 and Sim3 against GTSAM's Similarity2 and Similarity3, whose p -> s (R p + t) has the same tangent."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from liegen import Sim2, Sim3

gtsam: Any = pytest.importorskip("gtsam", reason="no GTSAM here (pip install gtsam)")
if not hasattr(gtsam, "Similarity2") or not hasattr(gtsam.Similarity2, "Expmap"):
    pytest.skip("this GTSAM has no exponential of similarities", allow_module_level=True)
PAIRS = [(Sim2, gtsam.Similarity2), (Sim3, gtsam.Similarity3)]
pairs = pytest.mark.parametrize(("G", "H"), PAIRS, ids=lambda c: c.__name__)


def tangents(dim):
    rng = np.random.default_rng(5)
    yield np.zeros(dim)
    for _ in range(20):
        yield rng.normal(size=dim) * 0.7


def close(ours, theirs):
    """The matrices of GTSAM are [[R, t / s], [0, 1 / s]], ours are s times that."""
    np.testing.assert_allclose(ours.matrix(), theirs.scale() * theirs.matrix(), rtol=0, atol=1e-12)


@pairs
def test_exponential_and_logarithm(G, H):
    for d in tangents(G.form.dim):
        close(G.exp(d), H.Expmap(d))
        np.testing.assert_allclose(np.asarray(G.exp(d).log()), H.Logmap(H.Expmap(d)), rtol=0, atol=1e-11)


@pairs
def test_retract_local_and_products(G, H):
    for c, d in pairwise(tangents(G.form.dim)):
        x, y = G.exp(c), H.Expmap(c)
        close(x.retract(d), y.retract(d))
        close(x @ G.exp(d), y.compose(H.Expmap(d)))
        close(x.inverse(), y.inverse())
        close(x.between(G.exp(d)), y.between(H.Expmap(d)))
        np.testing.assert_allclose(
            np.asarray(x.local(G.exp(d))), y.localCoordinates(H.Expmap(d)), rtol=0, atol=1e-11
        )
        np.testing.assert_allclose(x.adjoint(), y.AdjointMap(), rtol=0, atol=1e-11)


@pairs
def test_points_and_parts(G, H):
    for d in tangents(G.form.dim):
        x, y = G.exp(d), H.Expmap(d)
        p = np.arange(1.0, 1 + G.form.space)
        np.testing.assert_allclose(np.asarray(x @ p), y.transformFrom(p), rtol=0, atol=1e-12)
        np.testing.assert_allclose(
            np.asarray(x.translation), y.scale() * np.asarray(y.translation()), atol=1e-12
        )
        assert float(x.scale) == pytest.approx(y.scale(), rel=1e-15)
