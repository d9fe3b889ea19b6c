"""What a graph says of its group elements: which of them are products of others."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

from liegen.algebra.factors import Adjoint, Word
from liegen.algebra.linear import Vector, is_structural
from liegen.manifolds import Node
from liegen.manifolds.form import GroupForm, PoseForm, RotationForm

#: An element by its group (``R`` for the matrix of a rotation) and its scalars.
Key = tuple[object, ...]
#: A product of elements (1) and inverses (-1).
Product = tuple[tuple[Key, int], ...]
#: How to make a factor of each product that is an element of the graph.
Named = Mapping[Product, Callable[[], Any]]

#: The powers of the operands in the result.
_POWERS: Mapping[str, tuple[int, ...]] = {"compose": (1, 1), "inverse": (-1,), "between": (-1, 1)}


def key(group: str, coords: Vector) -> Key:
    """Equal where the scalars of CasADi are the same ones."""
    return (group, *(x if is_structural(x) else ("SX", x.element_hash()) for x in coords))


def shortened(product: Iterable[tuple[Key, int]]) -> Product:
    """Without neighbours that are inverse to each other."""
    found: list[tuple[Key, int]] = []
    for k, power in product:
        if found and found[-1] == (k, -power):
            found.pop()
        else:
            found.append((k, power))
    return tuple(found)


def powered(product: Product, power: int) -> Product:
    """The product (1), or its inverse (-1)."""
    return product if power > 0 else tuple((k, -p) for k, p in reversed(product))


@dataclass(frozen=True)
class Elements:
    """``products``: what an element is in those that are no products themselves."""

    products: Mapping[Key, Product]
    rotations: Named
    adjoints: Named

    def rotation(self, word: Word) -> Word:
        """The same rotation in as few letters as the graph has elements for."""
        return self._shortest([(key("R", x.coords), x.inverse, x) for x in word], self.rotations)

    def adjoint(self, word: Sequence[Adjoint]) -> tuple[Adjoint, ...]:
        """The same adjoint in as few factors as the graph has elements for."""
        return self._shortest([(key(x.group, x.coords), x.inverse, x) for x in word], self.adjoints)

    def written_out(self, product: Iterable[tuple[Key, int]]) -> Product:
        """In elements that are no products, and shortened."""
        return shortened(x for k, p in product for x in powered(self.products.get(k, ((k, 1),)), p))

    def _shortest(self, word: Sequence[tuple[Key, bool, Any]], named: Named) -> tuple[Any, ...]:
        letters = [((k, -1 if inverse else 1), factor) for k, inverse, factor in word]
        given: dict[Product, Any] = {(letter,): factor for letter, factor in letters}
        whole = self.written_out(letter for letter, _ in letters)
        pieces = _pieces(whole, {**named, **given})
        return tuple(given[p] if p in given else named[p]() for p in pieces)


def _pieces(whole: Product, known: Collection[Product]) -> tuple[Product, ...]:
    """The product cut into as few known ones as possible, the first cut as early as possible."""
    ending: dict[tuple[Key, int], list[Product]] = {letter: [] for letter in whole}
    for piece in sorted(filter(None, known), key=len, reverse=True):
        if piece[-1] in ending:
            ending[piece[-1]].append(piece)
    best: list[tuple[int, int]] = [
        (0, 0)
    ]  # for each end how many pieces there are, and where the last begins
    for end, letter in enumerate(whole, 1):
        starts = [end - len(p) for p in ending[letter] if whole[max(end - len(p), 0) : end] == p]
        best.append(min([(best[start][0] + 1, start) for start in starts]))
    cuts = [len(whole)]
    while cuts[-1]:
        cuts.append(best[cuts[-1]][1])
    cuts.reverse()
    return tuple([whole[a:b] for a, b in pairwise(cuts)])


def elements(nodes: Iterable[Node], scalars: Mapping[int, Vector]) -> Elements:
    """Of a graph's nodes, operands first; ``scalars`` by a node's identity."""
    found = Elements({}, {}, {})
    for node in nodes:
        form = node.manifold.form
        if not isinstance(form, GroupForm) or form.flat:
            continue
        powers = _POWERS.get(node.operation.name, ())
        coords = scalars[id(node)]
        terms = [scalars[id(n)] for n in node.operands[: len(powers)]]
        make = partial(_adjoint, form, coords)
        found = _with(found, form.name, coords, terms, powers, adjoint=make)
        turning = _turning(form)
        if turning is not None:
            rotation, part = turning
            letter = partial(_letter, rotation, part(coords))
            found = _with(found, "R", part(coords), list(map(part, terms)), powers, letter=letter)
    return found


def _turning(form: GroupForm) -> tuple[RotationForm, Callable[[Vector], Vector]] | None:
    """The rotations of a group, and which of its numbers they are."""
    if isinstance(form, PoseForm):
        return form.rotation, form.rotation_of
    return (form, tuple) if isinstance(form, RotationForm) else None


def _adjoint(form: GroupForm, coords: Vector, power: int) -> Any:
    (factor,) = form.Ad(coords) if power > 0 else form.Ad_inverse(coords)
    return factor


def _letter(form: RotationForm, coords: Vector, power: int) -> Any:
    return form.letter(coords, inverse=power < 0)


def _with(
    known: Elements,
    group: str,
    coords: Vector,
    terms: Sequence[Vector],
    powers: Sequence[int],
    *,
    adjoint: Callable[[int], Any] | None = None,
    letter: Callable[[int], Any] | None = None,
) -> Elements:
    """One element more; ``powers`` of ``terms`` are its factors, if it is a product."""
    own = key(group, coords)
    if terms and own not in known.products:
        factors = [(key(group, x), p) for x, p in zip(terms, powers, strict=True)]
        known = Elements({**known.products, own: known.written_out(factors)}, known.rotations, known.adjoints)
    whole = known.written_out([(own, 1)])
    return Elements(
        known.products,
        {**_made(whole, letter), **known.rotations},
        {**_made(whole, adjoint), **known.adjoints},
    )


def _made(whole: Product, make: Callable[[int], Any] | None) -> Named:
    return {} if make is None else {powered(whole, p): partial(make, p) for p in (1, -1)}
