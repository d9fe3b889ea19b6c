"""``Product``: classes of named parts, ``class State(Product): pose: SE3; vel: R3; bias: R6``."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self, dataclass_transform, get_args, get_origin

import numpy as np

from liegen.algebra.linear import Vector as Coordinates
from liegen.algebra.linear import eye, transpose
from liegen.errors import DefinitionError

from .form import Blocks, Coords
from .given import LARGEST
from .group import Group, Manifold, as_tangent
from .node import Operation, Value, apply, called, from_numbers, here
from .part import part
from .product_form import ProductForm, joined, product_form
from .vector import Vector, VectorLike, as_vector


@dataclass_transform(frozen_default=True)
class Product(Group):
    """A value of named parts, each an attribute.

    Stored are the parts in the order of their annotations; the tangent is theirs in the same order, each in
    its own chart. Where all parts are groups the product is one (``@`` composes); otherwise the operations of
    groups raise DefinitionError, ``retract`` and ``local`` remain. Parts may be products; a subclass adds
    parts.
    """

    __slots__ = ()
    form: ClassVar[Any]  # pyright: ignore[reportIncompatibleVariableOverride]
    part_classes: ClassVar[Mapping[str, type[Manifold]]] = {}
    #: What ``Annotated`` says of a part beside its class.
    part_notes: ClassVar[Mapping[str, tuple[Any, ...]]] = {}

    def __init_subclass__(cls, **kwargs: Any) -> None:
        if kwargs:
            raise DefinitionError(
                f"{here()}: {cls.__name__}: a product takes no {', '.join(kwargs)}=; annotate its parts, "
                "as in class State(Product): pose: SE3"
            )
        super().__init_subclass__()
        frame = sys._getframe(1)  # pyright: ignore[reportPrivateUsage]
        annotations = _annotations(cls, frame.f_globals, frame.f_locals)
        for name in annotations:
            if name in vars(cls):
                raise DefinitionError(
                    f"{here()}: {cls.__name__}: part {name!r} has a default, which parts cannot have; "
                    f"write {name}: {_spelled(annotations[name])} alone"
                )
        own = {name: _part_class(cls, name, _bare(kind)) for name, kind in annotations.items()}
        notes = {name: get_args(kind)[1:] for name, kind in annotations.items() if _bare(kind) is not kind}
        cls.part_classes = {**cls.part_classes, **own}
        cls.part_notes = {**cls.part_notes, **notes}
        if not cls.part_classes:
            raise DefinitionError(
                f"{here()}: {cls.__name__} has no parts; annotate them, as in class State(Product): pose: SE3"
            )
        form = product_form(
            cls.__name__, list(cls.part_classes), [kind.form for kind in cls.part_classes.values()]
        )
        if form.size > LARGEST:
            raise DefinitionError(
                f"{here()}: {cls.__name__} stores {form.size} numbers, the limit is {LARGEST}; make several "
                "arguments of it, or a batch"
            )
        cls.form = form
        for k, name in enumerate(cls.part_classes):
            setattr(cls, name, property(partial(_read, k), doc=f"The part {name}."))

    if not TYPE_CHECKING:  # type checkers take the signature from the annotations

        def __new__(cls, *first: Manifold | VectorLike, **named: Manifold | VectorLike) -> Self:
            """From all parts, in their order or by name.

            Raises DefinitionError for missing, unknown and mismatched ones.
            """
            names = list(cls.part_classes)
            parts = {**dict(zip(names, first, strict=False)), **named}
            whole = len(parts) == len(first) + len(named)  # none too many, none twice
            if not whole or parts.keys() != cls.part_classes.keys():
                usage = ", ".join(f"{name}=..." for name in names)
                raise DefinitionError(
                    f"{here()}: {cls.__name__}: say all its parts: {cls.__name__}({usage}), "
                    f"or in this order {cls.__name__}({', '.join(names)})"
                )
            values = [_coerced(cls, name, parts[name]) for name in names]
            show = ", ".join(f"{name}={{{k}}}" for k, name in enumerate(names))
            operation = Operation("product", cls, _join, _columns(cls.form), f"{cls.__name__}({show})")
            return apply(operation, cls, *values)

    def retract(self, d: VectorLike) -> Self:
        """Every part moved by its own piece of ``d``."""
        form: ProductForm = self.form
        if form.retract_blocks() is not None:
            return super().retract(d)
        v = as_tangent(d, form, f"{form.name}.retract")
        parts = {name: _read(k, self).retract(v[s]) for k, (name, s) in enumerate(_moved(form))}
        made: Any = type(self)
        return made(**parts)

    def __matmul__(self, other: Self) -> Self:
        return self.compose(other)


def _moved(form: ProductForm) -> list[tuple[str, slice]]:
    return list(zip(form.names, form.moved, strict=True))


def _read(k: int, x: Product) -> Manifold:
    """The part with index k; it moves with its own columns of the tangent."""
    form: ProductForm = x.form
    name, kind = list(x.part_classes.items())[k]
    rows, moved = eye(form.dim)[form.moved[k]], tuple(range(form.dim)[form.moved[k]])
    return part(x, name, kind, form.stored[k], lambda _r, _x: ((rows,),), "part", (k, moved))


def _join(*parts: Coords) -> Coordinates:
    return joined(parts)


def _columns(form: ProductForm) -> Callable[..., Blocks]:
    """Each part has its own columns of the identity."""
    columns = transpose(eye(form.dim))
    by_part: Blocks = tuple((transpose(columns[s]),) for s in form.moved)

    def blocks(*_: Coords) -> Blocks:
        return by_part

    return blocks


def _coerced(cls: type[Product], name: str, given: Any) -> Value:
    kind = cls.part_classes[name]
    where = f"{cls.__name__}({name}=...)"
    if issubclass(kind, Vector):
        return as_vector(given, kind.form.dim, where)
    if type(given) in (np.ndarray, list, tuple):
        return from_numbers(kind, given, f"{here()}: {where} needs {kind.__name__}")
    if not isinstance(given, Value) or given.form != kind.form:
        shown = called(given) if isinstance(given, Value) else type(given).__name__
        raise DefinitionError(f"{here()}: {where} needs {kind.__name__}, got {shown}")
    return given


def _spelled(annotation: Any) -> str:
    return annotation.__name__ if isinstance(annotation, type) else str(annotation)


def _annotations(cls: type, names: dict[str, Any], local: Any) -> dict[str, Any]:
    """The annotations that the class adds, evaluated where it is written."""
    try:
        found = inspect.get_annotations(cls, globals=names, locals={**local}, eval_str=True)
    except NameError as error:
        raise DefinitionError(
            f"{here()}: {cls.__name__}: the annotation {error.name!r} is unknown; "
            "import it, or define it before"
        ) from None
    return {name: kind for name, kind in found.items() if get_origin(kind) is not ClassVar}


def _bare(kind: Any) -> Any:
    """The class in ``Annotated[SE3, ...]``."""
    return get_args(kind)[0] if get_origin(kind) is Annotated else kind


def _part_class(cls: type[Product], name: str, kind: Any) -> type[Manifold]:
    """The class of a part. Raises DefinitionError for one that is no manifold, or whose name is taken."""
    if name.startswith("_") or hasattr(Product, name):
        raise DefinitionError(
            f"{here()}: {cls.__name__}: a part cannot be called {name!r}, for every value has that already; "
            "give it another name"
        )
    found: Any = kind if isinstance(kind, type) else type(None)
    if not (issubclass(found, Manifold) and hasattr(found, "form")):
        shown: str = getattr(kind, "__name__", str(kind))
        raise DefinitionError(
            f"{here()}: {cls.__name__}: part {name!r} is annotated with {shown}, which is no manifold; "
            "use one of liegen's (R3, SE3, ...), a class of vectors, or another product"
        )
    return found
