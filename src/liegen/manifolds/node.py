"""Typed values and the operations on them.

A value holds either scalars of some backend (then an operation computes at once) or a node of the graph of
a factor that is being traced (then it adds a node). ``apply`` is the only place that knows the difference.
"""

from __future__ import annotations

import os
import sys
import sysconfig
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import FrameType, TracebackType
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn, Self, TypeVar

import numpy as np

from liegen.advice import for_missing, for_number
from liegen.algebra import Scalar
from liegen.algebra.linear import Vector as Coordinates
from liegen.errors import DefinitionError, NoAttributeError, Site

from .form import Compute, ManifoldForm, Rule
from .given import real_numbers

_PACKAGE = str(Path(__file__).resolve().parent.parent)
_LIBRARY = str(Path(_PACKAGE) / "library")
_NUMPY = str(Path(np.__file__).parent)
_OTHERS = tuple(str(Path("-packages") / name) + os.sep for name in ("sympy", "casadi", "mpmath", "scipy"))
_PYTHON = sysconfig.get_path("stdlib")
V = TypeVar("V", bound="Value")


@dataclass(frozen=True, eq=False)
class Operation:
    """One operation of the language.

    ``value(*coords)`` computes the result's coordinates on scalars of any backend.
    ``blocks(result, *coords)`` gives the tangent-space Jacobian by each operand; None stands for automatic
    differentiation through the storage. ``show`` is a format string for the operands. ``parameters`` are the
    constants that it carries. ``near_zero(size)`` are the blocks where the operand is a difference that is
    known to the rounding of numbers of that size only; None where that makes no difference.
    """

    name: str
    result: type[Value]
    value: Compute
    blocks: Rule | None
    show: str
    parameters: tuple[Any, ...] = ()
    near_zero: Callable[[Scalar], Rule] | None = None


@dataclass(frozen=True, eq=False)
class Node:
    """An operation applied to operands at a line of the user's file."""

    operation: Operation
    operands: tuple[Node, ...]
    site: Site

    @property
    def manifold(self) -> type[Value]:
        """The class of the result."""
        return self.operation.result

    def on(self, operands: tuple[Node, ...]) -> Node:
        """The same operation on other operands; the node itself where they are the same ones."""
        same = all(a is b for a, b in zip(operands, self.operands, strict=True))
        return self if same else replace(self, operands=operands)


@dataclass(frozen=True, eq=False)
class Leaf(Operation):
    """A parameter (``coords`` is empty) or a constant of the graph."""

    coords: Coordinates = field(default=())


class Value:
    """A typed value: an element of a manifold, or a condition."""

    form: ClassVar[ManifoldForm]
    __slots__ = ("_coords", "_node")

    _coords: Coordinates
    _node: Node | None

    @classmethod
    def holding(cls, coords: Sequence[Scalar] = (), node: Node | None = None) -> Self:
        """A value of this class from its stored scalars, or standing for a node."""
        value = object.__new__(cls)
        object.__setattr__(value, "_coords", tuple(coords))
        object.__setattr__(value, "_node", node)
        return value

    @classmethod
    def from_storage(cls, array: object) -> Self:
        """From an array of shape (..., n) of stored numbers, in the order of ``form.storage``.

        A single number is a scalar. Raises DefinitionError when the last dimension is not n, and for what
        holds no real numbers.
        """
        return from_numbers(cls, array, cls.__name__)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(f"{type(self).__name__} values cannot be changed; make a new one")

    if not TYPE_CHECKING:  # type checkers know the attributes

        def __getattr__(self, name: str) -> NoReturn:
            """Raise NoAttributeError, which says what to write."""
            if name.startswith("_"):
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            cure = for_missing(type(self), name, formula(self), user_frame())
            raise NoAttributeError(f"{here()}: {called(self)} has no attribute {name!r}; {cure}")

    @property
    def traced(self) -> bool:
        """Whether this value stands for a node of a factor's graph."""
        return self._node is not None

    @property
    def coords(self) -> Coordinates:
        """The stored scalars. Raises DefinitionError on a traced value."""
        if self._node is not None:
            refuse(self, "read the numbers of {}")
        return self._coords

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> object:
        # an array; were it declared so, type checkers would take `M @ v` for NumPy's product
        if self._node is not None:
            refuse(self, "turn {} into a NumPy array")
        parts = np.broadcast_arrays(*self._coords)
        return np.stack(parts, axis=-1).astype(dtype or np.float64)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Any:
        reflected = {"add": "__radd__", "subtract": "__rsub__", "multiply": "__rmul__",
                     "divide": "__rtruediv__", "matmul": "__rmatmul__"}  # fmt: skip
        name = reflected.get(ufunc.__name__)
        if method == "__call__" and name and len(inputs) == 2 and inputs[1] is self and not kwargs:
            reflected_operator = getattr(type(self), name, None)
            result = reflected_operator(self, inputs[0]) if reflected_operator else NotImplemented
            if result is not NotImplemented:
                return result
        cure = for_number(type(self), formula(self), "read", user_frame(), ufunc.__name__)
        raise DefinitionError(f"{here()}: np.{ufunc.__name__} does not take {called(self)}; write {cure}")

    def __bool__(self) -> bool:
        if self._node is None and len(self._coords) == 1:
            return bool(self._coords[0])
        refuse(self, f"branch on {formula(self, 'a condition')} (if, and, or and not do)", "branch")

    def __float__(self) -> float:
        if self._node is None and len(self._coords) == 1:
            return float(self._coords[0])
        refuse(self, "turn {} into a float (float() and the functions of math do)")

    def __eq__(self, other: object) -> bool:
        if self._node is not None or (isinstance(other, Value) and other.traced):
            refuse(self, "compare {} with ==", "compare")
        same = type(self) is type(other) and isinstance(other, Value)
        return same and bool(np.array_equal(np.asarray(self), np.asarray(other)))

    __hash__: ClassVar[None]  # type: ignore[assignment]

    def __repr__(self) -> str:
        if self._node is not None:
            return f"<{type(self).__name__} of a traced factor>"
        numbers = ", ".join(f"{k}={v!s}" for k, v in zip(self.form.storage, self._coords, strict=True))
        return f"{type(self).__name__}({numbers})"


def from_numbers(cls: type[V], array: object, what: str) -> V:
    """A value from stored numbers (..., n). Raises DefinitionError, which begins with ``what``."""
    size = cls.form.size
    needed = f"{what}: an array of shape (..., {size}) is needed ({shown_storage(cls.form.storage)})"
    numbers = real_numbers(array, needed)
    if numbers.ndim == 0 and size == 1:
        numbers = numbers[None]
    if numbers.ndim == 0 or numbers.shape[-1] != size:
        cure = "; a batch of scalars is array[:, None]" if size == 1 else ""
        raise DefinitionError(f"{needed}, this one has shape {numbers.shape}{cure}")
    return cls.holding([numbers[..., k][()] for k in range(size)])


def shown_storage(names: Sequence[str]) -> str:
    """The names of stored scalars, at most twelve of them."""
    return ", ".join(names if len(names) <= 12 else [*names[:10], "...", names[-1]])


def refuse(value: Value, what: str, doing: str = "read") -> NoReturn:
    """Raise the error for Python code that needs the number of a traced value.

    ``doing`` is "branch" or "compare" where Python asks for the truth of a condition or of ``==``.
    """
    cure = for_number(type(value), formula(value), doing, user_frame())
    raise DefinitionError(
        f"{here()}: cannot {what.format(called(value))}: while a factor is traced it has no number; "
        f"write {cure}"
    )


def called(value: Value) -> str:
    """How a message speaks of a value: ``x (SE3)`` where its formula is short, else its manifold."""
    shown = formula(value, "")
    return f"{shown} ({value.form.name})" if shown else value.form.name


def formula(value: Value, otherwise: str = "x") -> str:
    """The formula of a value where it is short."""
    node = value._node  # pyright: ignore[reportPrivateUsage]
    if node is None or any(n.operands for n in node.operands):
        return otherwise
    return node.operation.show.format(*(n.operation.show for n in node.operands))


def _machinery(file: str) -> bool:
    """Whether a file is liegen's, Python's or of a library such as NumPy: not where a user's mistake is."""
    if any(folder in file for folder in _OTHERS):
        return True
    if file.startswith(_PYTHON):
        return "-packages" not in file
    return file.startswith((_PACKAGE, _NUMPY)) and not file.startswith(_LIBRARY)


def _generated(frame: FrameType) -> bool:
    """Whether it is a method that ``dataclasses`` wrote for a class of liegen."""
    module = str(frame.f_globals.get("__name__"))
    return frame.f_code.co_filename == "<string>" and module.startswith("liegen.")


def user_frame() -> FrameType:
    """The nearest frame outside liegen's machinery: the user's, or the library's."""
    frame = sys._getframe(1)  # pyright: ignore[reportPrivateUsage]
    while frame.f_back is not None and (_machinery(frame.f_code.co_filename) or _generated(frame)):
        frame = frame.f_back
    return frame


def here() -> Site:
    """The nearest line outside liegen's machinery: the user's, or the library's."""
    frame = user_frame()
    return Site(Path(frame.f_code.co_filename).name, frame.f_lineno)


def raised_at(error: BaseException) -> Site:
    """The last line outside liegen's machinery that an exception came through, else the nearest one here."""
    return raised_in_user_code(error) or here()


def raised_in_user_code(error: BaseException) -> Site | None:
    """The last line outside liegen's machinery that an exception came through, if any."""
    steps = user_steps(error)
    return site_at(steps[-1]) if steps else None


def user_steps(error: BaseException) -> list[TracebackType]:
    """The steps of an exception's way outside of liegen's machinery, the innermost last."""
    steps: list[TracebackType] = []
    step = error.__traceback__
    while step is not None:
        if not _machinery(step.tb_frame.f_code.co_filename) and not _generated(step.tb_frame):
            steps.append(step)
        step = step.tb_next
    return steps


def site_at(step: TracebackType) -> Site:
    """The line of a step."""
    return Site(Path(step.tb_frame.f_code.co_filename).name, step.tb_lineno)


def apply(operation: Operation, result: type[V], *operands: Value) -> V:
    """Compute ``operation`` on numbers, or add it to the graph when any operand is traced.

    Raises DefinitionError for batches that do not broadcast, and for a batch in a formula.
    """
    if any(v.traced for v in operands):
        return result.holding(node=Node(operation, tuple(node_of(v) for v in operands), here()))
    with np.errstate(all="ignore"):
        try:
            return result.holding(operation.value(*(v.coords for v in operands)))
        except ValueError:
            batches = [batch_of(v) for v in operands]
            if _broadcast(batches):
                raise
        got = " and ".join(map(str, batches))
        raise DefinitionError(f"{here()}: {operation.name}: leading dimensions do not broadcast: {got}")


def has_numbers(value: Value) -> bool:
    """Whether a value is on numbers: it stands for no node, and its scalars are those of no other backend."""
    return not value.traced and all(
        isinstance(c, float | int | np.ndarray | np.generic) for c in value.coords
    )


def batch_of(value: Value) -> tuple[int, ...]:
    """The leading dimensions of a value on numbers; () for a single element."""
    return np.broadcast_shapes(*(np.shape(c) for c in value.coords))


def _broadcast(shapes: Sequence[tuple[int, ...]]) -> bool:
    try:
        np.broadcast_shapes(*shapes)
    except ValueError:
        return False
    return True


def node_of(value: Value) -> Node:
    """The node that a value stands for; a constant becomes a leaf.

    Raises DefinitionError for a batch: a formula is of single elements.
    """
    node = value._node  # pyright: ignore[reportPrivateUsage]
    if node is not None:
        return node
    if batch_of(value):
        raise DefinitionError(
            f"{here()}: a constant of a formula is one {value.form.name}, this one is an array of shape "
            f"{np.asarray(value).shape}; make it an argument, and give the batch where the factor is called"
        )
    leaf = Leaf("constant", type(value), _no_value, None, _constant_text(value), coords=value.coords)
    return Node(leaf, (), Site("", 0))


def parameter(cls: type[Value], name: str, site: Site) -> Node:
    """The leaf of a factor's parameter."""
    return Node(Leaf("parameter", cls, _no_value, None, name), (), site)


def _no_value(*_: object) -> NoReturn:
    raise TypeError("a leaf has no operands to compute from")


def _constant_text(value: Value) -> str:
    numbers = [f"{float(c):.6g}" for c in np.ravel(np.asarray(value))]
    return numbers[0] if len(numbers) == 1 else f"{type(value).__name__}({', '.join(numbers)})"
