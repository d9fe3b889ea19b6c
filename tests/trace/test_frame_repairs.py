"""What an error about frames says to write has frames that fit, wherever it says so."""

import ast
import re

import pytest
from frame_tools import made
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from test_frame_rules import REJECTED

from liegen.errors import DefinitionError
from liegen.trace import formula

POSES = st.sampled_from(["T_AB", "T_BC", "T_AC", "T_CB", "T_DC"])
ROTATIONS = st.sampled_from(["R_AB", "R_BC", "R_CB"])
VECTORS = st.sampled_from(["p_A", "p_B", "p_C", "v_A", "v_B", "t_AB", "q"])


def pairs(pattern, *parts):
    return st.tuples(*parts).map(lambda texts: pattern.format(*texts))


def poses(inner):
    return st.one_of(
        pairs("{}.compose({})", inner, inner), pairs("{}.between({})", inner, inner),
        pairs("{}.inverse()", inner), pairs("SE3({}, {})", ROTATIONS, VECTORS),
    )  # fmt: skip


MAPS = st.recursive(POSES, poses, max_leaves=3)


def vectors(inner):
    return st.one_of(
        pairs("{}.transform_from({})", MAPS, inner), pairs("{}.transform_to({})", MAPS, inner),
        pairs("({}.rotation @ {})", MAPS, inner), pairs("{}.unrotate({})", ROTATIONS, inner),
        pairs("({} - {})", inner, inner), pairs("({} + {})", inner, inner),
        pairs("cross({}, {})", inner, inner),
    )  # fmt: skip


BODIES = st.one_of(
    st.recursive(VECTORS, vectors, max_leaves=4), pairs("{}.log()", MAPS), pairs("{}.local({})", MAPS, MAPS)
)


class Swap(ast.NodeTransformer):
    """Puts ``new`` where ``old`` stands."""

    def __init__(self, old, new):
        self.old, self.new = ast.dump(old), new

    def visit(self, node):
        return self.new if ast.dump(node) == self.old else super().generic_visit(node)


def parsed(text):
    return ast.parse(text, mode="eval").body


def mended(body, said):
    """The bodies that the message may mean: its repair for what it quotes, or for an operand of that."""
    found = re.fullmatch(r"[^:]+:\d+: made: (.*): .*; write (.*)", said)
    assert found
    quoted, repair = map(parsed, found.groups())
    kept = {ast.dump(n) for n in ast.walk(repair)}
    inner = [n for n in ast.walk(quoted) if isinstance(n, ast.expr) and ast.dump(n) in kept]
    whole = [repair, *(Swap(n, repair).visit(parsed(found[1])) for n in inner)]
    return [ast.unparse(Swap(quoted, made).visit(parsed(body))) for made in whole]


def refusal(body):
    """What is said of a body, nothing where it fits."""
    try:
        made(body)
    except DefinitionError as error:
        return str(error)
    return ""


def fits(body):
    return not refusal(body)


def printed(body):
    """The body as messages quote it; None where that takes several lines."""
    lines = formula(made(body, frames=False).graph)
    line = next(line for line in lines if line.startswith("r = ")).removeprefix("r = ")
    return line if len(lines) <= 2 and "..." not in line else None


@settings(max_examples=300, deadline=None)
@given(BODIES)
def test_a_repair_mends(body):
    body = printed(body)
    assume(body)
    said = refusal(body)
    if "; write " in said and "..." not in said:
        assert any(map(fits, mended(body, said))), said


@pytest.mark.parametrize("body", [body for body, (_, repair) in REJECTED.items() if repair])
def test_repairs_of_the_table_mend(body):
    body = printed(body) or body
    said = refusal(body)
    assert any(map(fits, mended(body, said))), said


@pytest.mark.parametrize(
    "body",
    [
        "T_AB.compose(T_CB).transform_to(p_B)",  # the likely repair moves the mistake
        "R_AB @ R_CB @ p_B",
        "T_BC.transform_from(p_A) - p_C",
    ],
)
def test_no_repair_that_moves_the_mistake(body):
    said = refusal(body)
    assert said
    assert "; write " not in said
