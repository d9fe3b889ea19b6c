"""Sparse H and g of many factors against dense sums of J^T J and J^T r."""

from __future__ import annotations

import pickle
import re
from pathlib import Path

import numpy as np
import pytest

import liegen
from compiler_tools import needs_compiler
from liegen import R3, SE3, DefinitionError, factor, function, library
from liegen.runtime import NormalEquations

RNG = np.random.default_rng(3)
N, M, L = 7, 20, 5


@factor
def sighting(x: SE3, p: R3, *, z: R3):
    """z is where p is seen from x: blocks of 6 and of 3."""
    return x.transform_to(p) - z


def poses(n):
    x = RNG.normal(size=(n, 7))
    x[:, :4] /= np.linalg.norm(x[:, :4], axis=1, keepdims=True)
    return x


@pytest.fixture(params=[pytest.param("c", marks=needs_compiler), "numpy"])
def backend(request):
    return request.param


def dense(dim, groups):
    """H and g by loops; a group is (Jacobians and residuals, {variable: (starts, dims)})."""
    H, g, cost = np.zeros((dim, dim)), np.zeros(dim), 0.0
    for found, places in groups:
        for k in range(len(found["res"])):
            J = np.zeros((found["res"].shape[1], dim))
            for name, (starts, size) in places.items():
                if starts[k] >= 0:
                    J[:, starts[k] : starts[k] + size] += found[f"res_D_{name}"][k]
            H, g = H + J.T @ J, g + J.T @ found["res"][k]
            cost += 0.5 * found["res"][k] @ found["res"][k]
    return cost, g, H


def agrees(terms, expected):
    cost, g, H = expected
    assert terms.cost == pytest.approx(cost, rel=1e-13)
    np.testing.assert_allclose(terms.g, g, rtol=0, atol=1e-13 * np.abs(H).max())
    np.testing.assert_allclose(terms.H.toarray(), H, rtol=0, atol=1e-13 * np.abs(H).max())


def test_blocks_of_one_size_make_a_bsr_array(backend):
    between, prior = library.between_se3.whitened("full"), library.prior_se3
    i = np.r_[np.arange(N), RNG.integers(0, N, M)]
    j = np.r_[np.roll(np.arange(N), 1), RNG.integers(0, N, M)]  # some join a pose to itself
    j[-1] = i[-1]
    x, z, S = poses(N), poses(len(i)), np.triu(RNG.normal(size=(len(i), 6, 6)))
    edges = liegen.compile(between, backend=backend).indexed(x=i, y=j)
    held = liegen.compile(prior, backend=backend).indexed(x=[2])
    system = NormalEquations([edges, held])
    edge = {"x": x, "y": x, "z": z, "sqrt_info": S}
    terms = system(edge, {"x": x, "z": x[3:4]})
    assert terms.H.format == "bsr"
    expected = dense(
        6 * N,
        [
            (
                between.jacobians(x[i], x[j], z=z, sqrt_info=S.reshape(-1, 6, 6)),
                {"x": (6 * i, 6), "y": (6 * j, 6)},
            ),
            (prior.jacobians(x[2:3], z=x[3:4]), {"x": (np.array([12]), 6)}),
        ],
    )
    agrees(terms, expected)
    agrees(system(edge, {"x": x, "z": x[3:4]}), expected)  # nothing is left from before


def test_blocks_of_two_sizes_and_held_ones_make_a_csc_array(backend):
    i, q = RNG.integers(0, N, M), RNG.integers(0, L, M)
    i[: N - 1], q[:L] = np.arange(1, N), np.arange(L)
    x, p, z = poses(N), RNG.normal(size=(L, 3)), RNG.normal(size=(M, 3))
    seen = liegen.compile(sighting, backend=backend).indexed(x=i, p=q)
    system = NormalEquations([seen], [{"x": i - 1, "p": N - 1 + q}])  # pose 0 is held fixed
    terms = system({"x": x, "p": p, "z": z})
    assert terms.H.format == "csc"
    assert terms.H.has_canonical_format
    starts = {"x": (np.where(i > 0, 6 * (i - 1), -1), 6), "p": (6 * (N - 1) + 3 * q, 3)}
    agrees(terms, dense(6 * (N - 1) + 3 * L, [(sighting.jacobians(x[i], p[q], z=z), starts)]))


def test_terms_of_single_factors_and_batches(backend):
    k = liegen.compile(library.between_se2.whitened("diagonal"), backend=backend)
    a = np.array([[1.0, 0, 0, 0], [0, 1, 2, 3]])
    arguments = {"z": a[::-1], "sqrt_info": [1.0, 2.0, 3.0]}
    terms = k.gauss_newton(a, a[1], **arguments)
    J = library.between_se2.whitened("diagonal").jacobians(a, a[1], **arguments)
    np.testing.assert_allclose(terms.H_x_y, np.swapaxes(J["res_D_x"], 1, 2) @ J["res_D_y"], atol=1e-14)
    assert pickle.loads(pickle.dumps(k)).gauss_newton(a, a[1], **arguments).cost.shape == (2, 1)


def test_bad_input(backend):
    edges = liegen.compile(library.between_r3, backend=backend).indexed(x=[0, 1], y=[1, 2])
    points = liegen.compile(library.between_r2, backend=backend).indexed(x=[0], y=[1])
    with pytest.raises(ValueError, match="between_r2: block 0 has 2 dimensions as x, 3 elsewhere"):
        NormalEquations([edges, points])
    with pytest.raises(ValueError, match="block 1 is in no factor"):
        NormalEquations([edges], [{"x": [0, 2], "y": [2, 3]}])
    with pytest.raises(ValueError, match=r"blocks of x: expected shape \(2,\), got \(3,\)"):
        NormalEquations([edges], [{"x": [0, 1, 2]}])
    with pytest.raises(TypeError, match="variable y needs an index, or numbers of its blocks"):
        NormalEquations([liegen.compile(library.between_r3, backend=backend).indexed(x=[0, 1])])
    with pytest.raises(ValueError, match="1 groups of factors need as many arguments, got 2"):
        NormalEquations([edges])({}, {})
    with pytest.raises(TypeError, match="missing y, z"):
        NormalEquations([edges])({"x": np.zeros((3, 3))})


def test_a_function_has_no_terms(backend):
    @function
    def middle(x: SE3):
        return x.inverse()

    k = liegen.compile(middle, backend=backend)
    with pytest.raises(AttributeError, match="middle has no Gauss-Newton terms"):
        _ = k.gauss_newton
    with pytest.raises(DefinitionError):
        _ = middle.gauss_newton_kernel


@needs_compiler
def test_the_documentation_runs(capsys):
    text = (Path(__file__).resolve().parents[2] / "docs" / "gauss_newton.md").read_text(encoding="utf-8")
    names: dict[str, object] = {}
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    for block in blocks:
        exec(block, names)
    said = [
        line.split("# ")[1] for block in blocks for line in block.splitlines() if line.startswith("print")
    ]
    assert capsys.readouterr().out.splitlines() == said
