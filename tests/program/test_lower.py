"""The lowering against CasADi's own evaluation of the same expressions."""

import casadi as ca
import numpy as np
import pytest

from liegen.errors import DefinitionError
from liegen.program import Port
from liegen.program.lower import lower
from liegen.program.program import CONDITIONS

NAMES = ("x", "y", "z", "w")
X = [ca.SX.sym(n) for n in NAMES]
x, y, z, w = X
PORT = Port("p", (4,))


def d(expression, symbol=x):
    return ca.jacobian(expression, symbol)


def sigmoid_like(u):
    return ca.if_else(u < 0, ca.exp(u), ca.if_else(u > 1, ca.sin(u), u * u))


EXPRESSIONS = {
    "arithmetic": (x + y) * z - x / y + (-w),
    "constants": 3 + 2 * x - x / 4 + 0 * y + 1.5,
    "sq twice inv": x * x + 2 * y + 1 / z,
    "sqrt": ca.sqrt(x * x + 1),
    "trigonometry": ca.sin(x) + ca.cos(y) * ca.tan(z),
    "inverse trigonometry": ca.asin(x / 4) + ca.acos(y / 4) + ca.atan(z),
    "exp log": ca.exp(x) + ca.log(y * y + 1),
    "atan2": ca.atan2(x, y),
    "fabs": ca.fabs(x) - ca.fabs(y * z),
    "fmin": ca.fmin(x, y) + 2 * ca.fmin(y, z),
    "fmax": ca.fmax(x, y) + 2 * ca.fmax(y, 0.25),
    "sign": ca.sign(x) * y,
    "hypot": ca.hypot(x, y),
    "power 2": x**2,
    "power 3": x**3 - y**7,
    "power -2": x**-2 + y**-3,
    "power half": (x * x) ** 0.5 + (y * y) ** 1.5 + (z * z) ** -2.5,
    "power 0": x**0,
    "lt as number": (x < y) + z,
    "le as number": (x <= y) * z,
    "eq": ca.if_else(x == y, z, w) + (x == x),
    "ne": ca.if_else(x != y, z, w) + (x != x),
    "and or not": ca.if_else(ca.logic_and(x < y, ca.logic_or(z < w, ca.logic_not(y < z))), x, w),
    "boolean product": (x < y) * (y < z) + w,
    "boolean sum": (x < y) + (y < z) + (z < w),
    "boolean difference": (x < y) - (y < z),
    "boolean quotient": (x < y) / (1 + (y < z)),
    "boolean times boolean table": ((x < y) + (z < w)) * ((y < z) + 1) * w,
    "boolean compared": ca.if_else((x < y) == (y < z), z, w),
    "boolean in a function": ca.sin(x < y) + ca.atan2(x < y, y < z),
    "condition itself": x < y,
    "negated condition": -(x < y),
    "number as condition": ca.if_else(x, y, z) + ca.if_else(ca.logic_not(x), w, 1),
    "if_else": ca.if_else(x < y, x * y, z),
    "if_else of not": ca.if_else(ca.logic_not(x <= 0), x * y, z),
    "if_else zero arm": ca.if_else(x < y, z, 0) + ca.if_else(x < y, 0, w),
    "if_else constant arms": ca.if_else(x < y, 1, -1) * z + ca.if_else(y < z, 0, 1),
    "if_else boolean arms": ca.if_else(x < y, y < z, z < w),
    "if_else boolean arm and number": ca.if_else(x < y, y < z, w),
    "if_else minus": z - ca.if_else(x < y, x, z) - ca.if_else(y < z, w, 0),
    "nested if_else": sigmoid_like(x) + sigmoid_like(y * z),
    "if_else of if_else condition": ca.if_else(ca.if_else(x < y, z, w) < 0.5, x, y),
    "d if_else": d(z * ca.if_else(x < y, ca.sin(x) * y, x * z)),
    "d nested if_else": d(sigmoid_like(x * y)),
    "gradient if_else": ca.gradient(w * ca.if_else(x < y, ca.sin(x) * y, x * z) * x, x),
    "gradient nested": ca.gradient(sigmoid_like(sigmoid_like(x) * y), y),
    "d fmin": d(ca.fmin(x * z, y)),
    "d fmin at a tie": d(ca.fmin(x * z, x * z + 0 * y) * y),
    "d fmax": d(ca.fmax(x * z, y) * w),
    "d fmin of fmax": d(ca.fmin(ca.fmax(x * y, z), w), y),
    "d fabs": d(ca.fabs(x * z) * y),
    "d sign": d(ca.sign(x) * x * y),
    "d atan2": d(ca.atan2(x * y, z - x)),
    "d sqrt": d(ca.sqrt(x * x + y * y)),
    "d power": d((x * x) ** 1.5 + x**5),
    "d tan asin acos atan": d(ca.tan(x) + ca.asin(x / 4) + ca.acos(x / 5) + ca.atan(x)),
    "d hypot": d(ca.hypot(x, y)),
    "hessian if_else": d(d(z * ca.if_else(x < y, ca.sin(x) * y, x * x))),
    "hessian fmin": d(d(ca.fmin(x * x * z, y * x) * x)),
    "long sum": sum((k + 1) * v for k, v in enumerate(X * 3)),
}

SAMPLES = np.vstack(
    [
        np.random.default_rng(7).uniform(-2, 2, (40, 4)),
        [[1.0, 1.0, 1.0, 1.0], [0.5, 0.5, 1.0, -1.0], [1.0, 1.0, 2.0, 2.0], [-1.0, 1.0, -1.0, 1.0]],  # ties
    ]
)


@pytest.mark.parametrize("label", EXPRESSIONS)
def test_same_value_as_casadi(label):
    expression = EXPRESSIONS[label]
    program = lower("f", [(PORT, X)], [(Port("r", (1,)), [expression])])
    expected = np.array(
        ca.Function("f", [ca.vertcat(*X)], [ca.densify(expression)]).map(len(SAMPLES))(SAMPLES.T)
    )
    got = program.evaluate({"p": list(SAMPLES.T)})["r"][0] * np.ones(len(SAMPLES))
    np.testing.assert_allclose(got, expected[0], rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("label", EXPRESSIONS)
def test_conditions_never_reach_arithmetic(label):
    program = lower("f", [(PORT, X)], [(Port("r", (1,)), [EXPRESSIONS[label]])])
    is_condition = [ins.op in CONDITIONS for ins in program.code]
    for ins in program.code:
        operands = [is_condition[a] for a in ins.args]
        if ins.op in ("and", "or", "not"):
            assert all(operands)
        elif ins.op == "select":
            assert operands == [True, False, False]
        else:
            assert not any(operands)
    assert not any(is_condition[i] for i in program.results[0])


def counts(*expressions, requirements=()):
    program = lower("f", [(PORT, X)], [(Port("r", (len(expressions),)), list(expressions))], requirements)
    return program.op_counts()


def test_an_if_else_is_one_select():
    assert counts(ca.if_else(x < y, x, y)) == {"lt": 1, "select": 1}
    assert counts(ca.if_else(x < y, 2.0, 3.0))["select"] == 1


def test_the_derivative_of_fmin_has_no_arithmetic_on_conditions():
    found = counts(d(ca.fmin(x * z, y)))
    assert found["mul"] == 2
    assert not found.keys() & {"add", "sub", "div", "neg"}


def test_arms_brought_together_by_differentiation_are_one_select():
    found = counts(ca.gradient(ca.if_else(x < y, x * z, x * w), x))
    assert found.get("add", 0) == 0


def test_a_select_guards_a_value_that_is_nan():
    """CasADi itself multiplies the NaN of the arm not taken by zero."""
    slope = d(ca.if_else(x < 1, x, ca.sqrt(x - 1)))
    program = lower("f", [(PORT, X)], [(Port("r", (1,)), [slope])])
    assert program.evaluate({"p": [0.5, 0.0, 0.0, 0.0]})["r"][0] == 1.0
    assert program.evaluate({"p": [5.0, 0.0, 0.0, 0.0]})["r"][0] == pytest.approx(0.25, rel=1e-15)


def test_ports_are_flat_row_major_and_may_hold_numbers():
    program = lower(
        "f",
        [(Port("a", (2,)), [x, y]), (Port("b", (2,)), [z, w])],
        [(Port("r", (2, 2)), [0, x - w, -1.0, 1]), (Port("s", (1,)), [y * z])],
    )
    out = program.evaluate({"a": [3.0, 5.0], "b": [7.0, 11.0]})
    assert out["r"] == [0.0, -8.0, -1.0, 1.0]
    assert out["s"] == [35.0]
    assert program.outputs[0].shape == (2, 2)


def test_only_numbers_and_structural_zeros():
    program = lower("f", [], [(Port("r", (3,)), [2, ca.SX(1, 1), ca.SX(5)])])
    assert program.evaluate({})["r"] == [2.0, 0.0, 5.0]


def test_requirements_carry_their_message_and_give_nan():
    program = lower(
        "f",
        [(PORT, X)],
        [(Port("r", (1,)), [x])],
        [(z > 0, "point behind the camera"), (ca.logic_and(x < y, x != w), "order"), (ca.SX(1), "always")],
    )
    assert [r.message for r in program.requirements] == ["point behind the camera", "order", "always"]
    good = program.evaluate({"p": [1.0, 2.0, 1.0, 0.0]})
    assert good["r"] == [1.0]
    assert [bool(s) for s in good["status"]] == [True, True, True]
    bad = program.evaluate({"p": [1.0, 2.0, -1.0, 1.0]})
    assert np.isnan(bad["r"][0])
    assert [bool(s) for s in bad["status"]] == [False, False, True]


@pytest.mark.parametrize(
    ("expression", "named"),
    [
        (ca.erf(x), "'erf'"),
        (ca.floor(x), "'floor'"),
        (ca.sinh(x), "'sinh'"),
        (ca.fmod(x, y), "'fmod'"),
        (ca.copysign(x, y), "'copysign'"),
        (x**y, r"x\*\*y"),
        (x**0.3, r"x\*\*y"),
    ],
)
def test_an_operation_without_counterpart_is_named(expression, named):
    with pytest.raises(DefinitionError, match=f"bearing: .*{named}.*cannot be generated"):
        lower("bearing", [(PORT, X)], [(Port("r", (1,)), [expression])])


def test_a_symbol_that_is_no_input_is_named():
    stray = ca.SX.sym("stray")
    with pytest.raises(DefinitionError, match=r"bearing: .* depends on stray"):
        lower("bearing", [(PORT, X)], [(Port("r", (1,)), [x * stray])])


def test_a_port_of_the_wrong_size_is_named():
    with pytest.raises(DefinitionError, match=r"bearing: r has 1 entries; its shape \(2,\) needs 2"):
        lower("bearing", [(PORT, X)], [(Port("r", (2,)), [x])])
