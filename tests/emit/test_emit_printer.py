"""Programs as text: parentheses, constants, inlining, names; the values are those of the program."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import pytest
from emit_kernels import Code, bearing_range, between_r2, examples, random_kernel
from emit_tools import call_c, library, package, reference, same, samples

from liegen.emit import c_target, numpy_target
from liegen.emit.printer import WIDTH, print_program
from liegen.emit.target import scalar_names
from liegen.kernel import Argument
from liegen.program import Port, Requirement

A, B, C = 0, 1, 2


def text(build: object, syntax: str) -> str:
    """The one result of a program on a, b, c."""
    code = Code((Port("v", (3,)),))
    result = build(code)  # type: ignore[operator]
    program = code.program("f", [("res", (1,), [result])])
    chosen = {"c": c_target.SYNTAX, "numpy": numpy_target.SYNTAX}[syntax]
    listing = print_program(program, chosen, ["a", "b", "c"])
    assert not listing.body
    return listing.stores[0][0].text


@pytest.mark.parametrize(
    ("build", "c", "numpy"),
    [
        (lambda k: k("add", k("add", A, B), C), "a + b + c", "a + b + c"),
        (lambda k: k("add", A, k("add", B, C)), "a + (b + c)", "a + (b + c)"),
        (lambda k: k("sub", A, k("sub", B, C)), "a - (b - c)", "a - (b - c)"),
        (lambda k: k("mul", A, k("mul", B, C)), "a * (b * c)", "a * (b * c)"),
        (lambda k: k("div", k("mul", A, B), C), "a * b / c", "a * b / c"),
        (lambda k: k("mul", A, k("div", B, C)), "a * (b / c)", "a * (b / c)"),
        (lambda k: k("mul", k("add", A, B), C), "(a + b) * c", "(a + b) * c"),
        (lambda k: k("neg", k("mul", A, B)), "-(a * b)", "-(a * b)"),
        (lambda k: k("mul", k("neg", A), B), "-a * b", "-a * b"),
        (lambda k: k("neg", k("neg", A)), "-(-a)", "-(-a)"),
        (lambda k: k("add", A, k("neg", B)), "a + (-b)", "a + (-b)"),
        (lambda k: k("sub", A, k("neg", B)), "a - (-b)", "a - (-b)"),
        (lambda k: k("sub", A, k("mul", k("neg", B), C)), "a - (-b * c)", "a - (-b * c)"),
        (lambda k: k("add", A, k.const(-2.0)), "a - 2.0", "a - 2.0"),
        (lambda k: k("sub", A, k.const(-2.0)), "a + 2.0", "a + 2.0"),
        (lambda k: k("mul", A, k.const(-2.0)), "a * (-2.0)", "a * (-2.0)"),
        (lambda k: k("mul", k.const(1e16), A), "1e+16 * a", "1e+16 * a"),
        (lambda k: k("mul", k.const(0.1), A), "0.1 * a", "0.1 * a"),
        (lambda k: k("add", A, k.const(float("nan"))), "a + NAN", "a + np.nan"),
        (lambda k: k("add", A, k.const(float("-inf"))), "a - INFINITY", "a - np.inf"),
        (lambda k: k("abs", k("atan2", A, B)), "fabs(atan2(a, b))", "np.abs(np.arctan2(a, b))"),
        (lambda k: k("select", k("lt", A, B), A, B), "a < b ? a : b", "np.where(a < b, a, b)"),
        (
            lambda k: k("mul", A, k("select", k("le", A, B), A, k("neg", B))),
            "a * (a <= b ? a : -b)",
            "a * np.where(a <= b, a, -b)",
        ),
        (
            lambda k: k(
                "select", k("or", k("and", k("lt", A, B), k("lt", B, C)), k("not", k("lt", A, C))), A, B
            ),
            "(a < b && b < c) || !(a < c) ? a : b",
            "np.where((a < b) & (b < c) | ~(a < c), a, b)",
        ),
        (
            lambda k: k("select", k("and", k("lt", A, B), k("or", k("lt", B, C), k("lt", A, C))), A, B),
            "a < b && (b < c || a < c) ? a : b",
            "np.where((a < b) & ((b < c) | (a < c)), a, b)",
        ),
        (lambda k: k("add", A, k("div", k.const(1.0), k.const(0.0))), "a + INFINITY", "a + np.inf"),
        (
            lambda k: k("select", k("lt", k.const(1.0), k.const(2.0)), A, B),
            "1 ? a : b",
            "np.where(np.True_, a, b)",
        ),
    ],
)
def test_fewest_parentheses(build: object, c: str, numpy: str) -> None:
    assert text(build, "c") == c
    assert text(build, "numpy") == numpy


def test_values_read_twice_and_long_expressions_get_names_in_order() -> None:
    code = Code((Port("v", (3,)),))
    shared = code("mul", A, B)
    chain = code("add", shared, shared)
    for _ in range(40):
        chain = code("add", code("mul", chain, C), A)
    unused = code("sqrt", A)
    program = code.program("f", [("res", (2,), [chain, shared])])
    listing = print_program(program, c_target.SYNTAX, ["alpha", "beta", "gamma"])
    assert [a.name for a in listing.body] == [f"t{k}" for k in range(len(listing.body))]
    assert listing.body[0].text == "alpha * beta"
    assert 3 <= len(listing.body) < 20
    lines = [*(a.text for a in listing.body), *(s.text for s in listing.stores[0])]
    assert max(map(len, lines)) <= WIDTH
    assert not any("sqrt" in line for line in lines), unused
    assert listing.stores[0][1].text == "t0"


def test_scalars_are_named_by_their_storage_and_avoid_the_users_names() -> None:
    assert scalar_names(bearing_range())[:6] == ("x_c", "x_s", "x_x", "x_y", "p_x", "p_y")
    kernel = between_r2()
    clash = Argument("x_y", "R1", ("x",), 1, False)
    kernel = dataclasses.replace(kernel, arguments=(*kernel.arguments[:2], clash))
    assert scalar_names(kernel) == ("x_x", "x_y_", "y_x", "y_y", "x_y_0")


@pytest.mark.parametrize("seed", range(12))
def test_random_programs_keep_every_bit(seed: int, tmp_path: Path) -> None:
    kernel = random_kernel(seed)
    module = package([kernel], tmp_path, f"random_{seed}")
    shared = library([kernel], tmp_path / "compiled")
    for k in range(4):
        values = samples(kernel, k)
        status, wanted = reference(kernel.jacobians, values)
        assert status == 0
        got = module.anything_jacobians(values["a"], b=values["b"])
        _, compiled = call_c(shared.demo_anything, kernel.jacobians, values)
        for name, array in wanted.items():
            same(getattr(got, name), array)
            same(compiled[name], array)
        _, alone = reference(kernel.value, values)
        same(module.anything(values["a"], b=values["b"]), alone["res"])
        same(call_c(shared.demo_anything_res, kernel.value, values)[1]["res"], alone["res"])


def test_random_programs_use_every_operation() -> None:
    used = {ins.op for seed in range(12) for ins in random_kernel(seed).jacobians.code}
    assert {"select", "and", "or", "not", "lt", "le", "sqrt", "abs", "div", "neg"} <= used


def test_lines_stay_short() -> None:
    for kernel in examples():
        for program in (kernel.value, kernel.jacobians):
            listing = print_program(program, c_target.SYNTAX, scalar_names(kernel))
            assert all(len(a.text) <= WIDTH for a in listing.body)
            assert all(re.fullmatch(r"t\d+", a.name) for a in (*listing.guard, *listing.body))


def test_a_value_read_twice_is_computed_once() -> None:
    code = Code((Port("v", (3,)),))
    root = code("sqrt", A)
    program = code.program("f", [("res", (2,), [code("add", root, B), code("mul", root, C)])])
    listing = print_program(program, c_target.SYNTAX, ["a", "b", "c"])
    assert [(a.name, a.text) for a in listing.body] == [("t0", "sqrt(a)")]
    assert [s.text for s in listing.stores[0]] == ["t0 + b", "t0 * c"]


def test_what_the_requirements_need_comes_first() -> None:
    code = Code((Port("v", (3,)),))
    root = code("sqrt", A)
    result = code("mul", root, root)
    product = code("mul", B, C)
    condition = code("lt", product, code("add", product, A))
    needed = Requirement(condition, "never")
    program = code.program("f", [("res", (2,), [result, product])], needed)
    listing = print_program(program, c_target.SYNTAX, ["a", "b", "c"])
    assert [(a.name, a.text) for a in listing.guard] == [("t0", "b * c")]
    assert listing.conditions == ("t0 < t0 + a",)
    assert [(a.name, a.text) for a in listing.body] == [("t1", "sqrt(a)")]
    assert [s.text for s in listing.stores[0]] == ["t1 * t1", "t0"]
