"""The order of Gal3's tangent beside GTSAM's, as docs/conventions.md states it."""

import numpy as np
import pytest

from liegen import Gal3

gtsam = pytest.importorskip("gtsam")
if not hasattr(gtsam, "Gal3"):
    pytest.skip("this GTSAM has no Gal3", allow_module_level=True)

#: From one order to the other, either way.
SWAPPED = [0, 1, 2, 6, 7, 8, 3, 4, 5, 9]


def test_tangents_differ_by_the_stated_permutation():
    rng = np.random.default_rng(7)
    for _ in range(10):
        d = rng.normal(size=10) * 0.7
        theirs, ours = gtsam.Gal3.Expmap(d[SWAPPED]), Gal3.exp(d)
        found = [*theirs.position(), *theirs.velocity(), theirs.time()]
        assert np.allclose(found, np.asarray(ours)[4:], atol=1e-13)
        assert np.allclose(theirs.attitude().matrix(), ours.rotation.matrix(), atol=1e-13)
        assert np.allclose(gtsam.Gal3.Logmap(theirs)[SWAPPED], ours.log(), atol=1e-12)
