"""Presets against the libraries themselves; skipped, with the reason, where a library is missing."""

import importlib.metadata

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from liegen.charts import PRESETS, form_chart
from liegen.manifolds import SE2, SE3, SO3


def library(name):
    return pytest.importorskip(name, reason=f"the Python package {name} is not installed")


def drawn(G, seed):
    g = np.random.default_rng(seed)
    q = g.normal(size=4 if G is not SE2 else 2)
    x = np.array([*(q / np.linalg.norm(q)), *g.normal(size=G.form.size - len(q))])
    return x, g.uniform(-0.6, 0.6, G.form.dim)


def matrix(G, x):
    return np.array(G.form.matrix(x), float)


def chart_of(G, name):
    return form_chart(G.form, PRESETS[name]) or G.form


def check(G, name, retract, local, atol=1e-12):
    """``retract(X, d)`` and ``local(X, Y)`` of the library, on matrices."""
    for seed in range(20):
        x, d = drawn(G, seed)
        y = np.array(chart_of(G, name).retract(x, d), float)
        X, Y = matrix(G, x), matrix(G, y)
        np.testing.assert_allclose(retract(X, d), Y, atol=atol)
        z, _ = drawn(G, seed + 100)
        found = np.array(chart_of(G, name).local(x, z), float)
        np.testing.assert_allclose(local(X, matrix(G, z)), found, atol=atol)


@pytest.mark.parametrize("G", [SO3, SE2, SE3], ids=lambda G: G.__name__)
def test_gtsam(G):
    gtsam = library("gtsam")
    version = importlib.metadata.version("gtsam")
    name = "gtsam-4.2" if version.startswith("4.2") else "gtsam"

    def element(X):
        if G is SO3:
            return gtsam.Rot3(X)
        return gtsam.Pose3(X) if G is SE3 else gtsam.Pose2(X[0, 2], X[1, 2], np.arctan2(X[1, 0], X[0, 0]))

    check(
        G,
        name,
        lambda X, d: element(X).retract(d).matrix(),
        lambda X, Y: element(X).localCoordinates(element(Y)),
        atol=1e-8,  # GTSAM's own logarithm near half a turn
    )


@pytest.mark.parametrize("G", [SO3, SE2, SE3], ids=lambda G: G.__name__)
def test_symforce(G):
    sym = library("sym")

    def element(X):
        if G is SE2:
            return sym.Pose2.from_storage([X[0, 0], X[1, 0], X[0, 2], X[1, 2]])
        q = Rotation.from_matrix(X[:3, :3]).as_quat()
        return sym.Rot3.from_storage([*q]) if G is SO3 else sym.Pose3.from_storage([*q, *X[:3, 3]])

    def back(e):
        return matrix(G, np.array(e.to_storage()))

    check(
        G,
        "symforce",
        lambda X, d: back(element(X).retract(d, 1e-15)),
        lambda X, Y: np.ravel(element(X).local_coordinates(element(Y), 1e-15)),
        atol=1e-7,  # its logarithm is that of a clamped arc cosine
    )


@pytest.mark.parametrize("G", [SO3, SE2, SE3], ids=lambda G: G.__name__)
def test_sophus(G):
    if np.__version__ >= "2":
        pytest.skip("sophuspy 1.2 crashes with NumPy 2")
    sophus = library("sophuspy")
    C = {SO3: sophus.SO3, SE2: sophus.SE2, SE3: sophus.SE3}[G]
    check(
        G,
        "sophus",
        lambda X, d: (C(X) * C.exp(d)).matrix(),
        lambda X, Y: np.ravel((C(X).inverse() * C(Y)).log()),
        atol=1e-9,
    )


@pytest.mark.parametrize("G", [SO3, SE2, SE3], ids=lambda G: G.__name__)
def test_jaxlie(G):
    """jaxlie has the chart of Sophus: x @ exp(d), translation first."""
    jaxlie, jax = library("jaxlie"), library("jax")
    jax.config.update("jax_enable_x64", True)
    C = {SO3: jaxlie.SO3, SE2: jaxlie.SE2, SE3: jaxlie.SE3}[G]
    check(
        G,
        "sophus",
        lambda X, d: np.array(jaxlie.manifold.rplus(C.from_matrix(X), d).as_matrix()),
        lambda X, Y: np.array(jaxlie.manifold.rminus(C.from_matrix(X), C.from_matrix(Y))),
        atol=1e-7,
    )
