"""The check of functions in single precision passes, and sees wrong numbers, order and status."""

from __future__ import annotations

import re

import pytest

from compiler_tools import needs_compiler
from liegen import R1, R3, factor, library, norm
from liegen.define import Function
from liegen.emit import render
from liegen.verify import backends
from liegen.verify.backends import Workspace, workspace
from liegen.verify.draws import Sample, draw_samples
from liegen.verify.single import single

FACTORS = (library.between_se3, library.sfm_cal3_bundler, library.bearing_se2_r2)
SAMPLES = 24


def checked(function: Function, place: Workspace):
    drawn = draw_samples(function, SAMPLES, 0)
    return single(function.kernel, place, drawn.inside, drawn.outside)


@needs_compiler
@pytest.mark.parametrize("function", FACTORS, ids=lambda f: f.name)
def test_it_passes(function: Function) -> None:
    with workspace([function.kernel]) as place:
        check = checked(function, place)
    assert check.passed
    assert 1 / 16 < check.worst < 1
    assert check.kept > SAMPLES / 2


def swapped(text: str) -> str:
    """Two entries of a Jacobian, by rows or by columns."""
    other = {"res_D_x[1] =": "res_D_x[2] =", "res_D_x[2] =": "res_D_x[1] ="}
    return re.sub(r"res_D_x\[[12]\] =", lambda found: other[found[0]], text)


def negated(text: str) -> str:
    return re.sub(r"held\[0\] = (.*);", r"held[0] = lanes_not(\1);", text)


#: A factor, the end of the name of a file, what breaks it.
BROKEN = {
    "a polynomial": (FACTORS[2], "_lanes_f32.h", lambda t: t.replace("-0.33333328f", "-0.333f")),
    "two entries": (FACTORS[0], "_batch_f32.c", swapped),
    "a sign in the functions of one factor": (FACTORS[0], "se3.c", lambda t: t.replace("2.0f *", "-2.0f *")),
    "the status": (FACTORS[1], "_batch_f32.c", negated),
}


@needs_compiler
def test_what_no_float_can_hold_is_not_compared() -> None:
    @factor
    def far(x: R3, *, z: R1):
        """Squares of 1e30 overflow in single precision, those of 1e-30 vanish."""
        return norm(x) - z

    def at(size: float) -> Sample:
        return Sample("far", {"x": (size, 0.0, 0.0), "z": (0.0,)})

    with workspace([far.kernel]) as place:
        check = single(far.kernel, place, [at(1e30), at(1e-30), at(1.0)], [])
    assert check.passed
    assert check.kept == 1


@needs_compiler
@pytest.mark.parametrize("what", BROKEN)
def test_it_sees(what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    function, end, change = BROKEN[what]
    broken: list[str] = []

    def rendered(*given, **options) -> dict[str, str]:
        files = render(*given, **options)
        broken.extend(path for path, text in files.items() if path.endswith(end) and change(text) != text)
        return {path: change(text) if path.endswith(end) else text for path, text in files.items()}

    monkeypatch.setattr(backends, "render", rendered)
    with workspace([function.kernel]) as place:
        check = checked(function, place)
    assert len(broken) == 1
    assert not check.passed
    assert check.where.startswith("C batch" if "batch" in end or "lanes" in end else "C, ")
