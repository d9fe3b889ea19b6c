"""``Function``: what a decorated Python function becomes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, ParamSpec, TypeVar

import numpy as np

from liegen.arguments import bound, callable_of, check_batches, coerced, known, name_of, text_of
from liegen.errors import DefinitionError
from liegen.layouts import OWN, storage
from liegen.manifolds import Value
from liegen.manifolds.node import here
from liegen.names import check_definition
from liegen.noise import Weighting, weighted_graph
from liegen.noise import weighting as read_weighting
from liegen.trace import (
    ChartLike,
    FrameReport,
    Graph,
    LayoutLike,
    Outputs,
    Signature,
    constant,
    in_layouts,
    inlined,
    trace,
)

if TYPE_CHECKING:
    from liegen.kernel import Kernel
    from liegen.program import Program

P = ParamSpec("P")
T = TypeVar("T")
#: Draws the arguments of one sample: (draw, case) -> {argument: value}; see liegen.samples.
Sampler = Callable[..., Mapping[str, Value]]


@dataclass(frozen=True, eq=False)
class Function(Generic[P, T]):
    """A formula on Lie groups: callable on typed values, on arrays, and inside other formulas.

    ``plain`` is what was traced; ``graph`` the same with the noise and loss of ``weighting``, if any;
    ``kernel`` what was derived (at its first use). ``in_place``: in C an output may be written over an
    argument.
    """

    function: Callable[..., Any]
    declared: tuple[Signature, ...]
    name: str
    doc: str
    is_factor: bool
    sampler: Sampler | None = None
    checked: bool = True  # whether frames are
    chart: ChartLike | None = None  # None: not stated, GTSAM's
    in_place: bool = False
    weighting: Weighting | None = None
    layout: LayoutLike | None = None  # None: not stated, liegen's own
    normalise: bool = False
    plain: Graph = field(init=False, repr=False)
    graph: Graph = field(init=False, repr=False)

    def __post_init__(self) -> None:
        graph = trace(
            self.function, self.declared, self.name, self.doc,
            factor=self.is_factor, frames=self.checked, chart=self.chart,
        )  # fmt: skip
        graph = in_layouts(graph, self.layout, normalise=self.normalise)
        object.__setattr__(self, "plain", graph)
        arguments, variables = ([p.name for p in ps] for ps in (graph.parameters, graph.variables))
        outputs = [name for name, _ in graph.outputs]
        check_definition(self.name, str(graph.site), arguments, variables, outputs, factor=self.is_factor)
        if self.weighting:
            object.__setattr__(self, "weighting", self.weighting.beside(arguments))
        weighted = weighted_graph(graph, self.weighting) if self.weighting else graph
        object.__setattr__(self, "graph", weighted)

    @cached_property
    def kernel(self) -> Kernel:
        """The derived factor."""
        from liegen.derive import derive

        return derive(self.plain, self.weighting, in_place=self.in_place)

    @cached_property
    def gauss_newton_kernel(self) -> Kernel:
        """The derived Gauss-Newton terms. Raises DefinitionError for a ``@function``."""
        from liegen.gauss_newton import gauss_newton_kernel

        if not self.is_factor:
            what = "is a @function, without a residual; Gauss-Newton terms are of a @factor"
            raise DefinitionError(f"{self.plain.site}: {self.name} {what}")
        return gauss_newton_kernel(self.kernel, self.plain, self.weighting)

    @property
    def frames(self) -> FrameReport:
        """The frames of arguments, residual (and noise) and Jacobian columns; empty with ``frames=False``."""
        return self.graph.frames

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> T:
        """Inline into the formula that is being traced, or evaluate on numbers.

        Numbers are typed values or arrays of shape (..., n), in the factor's layout; the result is typed.
        Raises DefinitionError for missing, unknown or mismatched arguments.
        """
        values = self._bound(args, kwargs)
        if any(v.traced for v in values.values()):
            if self.weighting:
                raise DefinitionError(
                    f"{here()}: {self.name} has noise or a loss, which are applied to a finished residual; "
                    "call the factor without them here, and give noise= and loss= to the outer factor"
                )
            complete = {s.name: s.bound if s.bound is not None else values[s.name] for s in self.declared}
            named = {s.name: complete[s.name] for s in self.declared if not s.positional}
            result: Any = self.function(*(complete[s.name] for s in self.declared if s.positional), **named)
            given = [(s, complete[s.name]) for s in self.declared]
            inlined(self.name, here(), given, result, frames=self.checked, chart=self.chart)
            return result
        results = self.kernel.value.evaluate(self._stored(values))
        typed = {
            name: node.manifold.holding(storage(node.manifold.form, self.graph.layout).read(results[name]))
            for name, node in self.graph.outputs
        }
        single: Any = next(iter(typed.values())) if len(typed) == 1 else Outputs(typed)  # type: ignore[arg-type]
        return single

    def jacobians(self, *args: P.args, **kwargs: P.kwargs) -> dict[str, np.ndarray[Any, Any]]:
        """The outputs and all Jacobians on numbers, by name: ``res`` (..., m), ``res_D_x`` (..., m, k)."""
        return self._evaluated(self.kernel.jacobians, args, kwargs)

    def gauss_newton(self, *args: P.args, **kwargs: P.kwargs) -> dict[str, np.ndarray[Any, Any]]:
        """Gauss-Newton terms on numbers, by name, whitened and weighed as the factor is.

        ``cost`` (..., 1), half the squared norm of the residual or half of rho; ``g_x`` (..., k), the
        gradient of the cost; ``H_x_y`` (..., k, l) for each pair of variables in their order, J_x^T J_y.
        """
        return self._evaluated(self.gauss_newton_kernel.value, args, kwargs)

    def _evaluated(
        self, program: Program, args: tuple[Any, ...], kwargs: Mapping[str, Any]
    ) -> dict[str, np.ndarray[Any, Any]]:
        results = program.evaluate(self._stored(self._bound(args, kwargs)))
        arrays: dict[str, np.ndarray[Any, Any]] = {}
        for port in program.outputs:
            entries = np.stack(np.broadcast_arrays(*results[port.name]), axis=-1).astype(np.float64)
            arrays[port.name] = entries.reshape(*entries.shape[:-1], *port.shape)
        return arrays

    def _repr_latex_(self) -> str:
        """The formula and its Jacobians, as notebooks show them."""
        from liegen.derive import function_latex

        return f"$$\n{function_latex(self.plain, self.weighting)}\n$$"

    def _bound(self, args: tuple[Any, ...], kwargs: Mapping[str, Any]) -> dict[str, Value]:
        call = f"{here()}: {self.name}"
        given = bound(call, self._free, args, kwargs)
        values = {s.name: self._coerced(s, given[s.name]) for s in self._free}
        check_batches(call, values)
        return values

    def _stored(self, values: Mapping[str, Value]) -> dict[str, Any]:
        """What the kernel reads, in the layout of each argument."""
        layouts = {p.name: p.storage for p in self.graph.parameters}
        return {name: layouts[name].write(v.coords) for name, v in values.items()}

    @property
    def _free(self) -> list[Signature]:
        """What a call gives: the unbound parameters, and what noise and loss add."""
        added = self.graph.parameters[len(self.plain.parameters) :]
        weights = [Signature(p.name, p.manifold, False, False) for p in added]
        return [s for s in self.declared if s.bound is None] + weights

    def _shape(self, name: str) -> tuple[int, ...]:
        """The array of an argument."""
        m = self.plain.outputs[0][1].manifold.form.dim
        weights = self.weighting.weights(m) if self.weighting else ()
        own = {p.name: p.storage.shape for p in self.plain.parameters}
        return next((w.shape for w in weights if w.name == name), own.get(name, ()))

    def _coerced(self, s: Signature, value: Any) -> Value:
        layout = next((p.layout for p in self.plain.parameters if p.name == s.name), OWN)
        stored = storage(s.manifold.form, layout)
        what = f"{here()}: {self.name}: argument {s.name!r}"
        return coerced(what, s.manifold, stored, self._shape(s.name) or stored.shape or (stored.size,), value)

    def vary(
        self, *names: str, name: str = "", doc: str = "", sample: Sampler | None = None
    ) -> Function[..., T]:
        """The same formula with the arguments ``names`` as variables, which have no defaults."""
        return self._changed(names, name, doc, sample, variable=True)

    def fix(
        self, *names: str, name: str = "", doc: str = "", sample: Sampler | None = None
    ) -> Function[..., T]:
        """The same formula with the arguments ``names`` given instead of variable."""
        return self._changed(names, name, doc, sample, variable=False)

    def bind(
        self, *, name: str = "", doc: str = "", sample: Sampler | None = None, **values: Any
    ) -> Function[..., T]:
        """The same formula with constants for some arguments."""
        self._known(values)
        bound = {s.name: self._coerced(s, values[s.name]) for s in self.declared if s.name in values}
        for argument, value in bound.items():
            constant(value, f"{here()}: {self.name}: argument {argument!r}")
        declared = tuple(replace(s, bound=bound.get(s.name, s.bound)) for s in self.declared)
        return self._copy(declared, name, doc, sample)

    def whitened(
        self,
        noise: str | None = None,
        loss: str | None = None,
        mode: str | None = None,
        *,
        name: str = "",
        doc: str = "",
    ) -> Function[..., T]:
        """The same factor with whitened and robust outputs; see :func:`factor` for the arguments.

        Raises DefinitionError for a ``@function``, and for names that do not exist.
        """
        if not self.is_factor:
            raise DefinitionError(
                f"{self.plain.site}: {self.name} is a @function; noise and loss are of a @factor, "
                "which has a residual"
            )
        where = f"{self.plain.site}: {self.name}"
        return self._copy(self.declared, name, doc, None, read_weighting(noise, loss, mode, where))

    def _changed(
        self, names: tuple[str, ...], name: str, doc: str, sample: Sampler | None, *, variable: bool
    ) -> Function[..., T]:
        self._known(names)
        declared = tuple(
            replace(s, variable=variable, default=None if variable else s.default) if s.name in names else s
            for s in self.declared
        )
        if not any(s.variable and s.bound is None for s in declared):
            raise DefinitionError(f"{here()}: {self.name}: no variable is left")
        return self._copy(declared, name, doc, sample)

    def _copy(
        self,
        declared: tuple[Signature, ...],
        name: str,
        doc: str,
        sample: Sampler | None,
        weighting: Weighting | None = None,
    ) -> Function[..., T]:
        what = f"{here()}: {self.name}"
        return Function(
            self.function,
            declared,
            name_of(name, f"{what}: name=") or self.name,
            text_of(doc, f"{what}: doc=") or self.doc,
            self.is_factor,
            callable_of(sample, f"{what}: sample=") or self.sampler,
            self.checked,
            self._chart_of({s.name for s in declared if s.variable and s.bound is None}),
            self.in_place,
            weighting or self.weighting,
            self._layout_of({s.name for s in declared if s.bound is None}),
            self.normalise,
        )

    def _layout_of(self, arguments: set[str]) -> LayoutLike | None:
        """The stated layout without what is no argument any more."""
        if not isinstance(self.layout, Mapping):
            return self.layout
        return {name: layout for name, layout in self.layout.items() if name in arguments}

    def _chart_of(self, variables: set[str]) -> ChartLike | None:
        """The stated chart without what is no variable any more."""
        if not isinstance(self.chart, Mapping):
            return self.chart
        return {name: chart for name, chart in self.chart.items() if name in variables}

    def in_chart(self, chart: ChartLike | None) -> Function[P, T]:
        """The same formula in a chart, by name or as a ``liegen.Chart``; a chart that it states itself stays.

        Raises DefinitionError for a chart that does not exist.
        """
        return self if chart is None or self.chart is not None else replace(self, chart=chart)

    def in_layout(self, layout: LayoutLike | None, *, normalise: bool = False) -> Function[P, T]:
        """The same formula on other stored numbers, by name or as a ``liegen.Layout``; a stated one stays.

        ``normalise`` brings quaternions, (cos, sin) and directions of the arguments to unit length. Raises
        DefinitionError for a layout that does not exist.
        """
        stated = self.layout if layout is None or self.layout is not None else layout
        unit = self.normalise or normalise
        same = stated is self.layout and unit == self.normalise
        return self if same else replace(self, layout=stated, normalise=unit)

    def _known(self, names: Any) -> None:
        known(f"{here()}: {self.name}", names, [s.name for s in self.declared if s.bound is None])
