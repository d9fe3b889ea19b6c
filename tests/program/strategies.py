"""Random well-formed programs, and their values to 50 digits."""

import mpmath
from hypothesis import strategies as st

from liegen.algebra import backend
from liegen.program import Instruction, Port, Program, Requirement
from liegen.program.program import BINARY, CONDITIONS, UNARY
from liegen.program.rewrite import roots

CONSTANTS = (0.0, 1.0, -1.0, 2.0, 0.5, -2.0, 3.0, -0.25)
NUMERIC = (*["add", "sub", "mul", "neg"] * 6, *["div", "select"] * 3, *sorted(UNARY - {"neg"}), "atan2")
LOGIC = ("lt", "le", "and", "or", "not")


@st.composite
def programs(draw, size=40):
    """A random DAG over four inputs: every operation, few constants.

    Of constants alone only sums, differences, products and negatives are made, which doubles hold exactly.
    """
    code = [Instruction("input", (), float(k)) for k in range(4)]
    code += [
        Instruction("const", (), draw(st.sampled_from(CONSTANTS))) for _ in range(draw(st.integers(1, 3)))
    ]
    numbers, conditions = list(range(len(code))), []
    fixed = set(range(4, len(code)))  # depend on no input

    def pick(pool):
        return pool[-1 - draw(st.integers(0, len(pool) - 1))]

    for _ in range(draw(st.integers(1, size))):
        op = draw(st.sampled_from(NUMERIC)) if draw(st.integers(0, 7)) else draw(st.sampled_from(LOGIC))
        if op in ("and", "or", "not") and not conditions:
            op = "lt"
        if op == "select" and not conditions:
            op = "sub"
        if op in ("and", "or"):
            args = (pick(conditions), pick(conditions))
        elif op == "not":
            args = (pick(conditions),)
        elif op == "select":
            args = (pick(conditions), pick(numbers), pick(numbers))
        elif op in BINARY | CONDITIONS:
            args = (pick(numbers), pick(numbers))
        else:
            args = (pick(numbers),)
        if fixed.issuperset(args) and op in UNARY | BINARY:
            op = op if op in ("add", "sub", "mul", "neg") else "neg" if len(args) == 1 else "sub"
        if fixed.issuperset(args[-2:] if op == "select" else args):
            fixed.add(len(code))
        (conditions if op in CONDITIONS else numbers).append(len(code))
        code.append(Instruction(op, args))
    results = [pick(numbers) for _ in range(draw(st.integers(1, 6)))]
    requirements = [Requirement(c, f"number {c}") for c in conditions[:2]] if draw(st.booleans()) else []
    ports = (Port("a", (1,)), Port("b", (3,))), (Port("r", (len(results),)),)
    return Program("p", *ports, tuple(code), (tuple(results),), tuple(requirements)).validate()


VALUES = st.lists(
    st.one_of(st.floats(-3, 3, allow_nan=False, width=32), st.sampled_from([0.0, 1.0, -1.0])),
    min_size=4,
    max_size=4,
)


#: Numbers that no short formula of small constants hits.
GENERIC = st.lists(
    st.integers(1, 10**6).map(lambda k: k * 0.6180339887498949 % 6 - 3), min_size=4, max_size=4
)


def run(program, values):
    """Every instruction's value as (number or bool); the working precision is 50 digits."""
    with mpmath.workdps(50):
        numbers = [mpmath.mpf(v) for v in values]
        return program.run({"a": numbers[:1], "b": numbers[1:]}, backend("mpmath"))


def well_conditioned(slots):
    """Whether no value is NaN, infinite, huge, or zero by cancellation only (a comparison could tip)."""
    numbers = [abs(s) for s in slots if not isinstance(s, bool)]
    return all(mpmath.isfinite(s) and s < 1e12 and (s == 0 or s > 1e-20) for s in numbers)


def on_an_edge(program, slots):
    """Whether a rounding error, however small, could tip a comparison or leave a domain."""
    edges = {
        "lt": lambda a, b: a == b,
        "le": lambda a, b: a == b,
        "atan2": lambda y, x: y == 0,
        "asin": lambda a: abs(a) == 1,
        "acos": lambda a: abs(a) == 1,
        "sqrt": lambda a: a == 0,
    }
    needed = set(roots(program))
    for k in reversed(range(len(program.code))):
        if k in needed:
            needed.update(program.code[k].args)
    used = [program.code[k] for k in needed]
    return any(ins.op in edges and edges[ins.op](*(slots[a] for a in ins.args)) for ins in used)
