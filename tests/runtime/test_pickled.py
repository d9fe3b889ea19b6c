"""Compiled factors in pickles."""

from __future__ import annotations

import pickle
import zlib
from dataclasses import replace

import numpy as np
import pytest
from runtime_factors import arguments, between, pixel, rotated
from runtime_tools import R, child, p

import liegen
from compiler_tools import needs_compiler
from liegen import native
from liegen.errors import ToolError
from liegen.runtime import compiled

pytestmark = [needs_compiler, pytest.mark.usefixtures("quick_builds")]


def test_pickles_in_one_process(compilations):
    k = liegen.compile(between)
    before = len(compilations)
    again = pickle.loads(pickle.dumps(k))
    assert again == k
    assert hash(again) == hash(k)
    assert len(compilations) == before
    variables, given = arguments(between, (3,))
    for name in ("jacobians", "status"):
        method = pickle.loads(pickle.dumps(getattr(k, name)))
        for a, b in zip(method(*variables, **given), getattr(k, name)(*variables, **given), strict=True):
            np.testing.assert_array_equal(a, b)
    made = k.jacobians(*variables, **given)
    copy = pickle.loads(pickle.dumps(made))
    assert type(copy) is type(made)
    np.testing.assert_array_equal(copy.res_D_y, made.res_D_y)
    assert k != liegen.compile(between, backend="numpy")
    assert len(pickle.dumps(k)) < 60_000


UNPICKLE = """
import pickle, sys
k, arrays = pickle.load(sys.stdin.buffer)
import numpy as np
print(k.backend, k(*arrays).tolist(), "casadi" in sys.modules)
"""


@pytest.mark.parametrize("place", ["same cache", "empty cache", "no compiler"])
def test_pickles_in_another_process(kept, tmp_path, place):
    k = liegen.compile(rotated)
    environment = {"LIEGEN_CACHE_DIR": str(kept if place == "same cache" else tmp_path)}
    if place == "no compiler":
        environment |= {"PATH": str(tmp_path), "CC": ""}
    process = child(UNPICKLE, **environment)
    out, err = process.communicate(pickle.dumps((k, (R[0], p[0]))), timeout=120)
    assert process.returncode == 0, err
    backend, rest = out.decode().split(" ", 1)
    zig = native.importlib.util.find_spec("ziglang")
    assert backend == ("numpy" if place == "no compiler" and not zig else "c")
    np.testing.assert_allclose(eval(rest.rsplit(" ", 1)[0]), k(R[0], p[0]), rtol=1e-12)


def test_a_pickle_of_another_version():
    k = liegen.compile(pixel)
    function, (name, digest, packed, asked) = k.__reduce__()
    other = replace(k.source, floats=f"{k.source.floats}\n")
    with pytest.raises(ToolError, match="pixel was pickled by another version"):
        function(name, digest, zlib.compress(pickle.dumps(other)), asked)
    with pytest.raises(ToolError, match=r"pixel was pickled by another version of liegen; call liegen\.comp"):
        function(name, digest[::-1], packed, asked)
    with pytest.raises(ToolError, match="pixel was pickled by another version"):
        compiled.restored(name, digest, packed[:-5], asked)
