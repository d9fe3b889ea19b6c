"""What users write in declarations: dimensions, requirements, names, bound values; each told by name."""

import re

import numpy as np
import pytest

import liegen
from liegen import R1, R3, SE3, SO2, DefinitionError, Product, R, factor, require, singular
from liegen.emit import render
from liegen.emit.importing import load_modules
from liegen.manifolds.given import LARGEST


def refused(does, *says):
    with pytest.raises(DefinitionError) as error:
        does()
    message = str(error.value)
    assert message.startswith("test_declarations.py:"), message
    assert len(message) < 500
    for words in says:
        assert words in message, message


# --- dimensions -------------------------------------------------------------------------------------------

DIMENSIONS = {
    "fraction": (1.5, "1.5"),
    "whole float": (3.0, "3.0"),
    "text": ("3", "'3'"),
    "bytes": (b"3", "b'3'"),
    "None": (None, "None"),
    "NaN": (np.nan, "nan"),
    "infinite": (np.inf, "inf"),
    "list": ([3], "a list"),
    "tuple": ((3,), "a tuple"),
    "array": (np.array([3]), "a ndarray"),
    "complex": (3j, "complex numbers"),
    "True": (True, "True"),
    "np.True_": (np.True_, "a bool"),
    "a class": (int, "a type"),
    "0": (0, "0"),
    "negative": (-1, "-1"),
    "one too many": (LARGEST + 1, "1001"),
    "a million": (10**6, "1000000"),
    "beyond 64 bits": (10**30, "1000000000000000000000000000000"),
    "long text": ("1" * 10**6, "'1111"),
}


@pytest.mark.parametrize("name", DIMENSIONS)
def test_a_dimension_is_a_whole_number_up_to_a_limit(name):
    given, shown = DIMENSIONS[name]

    def by_class():
        class Mine(R, dim=given):
            pass

    refused(by_class, "Mine: dim is a whole number from 1 to 1000, got ", shown, "Mine(R, dim=12)")
    refused(lambda: R(given), "R: dim is a whole number from 1 to 1000, got ", shown, "write R(12)")


def test_the_largest_dimension_and_numbers_of_numpy():
    assert R(np.int64(12)) is R(12)
    assert R(LARGEST).form.dim == LARGEST


def test_classes_take_nothing_else():
    def two():
        class Mine(R, dim=3, size=3):
            pass

    def product():
        class Mine(Product, dim=3):
            a: R3

    def default():
        class Mine(Product):
            a: R3 = R3(0, 0, 0)

    def large():
        class Mine(Product):
            a: R(900)
            b: R(101)

    refused(two, "Mine: only dim= is known; write class Mine(R, dim=12)")
    refused(product, "Mine: a product takes no dim=", "pose: SE3")
    refused(default, "Mine: part 'a' has a default", "write a: R3 alone")
    refused(large, "Mine stores 1001 numbers, the limit is 1000")


# --- requirements -----------------------------------------------------------------------------------------

STATED = {
    "a number": (lambda x: require(x[0] > 0, 3), "require needs a text second, got a int"),
    "None": (lambda x: require(x[0] > 0, None), "require needs a text second, got a NoneType"),
    "a list": (lambda x: require(x[0] > 0, ["a"]), "require needs a text second, got a list"),
    "bytes": (lambda x: require(x[0] > 0, b"a"), "require needs a text second, got a bytes"),
    "swapped": (lambda x: require("positive", x[0] > 0), "require needs a condition first, got text"),
    "no condition": (lambda x: require(x[0], "positive"), "require needs a condition first, got x[0] (R1)"),
    "1": (lambda x: require(1, "positive"), "require needs a condition first, got a int"),
    "no condition, None": (lambda x: require(None, "positive"), "needs a condition first, got None"),
    "singular, a number": (lambda x: singular(3), "singular needs a text first, got a int"),
}


@pytest.mark.parametrize("name", STATED)
def test_a_statement_has_a_condition_and_a_text(name):
    state, says = STATED[name]

    def define():
        @factor
        def pull(x: R3, *, z: R3):
            state(x)
            return x - z

    refused(define, ": pull: ", says)


def test_conditions_on_constants():
    @factor
    def pull(x: R3, *, z: R3):
        require(True, "always")
        require(np.bool_(True), "always")
        return x - z

    assert pull.graph.domain == ()


# --- names, documentation, bound values, calls ------------------------------------------------------------


@factor
def pull(x: R3, *, z: R3, k: R1):
    return k[0] * x - z


CHANGED = {
    "name=5": (lambda: pull.vary("z", name=5), "pull: name= is a text, got 5"),
    "name=None": (lambda: pull.vary("z", name=None), "pull: name= is a text, got None"),
    "a name with a space": (lambda: pull.vary("z", name="a b"), "pull: name= is a name in Python", "'a b'"),
    "a keyword": (lambda: pull.vary("z", name="class"), "pull: name= is a name in Python", "'class'"),
    "doc=5": (lambda: pull.vary("z", doc=5), "pull: doc= is a text, got 5"),
    "bind doc": (lambda: pull.bind(k=1.0, doc=5), "pull: doc= is a text, got 5"),
    "sample=3": (lambda: pull.fix(sample=3), "pull: sample= is a function (draw, case)", "got 3"),
    "vary of nothing known": (
        lambda: pull.vary("nosuch"),
        "no free argument 'nosuch'; it has x, z, k",
    ),
    "vary of a number": (lambda: pull.vary(5), "pull has no free argument 5"),
    "vary of a list": (lambda: pull.vary(["z"]), "pull has no free argument ['z']"),
    "fix of nothing known": (lambda: pull.fix("nosuch"), "pull has no free argument 'nosuch'"),
    "fix of all": (lambda: pull.fix("x"), "pull: no variable is left"),
    "bind of nothing known": (lambda: pull.bind(nosuch=3), "pull has no free argument 'nosuch'"),
    "noise of a number": (lambda: pull.whitened(5), "pull: unknown noise 5; choose from full"),
    "loss of a list": (lambda: pull.whitened(loss=[]), "pull: unknown loss []; choose from huber"),
}


@pytest.mark.parametrize("name", CHANGED)
def test_what_changes_a_factor_names_it(name):
    does, *says = CHANGED[name]
    refused(does, *says)


ODD = {
    "None": (None, "got None"),
    "text": ("abc", "got text"),
    "texts of numbers": (["1", "2", "3"], "got text"),
    "dict": ({}, "got a dict"),
    "set": ({1, 2, 3}, "got a set"),
    "complex": ([1j, 0, 0], "got complex numbers"),
    "ragged": ([[1.0], [1.0, 2.0]], "rows differ in length"),
    "another shape": (np.zeros(4), "this one has shape (4,)"),
    "a number": (1.0, "this one has shape ()"),
    "nothing": ([], "this one has shape (0,)"),
    "a function": (print, "got a builtin_function_or_method"),
    "objects": (np.array([None, 1, 2]), "holds None"),
    "dates": (np.array(["2020-01-01"] * 3, dtype="M8[D]"), "got dates"),
    "masked": (np.ma.masked_array([1.0, 2, 3], mask=[1, 0, 0]), "masked entries"),
    "too large": ([10**400, 0, 0], "too large for a double"),
    "another manifold": (SE3.identity(), "must be R3, got SE3"),
}


@pytest.mark.parametrize("name", ODD)
def test_odd_values_name_factor_and_argument(name, recwarn):
    given, says = ODD[name]
    x = np.zeros(3)
    refused(lambda: pull.bind(z=given), "pull: argument 'z'", says)
    for call in (pull, pull.jacobians, pull.gauss_newton):
        refused(lambda call=call: call(x, z=given, k=1.0), "pull: argument 'z'", says)
        refused(lambda call=call: call(given, z=x, k=1.0), "pull: argument 'x'", says)
    assert not recwarn.list


def test_bound_values_are_single_and_finite():
    refused(lambda: pull.bind(z=np.zeros((5, 3))), "pull: argument 'z' is a batch of shape (5,); give one R3")
    refused(lambda: pull.bind(z=[np.nan, 0, 0]), "pull: argument 'z' is not finite")
    refused(lambda: pull.bind(k=np.inf), "pull: argument 'k' is not finite")


def test_batches_of_no_element():
    assert np.asarray(pull(np.zeros((0, 3)), z=np.zeros(3), k=1.0)).shape == (0, 3)
    refused(lambda: pull(np.zeros((5, 3)), z=np.zeros((0, 3)), k=1.0), "do not broadcast: x (5,), z (0,)")


# --- numbers for R1 ---------------------------------------------------------------------------------------

X, Z = np.array([1.0, 2, 3]), np.array([4.0, 5, 7])


@pytest.mark.parametrize("k", [0.5, np.float64(0.5), np.float32(0.5), np.array(0.5), [0.5], R1(0.5)])
def test_a_number_stands_for_a_vector_of_one(k):
    expected = 0.5 * X - Z
    np.testing.assert_allclose(np.asarray(pull(X, z=Z, k=k)), expected)
    np.testing.assert_allclose(pull.jacobians(X, z=Z, k=k)["res"], expected)
    np.testing.assert_allclose(pull.gauss_newton(X, z=Z, k=k)["cost"], [expected @ expected / 2])
    np.testing.assert_allclose(np.asarray(pull.bind(k=k)(X, z=Z)), expected)
    np.testing.assert_allclose(np.asarray(pull.vary("k")(X, k, z=Z)), expected)
    np.testing.assert_allclose(
        np.asarray(pull.whitened("isotropic")(X, z=Z, k=k, sqrt_info=k)), 0.5 * expected
    )


@pytest.mark.parametrize("k", [0.5, np.float64(0.5), np.array(0.5), 1])
def test_generated_numpy_code_takes_numbers_for_r1(k):
    files = render([pull.whitened("isotropic").kernel], ("numpy",), package="p", regenerate="liegen")
    made = load_modules(
        {n.removeprefix("p/"): t for n, t in files.items() if n.startswith("p/") and n.endswith(".py")}, "p"
    )
    np.testing.assert_allclose(made.pull(X, z=Z, k=k, sqrt_info=2.0), 2 * (float(k) * X - Z))
    out = made.pull_jacobians(np.stack([X] * 4), z=Z, k=k, sqrt_info=2)
    np.testing.assert_allclose(out.res, [2 * (float(k) * X - Z)] * 4)
    with pytest.raises(ValueError, match=re.escape("pull: argument k: expected shape (..., 1), got (5,)")):
        made.pull(X, z=Z, k=np.zeros(5), sqrt_info=2.0)


def test_numbers_as_elements_of_r1():
    assert float(R1(0.5).local(0.25)) == -0.25
    assert float(R1(0.5).between(0.25)) == -0.25
    assert float(R1(0.5).compose(0.25)) == 0.75
    assert float(R1(0.5).retract(0.25)) == 0.75
    assert float(R1.from_storage(0.5)) == 0.5
    np.testing.assert_allclose(np.asarray(SO2.exp(0.5)), [np.cos(0.5), np.sin(0.5)])


def test_a_number_as_default():
    @liegen.factor
    def scaled(x: R3, *, k: R1 = 0.5):
        return k[0] * x

    np.testing.assert_allclose(np.asarray(scaled(X)), 0.5 * X)
    np.testing.assert_allclose(np.asarray(scaled(X, k=2.0)), 2 * X)


def test_a_factor_is_a_plain_function(recwarn):
    def yields():
        @factor
        def pull(x: R3):
            yield x

    def waits():
        @factor
        async def pull(x: R3):
            return x

    for define in (yields, waits):
        refused(define, ": pull: a factor returns its value, without async and yield")
    assert not recwarn.list
