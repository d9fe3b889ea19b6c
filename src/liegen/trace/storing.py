"""A graph in other layouts: what arguments and outputs are stored as, nothing else changes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from liegen.errors import DefinitionError
from liegen.layouts import OWN, Layout, Stored, storage, stored
from liegen.manifolds import ManifoldForm

from .graph import Graph

#: A layout for everything, by name or as a value, or layouts by argument.
LayoutLike = str | Layout | Stored | Mapping[str, str | Layout | Stored]


def in_layouts(graph: Graph, layout: LayoutLike | None, *, normalise: bool = False) -> Graph:
    """The same factor with arguments and outputs in a layout.

    One layout is that of everything; a mapping gives layouts to single arguments, the rest stays liegen's
    own. ``normalise``: rotations and directions of the arguments are brought to unit length as they are
    read. Raises DefinitionError for a layout that does not exist, and in a mapping for what is no argument or
    has no rotation.
    """
    what = f"{graph.site}: {graph.name}"
    common = OWN if layout is None or isinstance(layout, Mapping) else stored(layout, what)
    single: Mapping[str, str | Layout | Stored] = layout if isinstance(layout, Mapping) else {}
    own = {name: stored(value, f"{what}: layout of {name!r}") for name, value in single.items()}
    forms = {p.name: p.manifold.form for p in graph.parameters}
    for name in own:
        _refuse_other(name, forms, what)
    parameters = tuple(replace(p, layout=own.get(p.name, common)) for p in graph.parameters)
    return replace(graph, parameters=parameters, layout=common, normalise=normalise)


def _refuse_other(name: str, forms: Mapping[str, ManifoldForm], what: str) -> None:
    if name not in forms:
        raise DefinitionError(
            f"{what}: layout={{{name!r}: ...}} names no argument; there are {', '.join(forms)}"
        )
    if storage(forms[name], _OTHER).own:
        raise DefinitionError(
            f"{what}: {name!r} is {forms[name].name}, which is stored in one way only; layouts exist for "
            "rotations, poses, extended poses and products of them"
        )


#: In this layout everything that has a rotation is stored differently.
_OTHER = stored(Layout("matrix", "matrix"), "")
