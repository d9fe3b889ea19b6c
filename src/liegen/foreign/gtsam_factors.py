"""GTSAM's factors, objects and classes, as functions to check.

An object is recognised by its methods, so that nothing here imports GTSAM. Residual and Jacobians are
unwhitened: the residual is ``unwhitenedError``; the Jacobians are those of ``linearize`` with the noise taken
out, by a copy of the factor with unit noise where GTSAM makes one, otherwise by solving R A = A_whitened with
the upper triangular R of the Gaussian noise model.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.errors import SourceError, ToolError

from .gtsam_values import from_gtsam, to_gtsam
from .signature import Argument, Signature

Array = NDArray[np.float64]
#: Methods of a factor that give what it measured, its prior or its calibration.
_GIVEN = ("measured", "prior", "calibration")


def is_factor(found: Any) -> bool:
    """Whether it is a factor of GTSAM, or a class of such: by its methods."""
    return all(hasattr(found, name) for name in ("keys", "linearize", "noiseModel", "unwhitenedError"))


def given_by(factor: Any, expected: Signature, place: str, stated: Mapping[str, Any]) -> Mapping[str, Array]:
    """The stored numbers of what a factor fixes of the arguments that a formula is given.

    They are those of its ``measured()`` and the like.

    ``stated`` has those that it does not tell, by the argument's name. Raises SourceError where it has other
    keys than the formula variables, or lacks a given argument.
    """
    variables = expected.variables
    if len(factor.keys()) != len(variables):
        raise SourceError(
            f"{place} has {len(factor.keys())} keys, {expected.factor} has the variables "
            f"{', '.join(p.name for p in variables)}"
        )
    held = [getattr(factor, name)() for name in _GIVEN if hasattr(factor, name)]
    found: dict[str, Array] = {}
    for p in expected.arguments:
        if p.variable:
            continue
        candidates = [stated[p.name]] if p.name in stated else held
        stored = next((s for h in candidates if (s := from_gtsam(p, h)) is not None), None)
        if stored is None:
            raise SourceError(
                f"{place} tells no {p.manifold} for the argument {p.name!r} of {expected.factor} "
                f"({', '.join(f'{n}()' for n in _GIVEN)}); say where it is: --given {p.name}=NAME"
            )
        found[p.name] = stored
    return found


def evaluated(factor: Any, variables: Sequence[Argument], arguments: Sequence[Array]) -> tuple[Array, ...]:
    """The unwhitened residual and the Jacobian by each variable, which are the factor's keys in order."""
    gtsam = _module_of(factor)
    values = gtsam.Values()
    for key, p, stored in zip(factor.keys(), variables, arguments, strict=True):
        values.insert(key, to_gtsam(gtsam, p, stored))
    residual = np.asarray(factor.unwhitenedError(values), dtype=np.float64)
    A = _unwhitened(gtsam, factor, values, len(residual))
    dims = [p.dim for p in variables]
    if A.shape[1] != sum(dims):
        raise ToolError(f"its Jacobians have {A.shape[1]} columns, the variables {sum(dims)}")
    return residual, *np.split(A, np.cumsum(dims)[:-1], axis=1)


def made(factor_class: Any, expected: Signature, arguments: Mapping[str, Array]) -> Any:
    """A factor of a class such as BetweenFactorPose3: keys, what is given, and unit noise."""
    gtsam = _module_of(factor_class)
    variables = expected.variables
    others = [p for p in expected.arguments if not p.variable]
    given = [to_gtsam(gtsam, p, arguments[p.name]) for p in others]
    noise = gtsam.noiseModel.Unit.Create(expected.rows)
    try:
        return factor_class(*range(len(variables)), *given, noise)
    except TypeError:
        names = [*(f"key_{p.name}" for p in variables), *(p.name for p in others)]
        raise ToolError(
            f"{factor_class.__name__}({', '.join(names)}, noise) is not how it is made; give a factor object"
        ) from None


def _unwhitened(gtsam: Any, factor: Any, values: Any, rows: int) -> Array:
    try:
        plain = factor.cloneWithNewNoiseModel(gtsam.noiseModel.Unit.Create(rows))
    except (AttributeError, RuntimeError):  # an older GTSAM, a CustomFactor
        plain = None
    if plain is not None:
        return np.asarray(plain.linearize(values).jacobian()[0], dtype=np.float64)
    noise = factor.noiseModel()
    kind = type(noise).__name__
    if kind in ("Robust", "Constrained"):
        raise ToolError(
            f"its {kind} noise cannot be taken out of the Jacobians; give it a Gaussian noise model"
        )
    whitened = np.asarray(factor.linearize(values).jacobian()[0], dtype=np.float64)
    return np.linalg.solve(np.asarray(noise.R(), dtype=np.float64), whitened).astype(np.float64)


def _module_of(factor: Any) -> Any:
    """The package that the object's class is from, ``gtsam``."""
    owner = factor if isinstance(factor, type) else type(factor)
    found = (base.__module__.partition(".")[0] for base in owner.__mro__)
    name = next((n for n in found if n == "gtsam"), owner.__module__.partition(".")[0])
    return importlib.import_module(name)
