"""Operations by kind, as the manifest keeps them for review."""

from __future__ import annotations

from collections.abc import Mapping

from .program import CONDITIONS, Program
from .rewrite import use_counts

KINDS = ("add", "mul", "div", "sqrt", "call", "select", "sign")
_SUMS = ("add", "sub")
_KIND: Mapping[str, str] = {
    **dict.fromkeys(_SUMS, "add"),
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
    counts: dict[str, int] = dict.fromkeys(KINDS, 0)
    for op, count in program.op_counts().items():
        counts[_KIND.get(op, "call")] += count
    return {**counts, "fused": fused(program)}


def fused(program: Program) -> int:
    """The count of that name."""
    code, uses = program.code, use_counts(program)
    single = [op == "mul" and n == 1 for (op, _, _), n in zip(code, uses, strict=True)]
    return [single[args[0]] or single[args[1]] for op, args, _ in code if op in _SUMS].count(True)
