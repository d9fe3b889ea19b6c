"""CasADi's scalar operations as instructions of a program, with conditions told from numbers.

CasADi keeps conditions as numbers 0 and 1 and calculates with them: ``if_else(c, a, b)`` arrives as
``if_else_zero(c, a) + if_else_zero(!c, b)``, the derivative of ``fmin`` as
``le(x, y) / (le(x, y) + le(y, x))``. Here a condition is never a number: the sums become two-armed selects,
and arithmetic on conditions is carried out on the constants at the leaves of selects.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from .program import CONDITIONS
from .rewrite import Builder

#: Largest exponent that is written out as products.
MAX_POWER = 64


class Operations(Builder):
    """A builder that takes CasADi's operations: any operand may be a number or a condition."""

    # -- conditions and numbers ----------------------------------------------------------------------------

    def number(self, i: int) -> int:
        """The condition i as the number 1 or 0; a number is left as it is."""
        return self.select(i, self.const(1.0), self.const(0.0)) if self.code[i].op in CONDITIONS else i

    def condition(self, i: int) -> int:
        """The number i as the condition i != 0; a condition is left as it is."""
        ins = self.code[i]
        if ins.op in CONDITIONS:
            return i
        if ins.op == "const":
            return self.share(
                "lt", (self.const(0.0), self.const(1.0)) if ins.value else (self.const(0.0),) * 2
            )
        return self.ne(i, self.const(0.0))

    def negation(self, i: int) -> int:
        """Not i."""
        c = self.condition(i)
        return self.code[c].args[0] if self.code[c].op == "not" else self.share("not", (c,))

    def conjunction(self, i: int, j: int) -> int:
        """Both i and j."""
        return self.share("and", (self.condition(i), self.condition(j)))

    def disjunction(self, i: int, j: int) -> int:
        """At least one of i and j."""
        return self.share("or", (self.condition(i), self.condition(j)))

    def lt(self, i: int, j: int) -> int:
        """The condition i < j."""
        return self.share("lt", (self.number(i), self.number(j)))

    def le(self, i: int, j: int) -> int:
        """The condition i <= j."""
        return self.share("le", (self.number(i), self.number(j)))

    def eq(self, i: int, j: int) -> int:
        """The condition i == j; false for NaN."""
        return self.share("and", (self.le(i, j), self.le(j, i)))

    def ne(self, i: int, j: int) -> int:
        """The condition i != j; true for NaN."""
        return self.negation(self.eq(i, j))

    # -- selects -------------------------------------------------------------------------------------------

    def select(self, c: int, a: int, b: int) -> int:
        """``c ? a : b`` for a condition c."""
        if a == b:
            return a
        if self.code[c].op == "not":
            return self.select(self.code[c].args[0], b, a)
        return self.share("select", (c, a, b))

    def if_else_zero(self, c: int, a: int) -> int:
        """``c ? a : 0``; of a condition, again a condition."""
        if self.code[a].op in CONDITIONS:
            return self.conjunction(c, a)
        return self.select(self.condition(c), a, self.const(0.0))

    def guarded(self, i: int) -> tuple[int, int, bool] | None:
        """(c, a, held) if i is a where the condition c is ``held``, and zero elsewhere."""
        ins = self.code[i]
        if ins.op == "select":
            c, a, b = ins.args
            if self.value(b) == 0.0:
                return c, a, True
            return (c, b, False) if self.value(a) == 0.0 else None
        if ins.op == "mul":
            for p, q in (ins.args, ins.args[::-1]):
                found = self.guarded(q) if self.code[q].op == "select" else None
                if found:
                    return found[0], self.mul(p, found[1]), found[2]
        if ins.op == "neg":
            found = self.guarded(ins.args[0])
            return found and (found[0], self.neg(found[1]), found[2])
        return None

    def exclusive(self, i: int, j: int) -> bool:
        """Whether the conditions i and j are ``c and p``, ``not c and q``: at most one of them holds."""
        if self.code[i].op != "and" or self.code[j].op != "and":
            return False
        pairs = [(self.code[p], p, self.code[q], q) for p in self.code[i].args for q in self.code[j].args]
        return any(one.args == (q,) or two.args == (p,) for one, p, two, q in pairs)

    def merged(self, i: int, j: int) -> int | None:
        """The sum of two terms that are zero where the other is not, as one select."""
        one = self.guarded(i)
        two = self.guarded(j) if one else None
        if one is None or two is None or one[0] != two[0] or one[2] == two[2]:
            return None
        return self.select(one[0], *((one[1], two[1]) if one[2] else (two[1], one[1])))

    # -- arithmetic on constants at the leaves of selects ---------------------------------------------------

    def table(self, i: int, depth: int = 3) -> bool:
        """Whether i is a constant, or selects over constants only."""
        ins = self.code[i]
        if ins.op == "const":
            return True
        return ins.op == "select" and depth > 0 and all(self.table(a, depth - 1) for a in ins.args[1:])

    def combined(self, f: Callable[[float, float], float], i: int, j: int, known: Mapping[int, bool]) -> int:
        """The table of f(i, j) under known conditions. Raises ZeroDivisionError like f."""
        for k in (i, j):
            ins = self.code[k]
            if ins.op == "select":
                c, a, b = ins.args

                def arm(held: bool, k: int = k, c: int = c, a: int = a, b: int = b) -> int:
                    chosen = a if held else b
                    pair = (chosen if i == k else i, chosen if j == k else j)
                    return self.combined(f, *pair, {**known, c: held})

                return arm(known[c]) if c in known else self.select(c, arm(True), arm(False))
        return self.const(f(self.code[i].value, self.code[j].value))

    def arithmetic(self, op: str, i: int, j: int) -> int | None:
        """The result on tables as a table, None where that is not possible."""
        if not (self.table(i) and self.table(j)):
            return None
        try:
            return self.combined(_TABLE[op], i, j, {})
        except (ZeroDivisionError, OverflowError):
            return None

    def add(self, i: int, j: int) -> int:
        """The sum i + j."""
        if self.exclusive(i, j):
            return self.disjunction(i, j)
        i, j = self.number(i), self.number(j)
        found = self.merged(i, j)
        found = found if found is not None else self.arithmetic("add", i, j)
        return found if found is not None else self.emit("add", (i, j))

    def sub(self, i: int, j: int) -> int:
        """The difference i - j."""
        i, j = self.number(i), self.number(j)
        found = self.arithmetic("sub", i, j)
        return found if found is not None else self.emit("sub", (i, j))

    def mul(self, i: int, j: int) -> int:
        """The product i * j; of two conditions, that both hold."""
        if self.code[i].op in CONDITIONS and self.code[j].op in CONDITIONS:
            return self.conjunction(i, j)
        i, j = self.number(i), self.number(j)
        found = self.arithmetic("mul", i, j)
        if found is not None:
            return found
        for factor, x in ((i, j), (j, i)):
            ins = self.code[factor]
            if ins.op == "select" and all(self.value(a) in (-1.0, 0.0, 1.0) for a in ins.args[1:]):
                return self.select(ins.args[0], *(self.scaled(self.code[a].value, x) for a in ins.args[1:]))
        return self.emit("mul", (i, j))

    def scaled(self, sign: float, x: int) -> int:
        """``sign * x`` for a sign of -1, 0 or 1."""
        return x if sign == 1.0 else self.neg(x) if sign else self.const(0.0)

    def div(self, i: int, j: int) -> int:
        """The quotient i / j."""
        i, j = self.number(i), self.number(j)
        found = self.arithmetic("div", i, j)
        return found if found is not None else self.emit("div", (i, j))

    def neg(self, i: int) -> int:
        """-i."""
        i = self.number(i)
        found = self.arithmetic("sub", self.const(0.0), i)
        return found if found is not None else self.emit("neg", (i,))

    # -- the other functions -------------------------------------------------------------------------------

    def sign(self, i: int) -> int:
        """-1, 0 or 1."""
        i, zero = self.number(i), self.const(0.0)
        below = self.select(self.lt(i, zero), self.const(-1.0), zero)
        return self.select(self.lt(zero, i), self.const(1.0), below)

    def fmin(self, i: int, j: int) -> int:
        """The smaller one."""
        i, j = self.number(i), self.number(j)
        return self.select(self.le(i, j), i, j)

    def fmax(self, i: int, j: int) -> int:
        """The larger one."""
        i, j = self.number(i), self.number(j)
        return self.select(self.le(j, i), i, j)

    def hypot(self, i: int, j: int) -> int:
        """Length of the vector (i, j)."""
        return self.emit("sqrt", (self.add(self.mul(i, i), self.mul(j, j)),))

    def power(self, i: int, j: int) -> int:
        """A constant power of i that is a whole number or a half. Raises LookupError for another one."""
        exponent, x = self.value(j), self.number(i)
        if exponent is None or not (2 * exponent).is_integer() or abs(exponent) > MAX_POWER:
            raise LookupError("x**y with y no constant whole number or half (for x > 0 write exp(y*log(x)))")
        factors: list[int] = []
        whole, square = int(abs(exponent)), x
        while whole:
            if whole & 1:
                factors.append(square)
            whole >>= 1
            square = self.mul(square, square) if whole else square
        if not abs(exponent).is_integer():
            factors.append(self.emit("sqrt", (x,)))
        product = self.const(1.0)
        for k, factor in enumerate(factors):
            product = self.mul(product, factor) if k else factor
        return product if exponent >= 0 else self.div(self.const(1.0), product)

    def sq(self, i: int) -> int:
        """The square of i."""
        return self.mul(i, i)

    def twice(self, i: int) -> int:
        """Two times i."""
        return self.mul(self.const(2.0), i)

    def inv(self, i: int) -> int:
        """The reciprocal of i."""
        return self.div(self.const(1.0), i)

    def atan2(self, i: int, j: int) -> int:
        """Angle of the vector (j, i)."""
        return self.emit("atan2", (self.number(i), self.number(j)))

    def unary(self, op: str, i: int) -> int:
        """A function of one number that the program has too."""
        return self.emit(op, (self.number(i),))


_TABLE: Mapping[str, Callable[[float, float], float]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b if a else 0.0,  # 0/0 only where a comparison met NaN
}
