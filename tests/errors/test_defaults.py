"""Defaults of given arguments hold in every way to call a factor, and odd ones are refused by name."""

import inspect
import re

import numpy as np
import pytest

import liegen
from liegen import R1, R2, R3, SE3, DefinitionError, factor, function
from liegen.emit import render
from liegen.emit.importing import load_modules

G = np.array([0.25, -0.5, -9.81])


@factor
def fall(v: R3, w: R3, *, t: R1, g: R3 = R3(*G), k: R1 = R1(0.5)):  # noqa: B008
    return w - k[0] * v - t[0] * g


@factor
def reached(v: R3, *, t: R1):
    return fall(v, v, t=t) + fall(v, v, t=t, g=R3(0, 0, 1))


V, W, T = np.array([1.0, 2, 3]), np.array([4.0, 5, 7]), 2.0
EXPECTED = W - 0.5 * V - T * G


def test_numbers_jacobians_and_gauss_newton():
    np.testing.assert_allclose(np.asarray(fall(V, W, t=T)), EXPECTED)
    np.testing.assert_allclose(np.asarray(fall(V, W, t=T, k=2.0)), EXPECTED - 1.5 * V)
    out = fall.jacobians(V, W, t=T)
    np.testing.assert_allclose(out["res"], EXPECTED)
    np.testing.assert_allclose(out["res_D_v"], -0.5 * np.eye(3))
    np.testing.assert_allclose(fall.gauss_newton(V, W, t=T)["cost"], [EXPECTED @ EXPECTED / 2])


def test_inlined_in_a_formula():
    np.testing.assert_allclose(np.asarray(reached(V, t=T)), V - T * G - [0, 0, T])


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_compiled(backend):
    k = liegen.compile(fall, backend=backend)
    np.testing.assert_allclose(k(V, W, t=[T]), EXPECTED)
    np.testing.assert_allclose(k(np.stack([V] * 3), W, t=[T], k=[0.0]), [W - T * G] * 3)
    np.testing.assert_allclose(k.jacobians(V, W, t=[T]).res, EXPECTED)
    np.testing.assert_allclose(k.indexed(v=[0, 0])(V[None], W, t=[T]), [EXPECTED] * 2)
    defaults = {p.name: p.default for p in inspect.signature(k).parameters.values()}
    assert defaults["g"] == tuple(G)
    assert defaults["t"] is inspect.Parameter.empty
    with pytest.raises(TypeError, match=re.escape("missing t")):
        k(V, W)


@pytest.mark.parametrize("layout", [None, "4x4"])
def test_generated_numpy_and_the_header_of_c(layout):
    pose = SE3.exp([0.1, 0.2, 0.3, 1, 2, 3])

    @function(layout=layout)
    def seen(x: SE3, p: R3, *, mount: SE3 = pose):
        return (x @ mount).transform_to(p)

    files = render([seen.kernel], ("numpy", "c"), package="p", regenerate="liegen")
    texts = {path.removeprefix("p/"): t for path, t in files.items() if path.startswith("p/")}
    made = load_modules({k: t for k, t in texts.items() if k.endswith(".py")}, "p").seen
    x = SE3.exp([0.3, 0, 0, 1, 0, 0])
    stored = np.asarray(x) if layout is None else x.matrix()
    np.testing.assert_allclose(made(stored, V), np.asarray((x @ pose).transform_to(V)), atol=1e-15)
    np.testing.assert_allclose(np.asarray(seen(x, V)), made(stored, V), atol=1e-15)
    c = next(t for path, t in files.items() if path.endswith("/seen.c"))
    first = np.asarray(pose)[0] if layout is None else pose.matrix()[0, 0]
    assert re.search(
        rf"mount: .*given, default \(+{re.escape(repr(float(first)))}", re.sub(r"[\s*]+", " ", c)
    )


def test_a_variable_has_no_default():
    free = fall.vary("g", name="free")
    with pytest.raises(DefinitionError, match=r"free\(v, w, g, t=, \[k=\]\) \(missing g\)"):
        free(V, W, t=T)
    assert fall.bind(g=[0, 0, 0])(V, W, t=T).coords[2] == 5.5

    with pytest.raises(
        DefinitionError, match=r"test_defaults.py.*bad: argument 'y' is a variable.*after the"
    ):

        @factor
        def bad(x: R3, y: R3 = R3(0, 0, 0)):  # noqa: B008
            return x - y


ODD = {
    "array": (np.zeros(3), "ndarray"),
    "list": ([0, 0, 0], "a list"),
    "None": (None, "None"),
    "text": ("a", "text"),
    "class": (R3, "a type"),
    "number for a vector": (1.0, "a float"),
    "another dimension": (R2(1, 2), "the default R2"),
    "another manifold": (SE3.identity(), "the default SE3"),
    "batch": (R3.from_storage(np.zeros((4, 3))), r"batch of shape \(4,\)"),
    "NaN": (R3(np.nan, 0, 0), "not finite"),
}


@pytest.mark.parametrize("name", ODD)
def test_odd_defaults_are_refused_by_name(name):
    default, says = ODD[name]
    with pytest.raises(DefinitionError, match=rf"test_defaults.py:\d+: odd: argument 'z'.*{says}"):

        @factor
        def odd(x: R3, *, z: R3 = default):
            return x - z


def test_traced_values_are_no_defaults():
    with pytest.raises(
        DefinitionError, match="inner: argument 'z': the default is a value of another formula"
    ):

        @factor
        def outer(x: R3):
            @factor
            def inner(y: R3, *, z: R3 = x):
                return y - z

            return inner(x)
