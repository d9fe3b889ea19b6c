"""The decorators ``@factor`` and ``@function``."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import partial
from typing import Any, ParamSpec, TypeVar, overload

from liegen.arguments import callable_of, name_of
from liegen.define import Function, Sampler
from liegen.errors import DefinitionError
from liegen.manifolds import Manifold, Vector
from liegen.manifolds.given import spoken
from liegen.manifolds.node import here
from liegen.noise import Weighting
from liegen.noise import weighting as read_weighting
from liegen.trace import ChartLike, LayoutLike, Outputs, signature

P = ParamSpec("P")
S = TypeVar("S", bound="Manifold | Outputs")


@overload
def factor(function: Callable[P, Vector], /) -> Function[P, Vector]: ...
@overload
def factor(
    *,
    name: str = "",
    sample: Sampler | None = None,
    frames: bool = True,
    chart: ChartLike | None = None,
    layout: LayoutLike | None = None,
    normalise: bool = False,
) -> Callable[[Callable[P, Vector]], Function[P, Vector]]: ...
@overload
def factor(
    *,
    noise: str | None = None,
    loss: str | None = None,
    mode: str | None = None,
    name: str = "",
    sample: Sampler | None = None,
    frames: bool = True,
    chart: ChartLike | None = None,
    layout: LayoutLike | None = None,
    normalise: bool = False,
) -> Callable[[Callable[P, Vector]], Function[..., Vector]]: ...
def factor(
    function: Any = None,
    /,
    *,
    noise: str | None = None,
    loss: str | None = None,
    mode: str | None = None,
    name: str = "",
    sample: Sampler | None = None,
    frames: bool = True,
    chart: ChartLike | None = None,
    layout: LayoutLike | None = None,
    normalise: bool = False,
) -> Any:
    """Make a factor of a function that returns a residual vector.

    Positional parameters are variables, keyword-only ones are given; annotations are their manifolds.
    ``name`` is that of the generated code, by default the function's own: factories give theirs. ``sample``
    draws arguments for verification. With ``frames=False`` names such as ``T_WB`` do
    not declare frames. ``chart`` is that of ``local`` and ``retract`` and of the Jacobians' columns: the name
    of a preset (``"sophus"``) or a ``liegen.Chart``; or charts of the columns of single variables,
    ``{"x": "sophus"}``. By default it is that of GTSAM 4.3. ``layout`` is what rotations and poses are stored
    as where generated code is called: a name (``"wxyz"``, ``"4x4"``, ``"ceres"``), a ``liegen.Layout``, or
    layouts of single arguments; Jacobians do not depend on it. ``normalise`` brings quaternions, (cos, sin)
    and directions of the arguments to unit length as they are read.

    ``noise`` ("full", "packed", "diagonal", "isotropic") adds the keyword ``sqrt_info``, S with S^T S =
    covariance^-1, in the frame of the residual: an upper triangular matrix (..., m, m) whose lower part is
    not read, or 1 / standard deviation (..., m) or (..., 1). ``loss`` (see ``liegen.noise.LOSSES``) adds
    its parameters. Outputs are then those of least squares on the cost 1/2 rho(|S r|^2), weighed by
    ``mode``: "irls" (the default) or "triggs".
    """
    weighting = read_weighting(noise, loss, mode, str(here()))
    return _decorated(
        function, name, sample, is_factor=True, frames=frames, chart=chart, layout=layout,
        normalise=normalise, weighting=weighting,
    )  # fmt: skip


@overload
def function(function: Callable[P, S], /) -> Function[P, S]: ...
@overload
def function(
    *,
    name: str = "",
    sample: Sampler | None = None,
    frames: bool = True,
    chart: ChartLike | None = None,
    layout: LayoutLike | None = None,
    normalise: bool = False,
) -> Callable[[Callable[P, S]], Function[P, S]]: ...
def function(
    function: Any = None,
    /,
    *,
    name: str = "",
    sample: Sampler | None = None,
    frames: bool = True,
    chart: ChartLike | None = None,
    layout: LayoutLike | None = None,
    normalise: bool = False,
) -> Any:
    """Make a function with outputs on any manifolds: return one typed value, or ``outputs(R=..., p=...)``.

    ``name``, ``sample``, ``chart``, ``layout`` and ``normalise`` as in :func:`factor`; chart and layout are
    those of the outputs too.
    """
    return _decorated(
        function,
        name,
        sample,
        is_factor=False,
        frames=frames,
        chart=chart,
        layout=layout,
        normalise=normalise,
    )


def _decorated(
    function: Any,
    name: str,
    sample: Sampler | None,
    *,
    is_factor: bool,
    frames: bool,
    chart: ChartLike | None,
    layout: LayoutLike | None,
    normalise: bool,
    weighting: Weighting | None = None,
) -> Callable[..., Any]:
    if function is None:
        return partial(
            _decorated, name=name, sample=sample, is_factor=is_factor, frames=frames, chart=chart,
            layout=layout, normalise=normalise, weighting=weighting,
        )  # fmt: skip
    if not inspect.isfunction(function):
        raise DefinitionError(f"{here()}: a factor is made of a function, got a {type(function).__name__}")
    what = f"{here()}: {function.__name__}"
    if inspect.isgeneratorfunction(function) or inspect.iscoroutinefunction(function):
        raise DefinitionError(f"{what}: a factor returns its value, without async and yield; write return")
    for option, given in (("frames", frames), ("normalise", normalise)):
        if not isinstance(given, bool):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise DefinitionError(f"{what}: {option}= is True or False, got {spoken(given)}")
    doc = inspect.getdoc(function) or ""
    made: Function[..., Any] = Function(
        function,
        signature(function),
        name_of(name, f"{what}: name=") or function.__name__,
        doc,
        is_factor,
        callable_of(sample, f"{what}: sample="),
        frames,
        chart,
        weighting=weighting,
        layout=layout,
        normalise=normalise,
    )
    return made
