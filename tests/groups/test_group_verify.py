"""The checks of ``liegen verify`` on every function of every group, and that they see mistakes."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
import pytest

from compiler_tools import needs_compiler
from liegen.emit import render
from liegen.modules import every_function
from liegen.samples import CASES
from liegen.verify.backends import PACKAGE, Workspace, workspace
from liegen.verify.compiled import compile_c
from liegen.verify.draws import batch, draw_samples
from liegen.verify.factor import check_factor
from liegen.verify.in_place import in_place

FUNCTIONS = every_function()


@pytest.fixture(scope="module")
def place():
    with workspace([f.kernel for f in FUNCTIONS.values()]) as made:
        yield made


def failures(report):
    return [f"{c.name}: {c.worst:.3g} of {c.bound:.3g} at {c.where}" for c in report.checks if not c.passed]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_check_passes(name, place):
    report = check_factor(FUNCTIONS[name], place, 8, 0, conditioned=False)
    assert not failures(report)
    done = {c.name for c in report.checks}
    assert done >= {"value", "agreement", "domain", "in place", "C"}
    assert (done >= {"Jacobian", "differences", "Taylor"}) == bool(FUNCTIONS[name].kernel.variables)


@pytest.mark.slow
@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_check_passes_at_every_case(name, place):
    assert not failures(check_factor(FUNCTIONS[name], place, len(CASES), 2024, conditioned=False))


@pytest.mark.parametrize("name", ["se3_adjoint", "se3_ad", "se3_Jr", "se3_Jl_inv", "se2_Jr"])
def test_a_matrix_with_two_entries_swapped_fails(name, place):
    function = replace(FUNCTIONS[name])
    program = function.kernel.value
    (entries,) = program.results
    a, b = next((a, b) for a in range(len(entries)) for b in range(a) if entries[a] != entries[b])
    swapped = [{a: entries[b], b: entries[a]}.get(k, i) for k, i in enumerate(entries)]
    wrong = replace(program, results=(tuple(swapped),))
    function.__dict__["kernel"] = replace(function.kernel, value=wrong, jacobians=wrong)
    report = check_factor(function, place, 8, 0, conditioned=False)
    assert "value" in {c.name for c in report.checks if not c.passed}


# one array for an argument and the output


@needs_compiler
def test_retract_in_place(place):
    """retract(x, d, x), with and without Jacobians."""
    shared = ctypes.CDLL(str(place.library))
    x, d = np.array([0, 0, 0.6, 0.8, 1, 2, 3.0]), np.array([0.1, -0.2, 0.3, 1, 2, 3])
    by_x, by_d = np.zeros((6, 6)), np.zeros((6, 6))
    retract = shared[f"{PACKAGE}_se3_retract"]

    def call(*arrays):
        assert retract(*(None if a is None else ctypes.c_void_p(a.ctypes.data) for a in arrays)) == 0

    for wanted in (False, True):
        apart, same = np.zeros(7), x.copy()
        beside = (by_x, by_d) if wanted else (None, None)
        inside = (np.zeros((6, 6)), np.zeros((6, 6))) if wanted else (None, None)
        call(x, d, apart, *beside)
        call(same, d, same, *inside)
        np.testing.assert_array_equal(same, apart)
        assert np.abs(apart - x).max() > 0.1
    np.testing.assert_array_equal(inside, (by_x, by_d))


@needs_compiler
@pytest.mark.parametrize("name", ["so3_compose", "so3_retract", "so3_exp"])
def test_a_function_that_stores_before_it_loads_fails(name, tmp_path):
    kernel = FUNCTIONS[name].kernel
    text = render([kernel], ["c"], package=PACKAGE, regenerate="-")
    start = "{\n    const double"
    source = text[f"c/{name}.c"].replace(start, "{\n    out[0] = 0.5;\n    const double")
    assert source != text[f"c/{name}.c"]
    for folder, content in (("right", text[f"c/{name}.c"]), ("wrong", source)):
        place = tmp_path / folder
        (place / "c").mkdir(parents=True)
        for path, unchanged in text.items():
            (place / path).write_text(content if path == f"c/{name}.c" else unchanged)
        library, compiler = compile_c(place / "c", place)
        arguments = batch(draw_samples(FUNCTIONS[name], 4, 0).inside)
        check = in_place(kernel, Workspace(place, library, compiler), arguments)
        same_size = [a for a in kernel.arguments if a.size == kernel.outputs[0].size]
        assert check.passed == (folder == "right" or not same_size)


@needs_compiler
def test_column_major_matrices(tmp_path):
    kernel = FUNCTIONS["se3_Jl"].kernel
    for path, text in render([kernel], ["c"], package="lie", regenerate="-", layout="col").items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(text)
    library, _ = compile_c(tmp_path / "c", tmp_path)
    d, rows, columns = np.array([0.1, -0.2, 0.3, 1, 2, 3]), np.zeros((6, 6)), np.zeros((6, 6))
    for name, out in (("lie_se3_Jl", rows), ("lie_se3_Jl_cm", columns)):
        ctypes.CDLL(str(library))[name](*(ctypes.c_void_p(a.ctypes.data) for a in (d, out)))
    np.testing.assert_array_equal(rows, columns.T)
    np.testing.assert_array_equal(rows, np.asarray(FUNCTIONS["se3_Jl"](d)))
    assert np.abs(rows - rows.T).max() > 0.1


def test_headers_say_what_may_overlap_and_promise_no_restrict():
    text = render([FUNCTIONS["se3_retract"].kernel], ["c"], package="lie", regenerate="-")
    header = text["c/se3_retract.h"]
    assert "An output may be the array of an argument" in header
    assert "RESTRICT" not in header + text["c/se3_retract.c"]
