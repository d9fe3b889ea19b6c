"""Evaluates the text of Jacobian formulas on numbers, by reading the notation, not the code that wrote it."""

import re

import numpy as np
from numpy.linalg import norm

import liegen

J = np.array([[0.0, -1.0], [1.0, 0.0]])


def skew(v):
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def split(text, *marks):
    """Split at marks outside of brackets; yields (mark before, part)."""
    depth, start, before, k = 0, 0, "", 0
    while k < len(text):
        depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(text[k], 0)
        mark = next((m for m in marks if depth == 0 and text.startswith(m, k)), None)
        if mark and k > start:
            yield before, text[start:k]
            before, start = mark, k + len(mark)
            k = start
        else:
            k += 1
    yield before, text[start:]


class Reader:
    """``group`` is the group of Ad, Jr and Jl in the formulas."""

    def __init__(self, values, group, matrix=None):
        self.values, self.group, self.matrix = dict(values), group, matrix
        self.planar = group in (liegen.SE2, liegen.SO2, liegen.Sim2)

    def line(self, line, rows=None, columns=None):
        name, _, text = line.partition(" = ")
        value = self.total(text, rows, columns) if "_D_" in name else self.python(text)
        self.values[name] = value
        return value

    def python(self, text):
        return eval(text, vars(liegen) | {"abs": liegen.abs, "M": self.matrix}, dict(self.values))

    def array(self, text):
        """A scalar, vector or condition (in brackets: 1 where it holds, else 0) inside a label."""
        if m := re.fullmatch(r"\[(.*)\]", text):
            return np.asarray(self.array(m[1])).astype(float)
        text = re.sub(r"\|(.*?)\|", r"length(\1)", text).replace("^", "**").replace("sqrt(1", "root(1")
        text = re.sub(r"(\d) (\w)", r"\1 * \2", text)
        text = re.sub(r"Exp\(", f"{self.group.__name__}.exp(", text)
        env = (
            vars(liegen)
            | self.values
            | {"length": lambda v: norm(np.asarray(v)), "root": lambda v: np.sqrt(np.asarray(v))}
        )
        return eval(text, {k: np.asarray(v) if isinstance(v, liegen.Vector) else v for k, v in env.items()}
                    | {f: getattr(np, f) for f in ("sin", "cos", "exp", "sqrt", "sign")})  # fmt: skip

    def element(self, text):
        inverse = text.endswith("^-1")
        value = self.array(text.removesuffix("^-1"))
        return value.inverse() if inverse else value

    def total(self, text, rows, columns):
        if text == "0":
            return np.zeros((rows, columns))
        text = f"- {text[1:]}" if text.startswith("-") else text
        text = text if text.startswith("- ") else f"+ {text}"
        terms = list(split(text, " + ", " - ", "+ ", "- "))
        first = re.match(r"([+-]) (.*)", terms[0][1])
        terms = [(first[1], first[2]), *((m.strip(), t) for m, t in terms[1:])]
        return sum((-1 if m == "-" else 1) * self.product(t, rows, columns) for m, t in terms)

    def product(self, text, rows, columns):
        """From right to left; rows and columns of the identity take their size from their neighbours."""
        if [part for _, part in split(text, " ")][1:2] == ["/"]:
            return np.atleast_2d(self.factor(text))
        parts = [part for _, part in split(text, " ") if part != "I"]
        numbers = [None if part.startswith("I[") else self.factor(part) for part in parts]
        scalar, result = 1.0, None if columns is None else np.eye(columns)
        for k in reversed(range(len(parts))):
            value = numbers[k]
            if m := re.fullmatch(r"I\[:, (\d+):(\d+)\]", parts[k]):
                wide = [n.shape[1] for n in numbers[:k] if n is not None and n.ndim == 2]
                value = np.eye(wide[-1] if wide else rows)[:, int(m[1]) : int(m[2])]
            elif m := re.fullmatch(r"I\[(.*)\]", parts[k]):
                ends = [int(e) for e in m[1].split(":")]
                value = np.eye(len(result))[ends[0] : ends[-1] + (len(ends) == 1)]
            if value.ndim == 0:
                scalar = scalar * value
            else:
                result = value if result is None else value @ result
        return scalar * result

    def factor(self, text):
        if text in self.values and "_D_" in text:
            return self.values[text]
        if text == "J":
            return J
        if text == "M":
            return self.matrix
        if m := re.fullmatch(r"\[-?(?:\[.*\]x|I|0|1|J .*|R\(.*\)(\^T)?( / \S*)?)[,;] .*\]", text):
            return self.blocks(text[1:-1])
        if m := re.fullmatch(r"\[(.*)\]x", text):
            return skew(np.asarray(self.array(m[1])))
        if m := re.fullmatch(r"(Ad|Jr|Jr\^-1|Jl\^-1|R|B|diag|unit)\((.*)\)(\^T)?", text):
            value = self.named(m[1], m[2])
            return value.T if m[3] else value
        if m := re.fullmatch(r"(\w+)\^T", text):
            return np.asarray(self.array(m[1]))[None, :]
        if m := re.fullmatch(r"\(\(J (\w+)\)\^T / (.*)\)", text):
            return (J @ np.asarray(self.array(m[1])))[None, :] / self.array(m[2])
        if m := re.fullmatch(r"\((B\(.*\)) / (.*)\)", text):
            return self.factor(m[1]) / self.array(m[2])
        if m := re.fullmatch(r"\(?(R\([^()]*\)\^T) / ([^()]*)\)?", text):
            return self.factor(m[1]) / float(np.squeeze(self.array(m[2])))
        value = np.asarray(self.array(text), dtype=float)
        return value.reshape(-1, 1) if value.size > 1 else value.reshape(())

    def named(self, name, inner):
        if name == "Ad":
            return self.element(inner).adjoint()
        if name == "R":
            value = self.element(inner)
            return (value.rotation if hasattr(value, "rotation") else value).matrix()
        if name == "B":
            from liegen.manifolds.s2_form import basis

            return np.array(basis(self.element(inner).coords))
        v = np.atleast_1d(np.asarray(self.array(inner), dtype=float))
        if name == "diag":
            return np.diag(v)
        if name == "unit":
            return (v / norm(v)).reshape(-1, 1)
        method = {"Jr": self.group.Jr, "Jr^-1": self.group.Jr_inv, "Jl^-1": self.group.Jl_inv}[name]
        return method(v)

    def blocks(self, text):
        below = "; " in text
        n, dim = (2, 1) if self.planar else (3, 3)
        parts = [p for _, p in split(text, "; " if below else ", ")]
        made = []
        for k, p in enumerate(parts):
            size = (n, dim, 1)[k] if self.planar else (dim, n, 1)[k]
            sizes = {"I": np.eye(n), "-I": -np.eye(n), "1": np.eye(1), "0": (size,)}
            if p in sizes:
                made.append(sizes[p])
            else:
                made.append(self.total(p, None, None))
        known = next(m for m in made if isinstance(m, np.ndarray))
        sizes = [m[0] for m in made if not isinstance(m, np.ndarray)]
        zeros = iter([np.zeros((n, known.shape[1]) if below else (known.shape[0], n)) for n in sizes])
        full = [m if isinstance(m, np.ndarray) else next(zeros) for m in made]
        return (np.vstack if below else np.hstack)(full)
