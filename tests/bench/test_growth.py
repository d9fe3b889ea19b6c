"""Growth of code generation: the right functions, the right exponents. No time is asserted."""

import numpy as np
import pytest

from liegen import SE3
from liegen.bench.growth import Point, chain, exponents, growth, wide


def test_exponents_of_power_laws():
    points = [Point(n, 3e-3 * n**1.5, 100 * n**0.5) for n in (1, 2, 4, 8, 16, 32)]
    by_size, by_operations = exponents(points)
    assert by_size == pytest.approx(1.5)
    assert by_operations == pytest.approx(3.0)


def test_one_point_has_no_exponent():
    assert np.isnan(exponents([Point(1, 1.0, 1)])).all()


def test_the_chain_is_that_of_composed_poses():
    generator = np.random.default_rng(0)
    poses = [SE3.exp(generator.normal(size=6)) for _ in range(4)]
    *xs, z = poses
    expected = z.local(xs[0].compose(xs[1]).compose(xs[2]))
    names = {f"x{k}": x for k, x in enumerate(xs)}
    np.testing.assert_allclose(chain(3)(**names, z=z).coords, expected.coords, rtol=0, atol=1e-13)


def test_the_wide_residual_has_so_many_numbers():
    kernel = wide(5).kernel
    assert kernel.jacobians.outputs[0].size == 5
    assert kernel.jacobians.operations > wide(2).kernel.jacobians.operations


def test_growth_measures_every_size():
    found = growth("poses", chain, (1, 2, 3))
    assert [p.size for p in found.points] == [1, 2, 3]
    assert all(p.seconds > 0 for p in found.points)
