"""Frames of products: an operation on products is that operation on each of their parts."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from liegen.manifolds import Manifold, Node, Product, Value
from liegen.manifolds.node import node_of

from .frame_declared import Declared, is_map, map_kind, needed, parts, placed_frames
from .frame_terms import Frame, Framed, Known, Sought, made_of, mapping, sought, vector
from .graph import Parameter


def framed(parameter: Parameter, others: Iterable[Parameter]) -> Framed:
    """The frames of a parameter before anything is known but declarations."""
    p = parameter
    all_names = p.frames.names if p.frames else ()
    own: dict[str, Frame] = {
        name: Sought(f"{name} of {p.name}", others=tuple(n for n in all_names if n != name))
        for name in own_frames(p, others)
    }
    return _value(p.name, p.manifold, p.frames, lambda name: own.get(name) or Known(name))


def own_frames(parameter: Parameter, others: Iterable[Parameter]) -> tuple[str, ...]:
    """Frames of a product that are not those of the same name of other arguments.

    Where two arguments of one class both keep the name of a frame that each of them places, each has its
    own: their Bs are at two times.
    """
    p = parameter
    if not issubclass(p.manifold, Product) or p.frames is None:
        return ()
    kept = [o.frames.names for o in others if o is not p and o.manifold is p.manifold and o.frames]
    return tuple(
        name
        for name in placed_frames(p.manifold)
        if name in p.frames.names and any(name in names for names in kept)
    )


def _value(
    path: str, manifold: type[Manifold], declared: Declared | None, frame: Callable[[str], Frame]
) -> Framed:
    if issubclass(manifold, Product):
        listed = list(parts(manifold, declared))
        values = [_value(f"{path}.{name}", kind, d, frame) for name, kind, d in listed]
        return made_of(values, [kind.form.dim for _, kind, _ in listed])
    if declared is not None:
        frames = [frame(name) for name in declared.names]
        if is_map(manifold):
            return mapping(frames[0], frames[1] if len(frames) > 1 else Sought(), map_kind(manifold))
        return vector(frames[0], declared.kind)
    if is_map(manifold):
        return mapping(Sought(), Sought(f"the body frame of {path}"), map_kind(manifold))
    return sought(f"the frame of {path}" if needed(manifold) else "")


def unknown(manifold: type[Value]) -> Framed:
    """A value, and its parts, of which nothing is declared."""
    if issubclass(manifold, Product):
        kinds = manifold.part_classes.values()
        return made_of([unknown(kind) for kind in kinds], [kind.form.dim for kind in kinds])
    return mapping(Sought(), Sought(), map_kind(manifold)) if is_map(manifold) else sought()


#: Operations of products that are the same operation on each part.
_BY_PART = ("compose", "inverse", "between", "local", "retract", "exp", "log")


def by_part(node: Node) -> tuple[Node, ...]:
    """What a node on products computes of each part; nothing where it is no such operation."""
    manifolds = [node.manifold, *(n.manifold for n in node.operands)]
    cls = next((m for m in manifolds if issubclass(m, Product)), None)
    name = node.operation.name
    if cls is None or name not in _BY_PART:
        return ()
    columns = zip(*(_split(cls, n.manifold.holding(node=n)) for n in node.operands), strict=True)
    kinds: list[Any] = list(cls.part_classes.values())
    results: list[Any] = [
        kind.exp(first) if name == "exp" else getattr(first, name)(*rest)
        for kind, (first, *rest) in zip(kinds, columns, strict=True)
    ]
    return tuple(replace(node_of(r), site=node.site) for r in results)


def _split(cls: type[Product], value: Any) -> list[Any]:
    """The parts of a product, or the pieces of its tangent."""
    if isinstance(value, Product):
        return [getattr(value, name) for name in cls.part_classes]
    return [value[s] for s in cls.form.moved]
