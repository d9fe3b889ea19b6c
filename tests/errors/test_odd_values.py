"""Odd values in every operation and declaration: liegen's own error, never another library's words."""

import numpy as np
import pytest

import liegen
from liegen import R1, R3, S2, SE3, SO2, SO3, Cal3_S2, Product, R, factor, outputs
from liegen.errors import LiegenError

ODD = {
    "None": None,
    "text": "abc",
    "bytes": b"abc",
    "dict": {},
    "set": {1, 2},
    "complex": 1j,
    "complex list": [1j, 0, 0],
    "ragged": [[1], [1, 2]],
    "shape": np.zeros(13),
    "objects": np.array([None, 1, 2]),
    "function": print,
    "class": R3,
    "object": object(),
    "too large": 10**400,
    "empty": [],
    "NaN": np.nan,
    "True": True,
    "pose": SE3.identity(),
}


class State(Product):
    pose: SE3
    v: R3


def stated(**options):
    @factor(**options)
    def pull(x: SE3, *, z: SE3):
        return z.local(x)

    return pull


X, V = SE3.identity(), R3(1, 2, 3)
OPERATIONS = {
    "R3(o)": R3,
    "R3(o, 1, 2)": lambda o: R3(o, 1, 2),
    "R1(o)": R1,
    "R(o)": R,
    "SO3(o)": SO3,
    "S2(o)": S2,
    "Cal3_S2(o)": Cal3_S2,
    "SE3(R, o)": lambda o: SE3(SO3.identity(), o),
    "SE3.from_storage": SE3.from_storage,
    "R3.from_storage": R3.from_storage,
    "SE3.exp": SE3.exp,
    "SO2.exp": SO2.exp,
    "S2.direction": S2.direction,
    "compose": X.compose,
    "x @ o": lambda o: X @ o,
    "o @ v": lambda o: o @ V,
    "between": X.between,
    "local": X.local,
    "retract": X.retract,
    "transform_from": X.transform_from,
    "+": lambda o: V + o,
    "o +": lambda o: o + V,
    "*": lambda o: V * o,
    "/": lambda o: V / o,
    "**": lambda o: V**o,
    "[]": lambda o: V[o],
    "<": lambda o: o > V,
    "dot": lambda o: liegen.dot(V, o),
    "cross": lambda o: liegen.cross(V, o),
    "norm": liegen.norm,
    "sin": liegen.sin,
    "atan2": lambda o: liegen.atan2(o, V),
    "stack": lambda o: liegen.stack(o, V),
    "maximum": lambda o: liegen.maximum(V, o),
    "where": lambda o: liegen.where(o, V, V),
    "State(o, v)": lambda o: State(o, V),
    "State(x, o)": lambda o: State(X, o),
    "State.from_storage": State.from_storage,
    "compile": liegen.compile,
    "Chart": liegen.Chart,
    "Layout": liegen.Layout,
    "frames": liegen.frames,
    "factor": factor,
    "outputs": lambda o: outputs(a=o),
    "outputs without a name": lambda o: outputs(o),
    **{f"@factor({name}=)": lambda o, name=name: stated(**{name: o})
       for name in ("chart", "layout", "noise", "loss", "mode", "name", "sample", "frames", "normalise")},
}  # fmt: skip
#: Operations that refuse whatever is given.
ALWAYS = ("SO3(o)", "S2(o)", "Cal3_S2(o)", "outputs without a name", "Chart", "compile")


@pytest.mark.parametrize("name", OPERATIONS)
def test_an_odd_value_is_refused_in_one_clear_line(name, recwarn):
    refused: dict[str, str] = {}
    for kind, value in ODD.items():
        try:
            OPERATIONS[name](value)
        except LiegenError as error:
            refused[kind] = str(error)
    assert all("\n" not in message and len(message) < 600 for message in refused.values())
    assert {"dict", "object"} & refused.keys()
    if name in ALWAYS:
        assert refused.keys() == ODD.keys()
    assert not recwarn.list
