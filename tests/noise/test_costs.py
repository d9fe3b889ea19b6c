"""The cost of a robust factor is half of rho at the squared norm of the whitened residual."""

import numpy as np
import pytest
from loss_reference import RHO
from mpmath import mpf

from liegen.library import prior_r3
from liegen.noise import LOSSES

X, Z = np.array([0.4, -1.7, 2.2]), np.array([-0.3, 0.5, 0.1])
ROOTS = np.array([0.7, 1.9, 0.4])


@pytest.mark.parametrize("mode", ["irls", "triggs"])
@pytest.mark.parametrize("loss", LOSSES)
def test_the_cost_is_half_of_rho(loss, mode):
    shape = {name: [x] for name, x in zip(LOSSES[loss].shape, LOSSES[loss].shapes[0], strict=True)}
    scale = {LOSSES[loss].scale: [1.3]}
    robust = prior_r3.whitened("diagonal", loss, mode)
    terms = robust.gauss_newton(X, z=Z, sqrt_info=ROOTS, **shape, **scale)
    s = sum(
        (mpf(float(w)) * (mpf(float(x)) - mpf(float(z)))) ** 2 for w, x, z in zip(ROOTS, X, Z, strict=True)
    )
    expected = RHO[loss](s, *(mpf(x) for (x,) in shape.values()), mpf(1.3)) / 2
    assert float(terms["cost"][0]) == pytest.approx(float(expected), rel=1e-14)
