"""Running a user's function on typed values, once, to get its graph."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from pathlib import Path
from types import MethodType
from typing import Annotated, Any, Never, get_args, get_origin, get_type_hints

import numpy as np

from liegen.advice import for_class
from liegen.charts import Preset
from liegen.errors import DefinitionError, Site
from liegen.exits import no_exit
from liegen.manifolds import Condition, Manifold, Value, Vector
from liegen.manifolds.given import spoken
from liegen.manifolds.node import Leaf, Node, called, here, node_of, parameter
from liegen.manifolds.vector import VectorLike, as_vector

from .charting import ChartLike, common_chart, in_charts
from .defaults import default_of
from .frame_axes import Charts
from .frame_check import check_frames
from .frame_declared import Declared, declared
from .frame_names import Frames
from .graph import Call, Domain, Graph, Parameter, Singular, topological
from .telling import told


@dataclass(frozen=True)
class _Record:
    """What a run of a user's function states beside its result."""

    domain: list[Domain]
    singular: list[Singular]
    calls: list[Call]
    chart: Preset


_record: ContextVar[_Record | None] = ContextVar("record", default=None)

_NAMED = (
    "SO2", "SE2", "SO3", "SE3", "SE23", "NavState", "Gal3", "Sim2", "Sim3", "S2", "Cal3_S2", "Cal3DS2",
    "Cal3Bundler",
)  # fmt: skip
_KNOWN = (*(f"R{n}" for n in range(1, 10)), *_NAMED)
_MANIFOLDS = f"one of liegen's (R1 to R9, {', '.join(_NAMED)}) or class R12(R, dim=12)"


@dataclass(frozen=True)
class Signature:
    """A parameter as it is declared: ``bound`` is a value that ``bind`` gave it."""

    name: str
    manifold: type[Manifold]
    variable: bool
    positional: bool
    bound: Value | None = None
    frames: Declared | None = None
    default: Value | None = None


@dataclass(frozen=True, eq=False)
class Outputs:
    """Named outputs of a ``@function``, each an attribute."""

    values: Mapping[str, Manifold]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name not in self.values:
            raise AttributeError(f"no output {name!r}; there are {', '.join(self.values)}")
        return self.values[name]


def outputs(*unnamed: Never, **values: Manifold) -> Outputs:
    """Name what a ``@function`` returns: ``outputs(R=..., p=...)``."""
    if unnamed or not values:
        raise DefinitionError(f"{here()}: outputs needs a name for each value; write outputs(R=..., p=...)")
    for name, value in values.items():
        if not isinstance(value, Manifold):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise DefinitionError(f"{here()}: output {name!r} is a {type(value).__name__}, not a typed value")
    return Outputs(dict(values))


def require(condition: Condition | bool, message: str) -> None:
    """State where a factor is defined.

    Outside, generated NumPy and C return NaN, C also the condition's bit, and verification draws its samples
    inside. A condition on constants that is false is an error at once. Raises DefinitionError too for what is
    no condition, and for a message that is no text.
    """
    record = _record.get()
    usage = 'write require(p[2] > 0, "the point is in front of the camera")'
    if not isinstance(condition, Condition | bool | np.bool_):  # pyright: ignore[reportUnnecessaryIsInstance]
        got = called(condition) if isinstance(condition, Value) else spoken(condition)
        raise DefinitionError(f"{here()}: require needs a condition first, got {got}; {usage}")
    _require_text("require", message, f"second, {usage}")
    if isinstance(condition, Condition) and condition.traced and record is not None:
        record.domain.append(Domain(node_of(condition), message))
    elif not bool(condition):
        raise DefinitionError(f"{here()}: requirement does not hold: {message}")


def singular(message: str, *zeros: VectorLike) -> None:
    """State that the formula has no derivative, or no value, at some points by its nature.

    With ``zeros`` (vectors or scalars) these are the points at which all of them are 0, without any they are
    all singular points of the formula. Verification, which solves for such points, then lists them with the
    message instead of failing there. Generated code is the same with and without it; where it should return
    NaN and a status bit, use :func:`require`. Raises DefinitionError for a message that is no text.
    """
    record = _record.get()
    usage = 'write singular("point on the axis"), or singular("point on the axis", norm(q[:2]))'
    _require_text("singular", message, f"first, {usage}")
    values = [as_vector(v, where="singular") for v in zeros]
    if record is not None:
        record.singular.append(Singular(message, tuple(map(node_of, values)), here()))


def _require_text(function: str, given: object, where: str) -> None:
    """Raise DefinitionError unless a message is a text."""
    place, _, usage = where.partition(", ")
    if not isinstance(given, str):
        got = f"a {type(given).__name__}"
        raise DefinitionError(f"{here()}: {function} needs a text {place}, got {got}; {usage}")


def inlined(
    name: str,
    site: Site,
    given: Sequence[tuple[Signature, Value]],
    result: Any,
    *,
    frames: bool,
    chart: ChartLike | None,
) -> None:
    """Note that a factor was called on traced values; ``frames``: whether its frames are checked.

    Raises DefinitionError for a factor that states another ``chart`` than the one that is being traced: its
    ``local`` and ``retract`` would change their meaning.
    """
    record = _record.get()
    if record is None:
        return
    inner = record.chart if chart is None else common_chart(chart, f"{site}: {name}")
    if inner != record.chart:
        raise DefinitionError(
            f"{site}: {name} is in the chart {inner.name}, but is called in a factor in the chart "
            f"{record.chart.name}; give both the same chart"
        )
    values = result.values.values() if isinstance(result, Outputs) else [result]
    arguments = tuple(Parameter(s.name, s.manifold, s.variable, node_of(v), s.frames) for s, v in given)
    results = tuple(node_of(v) for v in values if isinstance(v, Value))
    record.calls.append(Call(name, site, arguments, results, frames))


def signature(function: Callable[..., Any]) -> tuple[Signature, ...]:
    """Read parameters and their manifolds. Raises DefinitionError that names the argument and the cure."""
    site = site_of(function)
    name = function.__name__
    parameters = inspect.signature(function).parameters.values()
    try:
        hints = get_type_hints(function, include_extras=True)
    except NameError as error:
        unknown = str(error.name)
        argument = next((p.name for p in parameters if unknown in str(p.annotation)), "return")
        raise unknown_annotation(site, name, argument, unknown) from None
    except Exception as error:
        raise DefinitionError(f"{site}: {name}: an annotation cannot be read: {error}") from None
    found: list[Signature] = []
    for p in parameters:
        if p.kind in (p.VAR_POSITIONAL, p.VAR_KEYWORD):
            stars = "*" if p.kind is p.VAR_POSITIONAL else "**"
            raise DefinitionError(f"{site}: {name}: {stars}{p.name} is not possible; name every argument")
        what, positional = f"{site}: {name}: argument {p.name!r}", p.kind is not p.KEYWORD_ONLY
        annotation, stated = _annotated(hints.get(p.name))
        manifold = _manifold(annotation, what)
        found.append(
            Signature(p.name, manifold, positional, positional,
                      frames=declared(p.name, manifold, stated, what),
                      default=default_of(p.default, manifold, what, variable=positional))
        )  # fmt: skip
    if not any(s.variable for s in found):
        raise DefinitionError(f"{site}: {name} has no variables; put at least one argument before the *")
    return tuple(found)


def _annotated(annotation: Any) -> tuple[Any, Frames | None]:
    """The manifold and the frames of ``Annotated[SE3, frames("W", "B")]``."""
    if get_origin(annotation) is not Annotated:
        return annotation, None
    manifold, *extras = get_args(annotation)
    return manifold, next((e for e in extras if isinstance(e, Frames)), None)


def unknown_annotation(site: Site, factor: str, argument: str, annotation: str) -> DefinitionError:
    """The error for a name that does not exist."""
    home = "typing" if annotation == "Annotated" else "liegen"
    known = annotation in (*_KNOWN, "Annotated", "frames")
    meant = for_class(annotation)
    near = f"write {meant}, or use" if meant else "use"
    cure = f"import it: from {home} import {annotation}" if known else f"{near} {_MANIFOLDS}"
    return DefinitionError(
        f"{site}: {factor}: argument {argument!r} has the unknown annotation {annotation!r}; {cure}"
    )


def _manifold(annotation: Any, what: str) -> type[Manifold]:
    if annotation is None:
        raise DefinitionError(f"{what} has no annotation; write its manifold, as in x: SE3")
    kind: Any = annotation if isinstance(annotation, type) else type(None)
    if not (issubclass(kind, Manifold) and hasattr(kind, "form")):
        shown = getattr(annotation, "__name__", str(annotation))
        meant = for_class(shown)
        near = f"write {meant}, or use" if meant else "use"
        raise DefinitionError(f"{what} is annotated with {shown}, which is no manifold; {near} {_MANIFOLDS}")
    return kind


def site_of(function: Callable[..., Any]) -> Site:
    """Where a function is defined: file name and line of its ``def``."""
    code = function.__code__
    return Site(Path(code.co_filename).name, code.co_firstlineno)


def trace(
    function: Callable[..., Any],
    declared: tuple[Signature, ...],
    name: str,
    doc: str,
    *,
    factor: bool,
    frames: bool = True,
    chart: ChartLike | None = None,
) -> Graph:
    """Call ``function`` once on traced values, and put ``local``, ``retract`` and columns into ``chart``.

    Raises DefinitionError for everything that the function does wrong: a result that is no vector, a variable
    that no output depends on, whatever its operations refuse, and, with ``frames``, frames that do not fit.
    """
    site = site_of(function)
    parameters = tuple(
        Parameter(s.name, s.manifold, s.variable, parameter(s.manifold, s.name, site), s.frames,
                  default=s.default)
        for s in declared
        if s.bound is None
    )  # fmt: skip
    traced = {p.name: p.manifold.holding(node=p.node) for p in parameters}
    values = {s.name: s.bound if s.bound is not None else traced[s.name] for s in declared}
    with _recording(common_chart(chart, f"{site}: {name}")) as record:
        try:
            with no_exit():
                result = function(
                    *(values[s.name] for s in declared if s.positional),
                    **{s.name: values[s.name] for s in declared if not s.positional},
                )
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # a user's function may raise anything
            raise told(name, error) from None
    named = _outputs(result, f"{site}: {name}", factor=factor)
    graph = Graph(
        name, doc, site, parameters, named, tuple(record.domain), tuple(record.calls),
        singular=tuple(record.singular),
    )  # fmt: skip
    _all_used(graph)
    charted = in_charts(graph, chart)
    charts = Charts({p.name: p.chart for p in charted.parameters}, charted.chart)
    return replace(charted, frames=check_frames(graph, charts)) if frames else charted


@contextmanager
def _recording(chart: Preset) -> Any:
    record = _Record([], [], [], chart)
    token = _record.set(record)
    try:
        yield record
    finally:
        _record.reset(token)


def _outputs(result: Any, what: str, *, factor: bool) -> tuple[tuple[str, Node], ...]:
    if factor:
        if not isinstance(result, Vector):
            raise DefinitionError(
                f"{what}: a @factor returns one vector, got {_kind(result)}; "
                "return x.local(y) for a group element, or use @function with return outputs(...)"
            )
        return (("res", node_of(result)),)
    if isinstance(result, Manifold):
        return (("out", node_of(result)),)
    if not isinstance(result, Outputs) or not result.values:
        raise DefinitionError(
            f"{what}: a @function returns a typed value or outputs(...), got {_kind(result)}"
        )
    return tuple((name, node_of(value)) for name, value in result.values.items())


_KINDS: Mapping[type, str] = {
    type(None): "nothing (is the return missing?)",
    MethodType: "a method (are its parentheses missing?)",
    list: "a list; write return stack(...) of its entries",
    tuple: "a tuple; write return stack(...) of its entries",
}


def _kind(result: Any) -> str:
    return _KINDS.get(result.__class__, f"a {result.__class__.__name__}")


def _all_used(graph: Graph) -> None:
    reached = {id(n) for n in topological([node for _, node in graph.outputs])}
    for p in graph.parameters:
        if p.variable and id(p.node) not in reached:
            raise DefinitionError(
                f"{graph.site}: {graph.name}: variable {p.name!r} is never used by the result; "
                "use it, or remove it, or put it after the * if it is only given"
            )
    for name, node in graph.outputs:
        if not any(
            isinstance(n.operation, Leaf) and n.operation.name == "parameter" for n in topological([node])
        ):
            raise DefinitionError(f"{graph.site}: {graph.name}: output {name!r} depends on no argument")
