"""Every name that is not refused is taken by C, C++ and Python; every name that is refused has a reason."""

from __future__ import annotations

import builtins
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from emit_kernels import Code, kernel

from compiler_tools import needs_compiler
from liegen import R2, R3, DefinitionError, factor, function, outputs
from liegen.emit import check_names, render
from liegen.emit.templates import template_folder
from liegen.kernel import Argument, Kernel, Output
from liegen.names import KEYWORDS, OWN_C, OWN_NUMPY, complaint, reserved, taken
from liegen.names.collect import C_MODES, CPP, CPP_MODES, C, included, macros
from liegen.program import Port
from liegen.runtime.source import emitted

#: Names that users may well choose, and the functions that gcc declares without a header.
LIKELY = """
    lambda_ x_ D E N K T R p1 alpha beta gamma delta rho index j0 j1 jn y0 y1 yn signal time read write link
    main printf div abs labs exit free malloc scale offset noise weight match type ref loop fn mod use box
    move final override module import_ near far min max id list dict sum len map filter input object print
    name doc sample n k c count held broken violated jacobians stream room value kernel arguments cost_1
    dim3 float3 half warp M_SQRT1 M_PIX
""".split()  # noqa: SIM905


def candidates() -> list[str]:
    """Everything that headers, languages, templates and users call something."""
    found = {*LIKELY, *dir(builtins), *sys.stdlib_module_names, *OWN_C, *OWN_NUMPY}
    found |= set().union(*KEYWORDS.values(), *taken().values())
    for path in template_folder().rglob("*.j2"):
        if path.parts[-2] != "bench":
            found |= set(re.findall(r"\b[A-Za-z_]\w*\b", path.read_text()))
    return sorted(found)


def many(names: list[str], name: str) -> Kernel:
    """A kernel on numbers of these names, the first of which is a variable."""
    arguments = [Argument(n, "R1", ("0",), 1, k == 0) for k, n in enumerate(names)]
    code = Code(tuple(Port(n, (1,)) for n in names))
    total = 0
    for k in range(1, len(names)):
        total = code("add", total, k)
    one = code.const(1.0)
    results = [("res", (1,), (total,)), (f"res_D_{names[0]}", (1, 1), (one,))]
    programs = code.program(name, results[:1]), code.program(name, results)
    return kernel(name, "Many.", arguments, [Output("res", "R1", ("0",), 1)], programs, ["res = sum"])


def test_refusals_have_reasons() -> None:
    names = candidates()
    refused = {name: complaint(name) or reserved(name) for name in names}
    assert len(names) > 2500
    for name in ("M_E", "DBL_MAX", "HUGE_VAL", "FP_NAN", "RAND_MAX", "I", "LANES_FAR", "LANES_SIGN", "errno"):
        assert refused.get(name) or reserved(name)
    for name in LIKELY:
        assert not refused[name], f"{name} {refused[name]}"
    for name in {n for title in ("macros of C", "macros of C++") for n in taken()[title]}:
        assert refused[name]


@needs_compiler
def test_the_list_is_what_the_compiler_says() -> None:
    """Two modes and all headers here; the file holds more."""
    assert macros(included(C, ".h"), "gcc", C_MODES[:1]) <= {*taken()["macros of C"], *OWN_C}
    both = taken()["macros of C"] | taken()["macros of C++"]
    assert macros(["".join(included(CPP, ""))], "g++", CPP_MODES[:1]) <= both


def run(command: list[str], folder: Path) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:4000]


@needs_compiler
def test_every_other_name_compiles(tmp_path: Path) -> None:
    """As C in the compiler's default mode, behind all its headers; the header as C++; NumPy is called."""
    free = [n for n in candidates() if not complaint(n) and not reserved(n) and "_D_" not in n]
    assert len(free) > 1500
    chunks = [free[k : k + 170] for k in range(0, len(free), 170)]
    kernels = [many(names, f"many{k}") for k, names in enumerate(chunks)]
    files = render(kernels, ("c", "numpy"), package="demo", regenerate="liegen", scalar="float", layout="col")
    for path, text in files.items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(text)
    every = "".join(f"#if __has_include(<{h}.h>)\n#include <{h}.h>\n#endif\n" for h in C.split())
    units = [f"many{k}{suffix}.c" for k in range(len(kernels)) for suffix in ("", "_batch")]
    (tmp_path / "c" / "every.h").write_text(every)
    run(["cc", "-fsyntax-only", "-include", "every.h", *units], tmp_path / "c")
    run(["cc", "-fsyntax-only", *units[:2]], tmp_path / "c")
    every = every.replace("#include <tgmath.h>", "").replace("#include <complex.h>", "")
    every = every.replace("#include <stdatomic.h>", "").replace("#include <stdnoreturn.h>", "")
    (tmp_path / "c" / "header.cc").write_text(f'{every}#include <vector>\n#include "demo.h"\n')
    run(["cc", "-x", "c++", "-fsyntax-only", "-Wall", "-Werror", "header.cc"], tmp_path / "c")
    script = "import demo\n" + "".join(
        f"assert demo.{k.name}_jacobians([1.0], **{ ({a.name: [2.0] for a in k.given})!r})"
        f".res[0] == {2 * len(k.given) + 1}\n"
        for k in kernels
    )
    run([sys.executable, "-c", script], tmp_path)


@needs_compiler
def test_names_in_compiled_kernels(tmp_path: Path) -> None:
    """The loops that NumPy calls, and statements on floats."""
    free = [n for n in LIKELY if not complaint(n) and not reserved(n)][:60]
    source = emitted(many(free, "many"))
    for part, files in source.c.items():
        folder = tmp_path / part
        folder.mkdir()
        for path, text in files.items():
            (folder / path).write_text(text)
        run(["cc", "-fsyntax-only", *[p for p in files if p.endswith(".c")]], folder)
    for text in (source.floats, source.conditions):
        space: dict[str, object] = {}
        exec(text, space)


def test_variables_of_any_accepted_name_have_gauss_newton_terms() -> None:
    def damped(x: R2, lambda_: R2, *, x_: R2):
        return x * lambda_ - x_

    f: Any = factor(damped)
    terms = f.gauss_newton([1.0, 2], [3.0, 4], x_=[1.0, 1])
    assert sorted(terms) == ["H_lambda_lambda_", "H_x_lambda_", "H_x_x", "cost", "g_lambda_", "g_x"]
    check_names([f.kernel, f.gauss_newton_kernel], "demo")


def refusal(*arguments: str) -> str:
    signature = ", ".join(f"{a}: R3" for a in arguments)
    space: dict[str, Any] = {"R3": R3}
    exec(f"def pull({signature}):\n    return {' + '.join(arguments)}\n", space)
    with pytest.raises(DefinitionError) as error:
        factor(space["pull"])
    return str(error.value)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("M_E",), "argument 'M_E' is one of the macros of C's headers, so it is reserved"),
        (("LANES_FAR",), "argument 'LANES_FAR' is reserved for the generated code"),
        (("_x",), "argument '_x' is no C identifier"),
        (("x__y",), "argument 'x__y' holds a double underscore"),
        (("é",), "argument 'é' is no C identifier"),
        (("status",), "argument 'status' is reserved"),
        (("threadIdx",), "argument 'threadIdx' is a CUDA keyword"),
        (("crate",), "argument 'crate' is a Rust keyword"),
        (("a" * 300,), "is longer than 100 characters"),
        (("sqrt_info",), "argument 'sqrt_info' is also what noise or loss adds"),
        (("cost",), "argument 'cost' is also the name of the cost of Gauss-Newton terms"),
        (("x", "g_x"), "argument 'g_x' is also the name of a block of Gauss-Newton terms"),
        (("x", "y", "H_x_y"), "argument 'H_x_y' is also the name of a block"),
        (("x", "res_D_x"), "argument 'res_D_x' looks like the name of a Jacobian"),
        (("x_", "x"), "two blocks of Gauss-Newton terms would be called 'H_x_x'"),
        (("x", "x_y", "x_x", "y"), "two blocks of Gauss-Newton terms would be called 'H_x_x_y'"),
    ],
)
def test_refused_at_definition(arguments: tuple[str, ...], says: str) -> None:
    assert says in refusal(*arguments)


@pytest.mark.parametrize(
    ("name", "says"),
    [("M_E", "is one of the macros"), ("count", "is a method"), ("x", "occurs|is also the name")],
)
def test_outputs_are_refused_where_code_is_made(name: str, says: str) -> None:
    space: dict[str, Any] = {"R3": R3, "outputs": outputs}
    exec(f"def pull(x: R3):\n    return outputs({name}=x)\n", space)
    with pytest.raises(DefinitionError, match=says):
        check_names([function(space["pull"]).kernel], "demo")


@pytest.mark.parametrize("loss", ["huber", "cauchy", "barron"])
def test_parameters_of_a_loss_give_way(loss: str) -> None:
    def pull(x: R2, *, k: R2, c: R2, alpha: R2):
        return x * k - c - alpha

    robust = factor(pull).whitened(loss=loss)
    own = robust.plain.parameters
    added = [p.name for p in robust.graph.parameters[len(own) :]]
    assert added == {"huber": ["loss_k"], "cauchy": ["loss_c"], "barron": ["loss_alpha", "loss_c"]}[loss]

    def plain(x: R2, *, a: R2, b: R2, d: R2):
        return x * a - b - d

    given = {"x": [1.0, 2], "a": [3.0, 4], "b": [0.5, 0.5], "d": [1.0, 1]}
    values = [1.5] * len(added)
    usual = factor(plain).whitened(loss=loss)
    names = [p.name for p in usual.graph.parameters[4:]]
    expected = usual.jacobians(
        given.pop("x"), **given, **dict(zip(names, [[v] for v in values], strict=True))
    )
    found = robust.jacobians(
        [1.0, 2], k=given["a"], c=given["b"], alpha=given["d"],
        **dict(zip(added, [[v] for v in values], strict=True)),
    )  # fmt: skip
    assert (found["res_D_x"] == expected["res_D_x"]).all()
    check_names([robust.kernel, robust.gauss_newton_kernel], "demo")


@pytest.mark.parametrize(
    ("package", "name", "says"),
    [
        ("pthread", "create", "would make pthread_create in C, which is a name of C's library"),
        ("clock", "gettime", "would make clock_gettime in C"),
        ("M", "PI", "would make M_PI in C"),
        ("demo", "load", "would make demo_load in C, which is a name of the package itself"),
        ("demo", "batch", "which is a name of the package itself"),
        ("demo", "ahead", "which is a name of the package itself"),
        ("demo", "between", ""),
        ("x" * 300, "between", "is longer than 100 characters"),
        ("a__b", "between", "double underscore"),
        ("M_E", "between", ""),
        ("encoding", "main", ""),
    ],
)
def test_symbols(package: str, name: str, says: str) -> None:
    made = many(["a", "b"], name)
    if says:
        with pytest.raises(DefinitionError) as error:
            check_names([made], package)
        assert says in str(error.value)
    else:
        check_names([made], package)


def test_an_argument_named_like_a_function_of_the_package() -> None:
    with pytest.raises(DefinitionError, match=r"'p_W' is also a name in the C of the package 'p'"):
        check_names([many(["p_W", "b"], "W")], "p")
