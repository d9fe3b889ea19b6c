"""Operations by kind, as the manifest keeps them for review."""

from __future__ import annotations

from collections.abc import Mapping

from .program import CONDITIONS, FREE, Program
from .rewrite import use_counts

KINDS = ("add", "mul", "div", "sqrt", "call", "select", "sign")
_KIND: Mapping[str, str] = {
    **dict.fromkeys(("add", "sub"), "add"),
    **{op: op for op in ("mul", "div", "sqrt")},
    **dict.fromkeys(("select", *sorted(CONDITIONS)), "select"),
    **dict.fromkeys(("neg", "abs"), "sign"),
}


def kinds(program: Program) -> dict[str, int]:
    """How many sums, products, divisions, roots, calls of libm, selects, and changes of sign there are.

    Sums are additions and subtractions; selects count with their comparisons. These add up to
    ``program.operations``. Besides, ``fused`` tells for how many pairs of a product and a sum a machine with
    fused multiply-add needs one instruction only: a b + c, where the product has no other use.
    """
    counts: dict[str, int] = dict.fromkeys((*KINDS, "fused"), 0)
    uses = use_counts(program)
    for ins in program.code:
        if ins.op not in FREE:
            kind = _KIND.get(ins.op, "call")
            counts[kind] += 1
            inner = kind == "add" and any(program.code[a].op == "mul" and uses[a] == 1 for a in ins.args)
            counts["fused"] += inner
    return counts
