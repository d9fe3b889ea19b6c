"""Names that some language cannot spell are refused with the factor, the argument, the line and the cure."""

from __future__ import annotations

import dataclasses

import pytest
from emit_kernels import between_r2, examples, wheel_step

from liegen.emit import check_names
from liegen.errors import DefinitionError, Site
from liegen.kernel import Kernel


def renamed(argument: str) -> Kernel:
    kernel = between_r2()
    first = dataclasses.replace(kernel.arguments[0], name=argument)
    return dataclasses.replace(kernel, arguments=(first, *kernel.arguments[1:]))


def called(name: str, line: int = 7) -> Kernel:
    return dataclasses.replace(between_r2(), name=name, site=Site("factors.py", line))


def refusal(kernels: list[Kernel], package: str = "demo") -> str:
    with pytest.raises(DefinitionError) as raised:
        check_names(kernels, package)
    return str(raised.value)


def test_good_names_pass() -> None:
    check_names([*examples(), renamed("T_WB"), called("f"), called("g")][-1:], "demo")
    check_names(examples(), "liegen_factors")
    for name in ("T_WB", "R", "p1", "t_x", "tag", "x_", "omega_dt", "match", "D", "lambda_"):
        check_names([renamed(name)], "demo")


@pytest.mark.parametrize(
    ("name", "reason", "cure"),
    [
        ("lambda", "is a Python keyword", "'lambda_1'"),
        ("class", "is a Python keyword", "'class_1'"),
        ("double", "is a C keyword", "'double_1'"),
        ("template", "is a C++ keyword", "'template_1'"),
        ("θ", "is no C identifier", "'v'"),
        ("_x", "is no C identifier", "'x'"),
        ("a__b", "double underscore", "'a_b'"),
        ("res", "is reserved", "'res_1'"),
        ("out", "is reserved", "'out_1'"),
        ("np", "is reserved", "'np_1'"),
        ("sqrt", "is reserved", "'sqrt_1'"),
        ("status", "is reserved", "'status_1'"),
        ("lanes", "is reserved", "'lanes_1'"),
        ("sqrtf", "is reserved", "'sqrtf_1'"),
        ("evaluate", "is reserved", "'evaluate_1'"),
        ("t0", "is the name of a temporary", "'t0_1'"),
        ("t31", "is the name of a temporary", "'t31_1'"),
        ("res_D_x", "looks like the name of a Jacobian", "'res_x'"),
        ("y", "occurs twice", "'y_1'"),
        ("between_r2", "is also the name of a generated function", "'between_r2_1'"),
    ],
)
def test_arguments(name: str, reason: str, cure: str) -> None:
    message = refusal([renamed(name)])
    assert message.startswith(f"between_r2 (factors.py:7): argument {name!r} ")
    assert reason in message
    assert message.endswith(f"rename it, for example to {cure}")


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("while", "is a Python keyword"),
        ("union", "is a C keyword"),
        ("np", "is reserved"),
        ("res", "is reserved"),
        ("math", "hides one of C's headers"),
        ("support", "hides one of C's headers or of the package's modules"),
        ("2d", "is no C identifier"),
        ("a-b", "is no C identifier"),
    ],
)
def test_factors(name: str, reason: str) -> None:
    message = refusal([called(name)])
    assert message.startswith(f"factor {name!r} (factors.py:7)")
    assert reason in message
    assert "rename it" in message


@pytest.mark.parametrize("name", ["count", "index", "np", "a_D_b", "for", "v"])
def test_outputs(name: str) -> None:
    kernel = wheel_step()
    first = dataclasses.replace(kernel.outputs[0], name=name)
    message = refusal([dataclasses.replace(kernel, outputs=(first, kernel.outputs[1]))])
    assert message.startswith(f"wheel_step (factors.py:7): output {name!r} ")


def test_an_argument_named_like_an_output() -> None:
    kernel = wheel_step()
    first = dataclasses.replace(kernel.arguments[0], name="v")
    message = refusal([dataclasses.replace(kernel, arguments=(first, *kernel.arguments[1:]))])
    assert "argument 'v' is also the name of an output" in message


@pytest.mark.parametrize(
    ("package", "reason"),
    [
        ("my-package", "is no C identifier"),
        ("numpy", "would hide the Python module"),
        ("json", "would hide the Python module"),
        ("string", "hides one of C's own"),
        ("c", "is the name of the folder of the C code"),
        ("import", "is a Python keyword"),
    ],
)
def test_packages(package: str, reason: str) -> None:
    message = refusal([], package)
    assert message.startswith(f"package name {package!r} ")
    assert reason in message


@pytest.mark.parametrize(
    ("first", "second", "reason"),
    [
        ("f", "f", "have one name"),
        ("lever", "Lever", "differ only in case"),
        ("f", "f_jacobians", "would both generate f_jacobians"),
        ("f", "f_res", "would both generate f_res"),
        ("f", "f_cm", "would both generate f_cm"),
        ("f", "f_batch_cm_f32", "would both generate f_batch_cm_f32"),
        ("a_b", "a__b".replace("__", "_") + "_", "would both generate ABJacobians"),
    ],
)
def test_two_factors(first: str, second: str, reason: str) -> None:
    message = refusal([called(first, 3), called(second, 9)])
    assert reason in message
    assert "factors.py:3" in message
    assert "factors.py:9" in message
    assert message.endswith("rename one of them")


def test_a_factor_named_like_the_package() -> None:
    assert "the same file as the package 'demo', c/Demo.h" in refusal([called("Demo")])
    assert "the same file as the package 'demo', c/demo_lanes.h" in refusal([called("demo_lanes")])
