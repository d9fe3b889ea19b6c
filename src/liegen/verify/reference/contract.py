"""What the reference knows of a manifold and of a group."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from .logarithms import Branch
from .matrix import Element, Vector

#: Store an element; of two storages (q and -q) the one nearer to the second argument.
Store = Callable[[Element, Sequence[float] | None], Vector]


@dataclass(frozen=True)
class Space:
    """A manifold: elements from stored numbers and back, and the default chart."""

    dim: Callable[[Element], int]
    load: Callable[[Vector], Element]
    store: Store
    retract: Callable[[Element, Vector, Branch], Element]
    local: Callable[[Element, Element, Branch], Vector]


@dataclass(frozen=True)
class GroupSpace(Space):
    """A Lie group."""

    compose: Callable[[Element, Element], Element]
    inverse: Callable[[Element], Element]
    exp: Callable[[Vector], Element]
    log: Callable[[Element, Branch], Vector]
