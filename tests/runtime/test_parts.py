"""What is called first is compiled first, and the rest when it is asked for."""

from __future__ import annotations

import os

import numpy as np
import pytest
from runtime_factors import rotated
from runtime_tools import R, close, p, script, works

import liegen
from compiler_tools import needs_compiler
from liegen import native
from liegen.errors import ToolError
from liegen.library import between_se2, prior_se2
from liegen.runtime import NormalEquations, build
from liegen.runtime.source import JACOBIANS, SINGLES, VALUE, emitted

pytestmark = [needs_compiler, pytest.mark.usefixtures("quick_builds", "folder")]


@pytest.fixture
def parts(monkeypatch):
    """What was compiled, in its order, as a terminal is told."""
    made = []

    def counted(sources, library, flags, *, what):
        made.append(what.removeprefix("compiling "))
        native.compile_shared(sources, library, flags, what=what)

    monkeypatch.setattr(build, "compile_shared", counted)
    return made


def test_one_part_after_the_other(parts):
    k = liegen.compile(rotated)
    assert parts == ["rotated (value)"]
    works(k)
    k.status(R, p)
    assert len(parts) == 1
    k.jacobians(R, p)
    assert parts[1:] == ["rotated (jacobians)"]
    k.jacobians(R, p)
    assert len(parts) == 2
    k(np.float32(R), np.float32(p))
    assert parts[2:] == ["rotated (single precision)"]
    works(k).jacobians(np.float32(R), np.float32(p))
    assert len(parts) == 3


def test_one_double_makes_it_double(parts):
    k = liegen.compile(rotated)
    small, double = (np.float32(R), np.float32(p)), (R, p)
    calls = [(small[0], p), (R, small[1]), (R.tolist(), p.tolist()), (R, np.int64(p)), (small[0], p.tolist())]
    results = [k(*given) for given in calls]
    assert parts == ["rotated (value)"]
    for given, result in zip(calls, results, strict=True):
        assert result.dtype == np.float64
        close(result, k.evaluate(*given))
    assert len(parts) == 2
    assert k(*small).dtype == np.float32
    close(k(*double), k.evaluate(*double))


def test_types_that_single_precision_holds(parts):
    k = liegen.compile(rotated)
    for small in (np.float32, np.float16, np.int8, np.uint16):
        result = k(np.float32(R), np.arange(3).astype(small))
        assert result.dtype == np.float32
        np.testing.assert_allclose(result, k(R, np.arange(3.0)), rtol=1e-5, atol=1e-5)
    assert parts[1:] == ["rotated (single precision)"]


def test_evaluate_is_the_ufunc_of_all_types(parts):
    k = liegen.compile(rotated)
    assert isinstance(k.evaluate, np.ufunc)
    assert [t.replace("->", "") for t in k.evaluate.types] == ["fff", "ddd"]
    assert k.evaluate is k.evaluate
    assert parts[1:] == ["rotated (single precision)"]
    assert [t[0] for t in k.jacobians.evaluate.types] == ["f", "d"]


def test_index_arrays_are_compiled_for_when_they_are_used(parts):
    i, j = np.array([0, 1]), np.array([1, 2])
    k = liegen.compile(between_se2)
    edges = k.indexed(x=i, y=j)
    equations = NormalEquations([edges])
    assert parts == ["between_se2 (value)", "between_se2_gauss_newton (value)"]
    poses, z = np.tile([1.0, 0, 0, 0], (3, 1)), np.tile([1.0, 0, 1, 0], (2, 1))
    equations({"x": poses, "y": poses, "z": z})
    assert len(parts) == 2
    edges(poses, poses, z=z)
    assert parts[2:] == ["between_se2 (jacobians)"]
    edges.jacobians(poses, poses, z=z)
    edges(np.float32(poses), np.float32(poses), z=np.float32(z))
    assert parts[3:] == ["between_se2 (single precision)"]


def test_without_variables_there_are_two_parts():
    assert list(emitted(prior_se2.kernel).c) == [VALUE, JACOBIANS, SINGLES]
    assert list(emitted(prior_se2.gauss_newton_kernel, summed=True).c) == [VALUE, SINGLES]


@pytest.mark.skipif(os.name != "posix", reason="a shell script")
def test_a_compiler_that_fails_later(tmp_path, monkeypatch):
    """What the first part did not meet is told where it is met, and tried again at the next call."""
    real, broken = " ".join(native.find_compiler()), tmp_path / "broken"
    monkeypatch.setenv("CC", script(tmp_path / "mycc", f'[ -e {broken} ] && exit 3; exec {real} "$@"'))
    k = works(liegen.compile(rotated))
    broken.touch()
    with pytest.raises(ToolError, match=r"rotated: .*mycc does not compile the C: exit code 3"):
        k.jacobians(R, p)
    works(k)
    broken.unlink()
    assert k.jacobians(R, p)[0].shape == p.shape


def test_the_value_alone_is_the_value_of_the_whole():
    k = liegen.compile(rotated)
    np.testing.assert_array_equal(k(R, p), k.jacobians(R, p)[0])
