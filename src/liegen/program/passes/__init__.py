"""The passes, and the order in which they run.

A pass is a function ``Program -> Program`` in a file of its own: the values stay the same (to rounding), the
number of operations does not grow (``reciprocals`` trades divisions for products, see there). A new pass is
one file and one line in ``PASSES``.
"""

from __future__ import annotations

from collections.abc import Callable

from liegen.program.program import Program

from .contraction import contract
from .dead_code import dead
from .divisions import reciprocals
from .factoring import factor
from .folding import fold
from .scheduling import schedule
from .shared_terms import terms
from .sign_sharing import signs
from .subexpressions import cse

Pass = Callable[[Program], Program]

#: Run in turn, again and again until nothing changes.
PASSES: tuple[Pass, ...] = (cse, fold, signs, terms, factor, reciprocals)
#: What follows in the other rounds: folding shares equal operations too.
AGAIN = PASSES[1:]
#: Run once at the end.
FINAL: tuple[Pass, ...] = (dead, contract, schedule)
#: Rounds at most.
ROUNDS = 4


def optimise(program: Program) -> tuple[Program, tuple[tuple[str, int], ...]]:
    """Run all passes; return the program and a row (name, operations left) per pass that ran.

    The first row is the program as it came. A pass does not run again on what it returned itself. Every
    result that differs from what the pass was given is validated.
    """
    rows = [("lower", program.operations)]
    version = 0  # of the program; the one that each pass returned
    returned: dict[str, int] = {}
    for step in (*PASSES, *AGAIN * (ROUNDS - 1), *FINAL):
        name = step.__name__
        if returned.get(name) == version:
            continue
        found, operations = step(program), rows[-1][1]
        if found != program:
            program, version, operations = found.validate(), version + 1, found.operations
        returned[name] = version
        rows.append((name, operations))
    return program, tuple(rows)
