"""What the tests of compiled factors share."""

import numpy as np


def results(value):
    return list(value) if isinstance(value, tuple | list) else [value]


def close(a, b):
    for u, v in zip(results(a), results(b), strict=True):
        assert u.shape == v.shape
        np.testing.assert_allclose(u, v, rtol=1e-11, atol=1e-12)
