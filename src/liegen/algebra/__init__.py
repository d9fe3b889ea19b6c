"""Scalar backends. A closed form written with these functions runs on floats, batches, mpmath, SymPy and SX.

A function looks at the type of its arguments, loads the backend of that type once, and calls it there;
plain numbers mix with any other scalar.
"""

from __future__ import annotations

import importlib
from functools import cache

from .base import FUNCTIONS as FUNCTIONS
from .base import Algebra as Algebra
from .base import Scalar as Scalar

_MODULES = {"casadi": "casadi_backend", "mpmath": "mpmath_backend", "sympy": "sympy_backend"}
_PLAIN = ("builtins", "numpy")


@cache
def backend(name: str) -> Algebra:
    """The backend called ``numpy``, ``casadi``, ``mpmath`` or ``sympy``."""
    return importlib.import_module(f".{_MODULES.get(name, 'numpy_backend')}", __name__).BACKEND


def algebra_of(*scalars: Scalar) -> Algebra:
    """The backend of the first scalar that is not a plain number, else NumPy's."""
    for x in scalars:
        root = type(x).__module__.partition(".")[0]
        if root not in _PLAIN:
            return backend(root)
    return backend("numpy")


def call(name: str, *args: Scalar) -> Scalar:
    """Call the backend function ``name`` on ``args``."""
    return algebra_of(*args).functions[name](*args)


def sqrt(x: Scalar) -> Scalar:
    """Square root."""
    return call("sqrt", x)


def sin(x: Scalar) -> Scalar:
    """Sine."""
    return call("sin", x)


def cos(x: Scalar) -> Scalar:
    """Cosine."""
    return call("cos", x)


def atan2(y: Scalar, x: Scalar) -> Scalar:
    """Angle of the vector (x, y) in (-pi, pi]."""
    return call("atan2", y, x)


def fabs(x: Scalar) -> Scalar:
    """Absolute value."""
    return call("abs", x)


def lt(a: Scalar, b: Scalar) -> Scalar:
    """The condition a < b."""
    return call("lt", a, b)


def le(a: Scalar, b: Scalar) -> Scalar:
    """The condition a <= b."""
    return call("le", a, b)


def select(condition: Scalar, a: Scalar, b: Scalar) -> Scalar:
    """Return ``a`` where the condition holds, else ``b``; both arms are evaluated, so both must be safe."""
    return algebra_of(condition, a, b).functions["select"](condition, a, b)
