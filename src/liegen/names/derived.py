"""Names that are made of those of variables and outputs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations_with_replacement

#: What noise adds to the arguments of a factor.
SQRT_INFO = "sqrt_info"
COST = "cost"


def jacobian_name(output: str, variable: str) -> str:
    """``res_D_x``."""
    return f"{output}_D_{variable}"


def gradient_name(variable: str) -> str:
    """``g_x``."""
    return f"g_{variable}"


def block_name(row: str, column: str) -> str:
    """``H_x_y``; ``H_lambda_lambda_`` of ``lambda_``, for C++ keeps double underscores."""
    return f"H_{row.rstrip('_')}_{column}"


def derived_names(outputs: Sequence[str], variables: Sequence[str], *, factor: bool) -> Iterator[str]:
    """All names that code for a factor or function may define, in any later use, beside its own."""
    yield from (jacobian_name(o, v) for o in outputs for v in variables)
    if factor:
        yield COST
        yield from map(gradient_name, variables)
        yield from (block_name(a, b) for a, b in combinations_with_replacement(variables, 2))
