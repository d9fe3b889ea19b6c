"""Inner indices cancel: chains of any length, and the identities of the documents."""

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from liegen import (
    R2,
    R3,
    SE3,
    Cal3_S2,
    factor,
    function,
    require,
)
from liegen.errors import DefinitionError

CHAIN = st.lists(st.sampled_from("ABCDE"), min_size=3, max_size=6)


@settings(max_examples=40, deadline=None)
@given(CHAIN, st.lists(st.booleans(), min_size=6, max_size=6), st.integers(0, 5))
def test_inner_indices_cancel_along_any_chain(path, turned, wrong):
    steps = list(pairwise(path))
    flipped = {k for k, turn in enumerate(turned[: len(steps)]) if turn}
    names = [f"T{k}_{b}{a}" if k in flipped else f"T{k}_{a}{b}" for k, (a, b) in enumerate(steps)]

    def chained(inverted):
        space = {"SE3": SE3}
        product = " @ ".join(f"{n}.inverse()" if k in inverted else n for k, n in enumerate(names))
        exec(f"def chained({', '.join(f'{n}: SE3' for n in names)}):\n    return {product}", space)
        return function(space["chained"])

    assert chained(flipped).frames.rows == {"out": path[-1]}
    k = wrong % len(steps)
    (a, b), mistaken = steps[k], flipped ^ {k}
    if a == b:
        assert chained(mistaken).frames.rows == {"out": path[-1]}
    else:
        with pytest.raises(DefinitionError, match="frame of"):
            chained(mistaken)


# the documents' identities


def test_inner_indices_cancel():
    """Identity 6: T_AB T_BC = T_AC, T_WB^-1 = T_BW."""

    @factor
    def identity(T_AB: SE3, T_BC: SE3, *, T_AC: SE3):
        return T_AC.local(T_AB @ T_BC)

    assert identity.frames.residual == "C"
    with pytest.raises(DefinitionError, match="the inner frame of T_AB is B, the outer frame of T_CA is C"):

        @factor
        def mistaken(T_AB: SE3, T_CA: SE3, *, T_AC: SE3):
            return T_AC.local(T_AB @ T_CA)

    @factor
    def inverse(T_WB: SE3, *, T_BW: SE3):
        return T_BW.local(T_WB.inverse())

    assert inverse.frames.noise == "W"


def test_projection():
    """Identity 7: pixels = K (T_WC)^-1 p_W."""

    @factor
    def projection(T_WC: SE3, p_W: R3, *, K_IC: Cal3_S2, z_I: R2):
        q = T_WC.inverse() @ p_W
        require(q[2] > 0, "point behind the camera")
        return K_IC.uncalibrate(q[:2] / q[2]) - z_I

    assert projection.frames.noise == "I"
    assert projection.frames.columns == {"T_WC": "C", "p_W": "W"}
    with pytest.raises(DefinitionError, match=r"; write T_CW.transform_from\(p_W\)"):

        @factor
        def mistaken(T_CW: SE3, p_W: R3, *, K: Cal3_S2, z: R2):
            q = T_CW.transform_to(p_W)
            return K.uncalibrate(q[:2] / q[2]) - z
