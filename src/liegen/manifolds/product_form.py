"""Products of manifolds: closed forms part by part. A product of groups is a group."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import accumulate, pairwise
from typing import Any

from liegen.algebra.linear import Chain, Matrix, Vector, block_diagonal, eye, plain
from liegen.errors import DefinitionError

from .form import Blocks, Coords, GroupForm, ManifoldForm, Rule, Source


def slices(sizes: Sequence[int]) -> tuple[slice, ...]:
    """Consecutive slices of these lengths."""
    ends = list(accumulate(sizes, initial=0))
    return tuple(slice(a, b) for a, b in pairwise(ends))


def joined(parts: Sequence[Coords]) -> Vector:
    """The coordinates of all parts, one after the other."""
    return tuple(x for part in parts for x in part)


def diagonal_chain(chains: Sequence[Chain]) -> Chain:
    """Chains of the parts as one chain of block diagonal factors."""
    flat = [plain(chain) for chain in chains]
    n = max(map(len, flat))
    padded = [(*(eye(len(c[0])),) * (n - len(c)), *c) for c in flat]
    return tuple(block_diagonal(*factors) for factors in zip(*padded, strict=True))


def all_of(rules: Sequence[Rule | None]) -> list[Rule] | None:
    """The rules, if there is one of every part."""
    known = [rule for rule in rules if rule is not None]
    return known if len(known) == len(rules) else None


def _by_part(rules: Sequence[Any], *splits: Callable[[Coords], list[Coords]]) -> Rule:
    """A rule of result and two operands that takes every part by its own rule."""

    def blocks(result: Coords, a: Coords, b: Coords) -> Blocks:
        columns = zip(*(s(c) for s, c in zip(splits, (result, a, b), strict=True)), strict=True)
        found = [rule(*own) for rule, own in zip(rules, columns, strict=True)]
        return tuple(diagonal_chain(chains) for chains in zip(*found, strict=True))

    return blocks


class ProductForm(ManifoldForm):
    """Parts side by side, each stored and moved as it is on its own."""

    def __init__(self, name: str, names: Sequence[str], parts: Sequence[ManifoldForm]) -> None:
        self.name = name
        self.parts = tuple(parts)
        self.names = tuple(names)
        pairs = list(zip(names, parts, strict=True))
        self.storage = tuple(f"{n}_{s}" for n, form in pairs for s in form.storage)
        self.tangent = tuple(f"{n}_{t}" for n, form in pairs for t in form.tangent)
        self.stored = slices([form.size for form in parts])
        self.moved = slices([form.dim for form in parts])
        self.quaternions = tuple(
            s.start + q for s, form in zip(self.stored, parts, strict=True) for q in form.quaternions
        )
        self.flat = all(form.flat for form in parts)
        listed = ", ".join(f"{n} ({form.name})" for n, form in pairs)
        self.note = f"{name}: stored {listed}; tangent: in the same order, each part in its own chart"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ProductForm) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[object, ...]:
        return (self.name, self.names, self.parts)

    def __getattr__(self, name: str) -> Any:
        """Explain why an operation of groups does not exist."""
        if not hasattr(GroupForm, name):
            raise AttributeError(name)
        part, form = next(
            (n, f) for n, f in zip(self.names, self.parts, strict=True) if not isinstance(f, GroupForm)
        )
        raise DefinitionError(
            f"{self.name} is no group, because its part {part} ({form.name}) is none: it has no "
            f"{name.partition('_')[0]}; use retract and local, or the operations of its parts"
        )

    def split(self, x: Coords) -> list[Coords]:
        """The stored numbers of each part."""
        return [x[s] for s in self.stored]

    def split_tangent(self, d: Coords) -> list[Coords]:
        """The tangent coordinates of each part."""
        return [d[s] for s in self.moved]

    def retract(self, x: Coords, d: Coords) -> Vector:
        moves = zip(self.parts, self.split(x), self.split_tangent(d), strict=True)
        return joined([form.retract(p, e) for form, p, e in moves])

    def local(self, x: Coords, y: Coords) -> Vector:
        pairs = zip(self.parts, self.split(x), self.split(y), strict=True)
        return joined([form.local(p, q) for form, p, q in pairs])

    def lift(self, x: Coords) -> Matrix | None:
        lifts = [form.lift(p) for form, p in zip(self.parts, self.split(x), strict=True)]
        filled = [
            eye(form.size)[: form.dim] if form.flat else lift
            for form, lift in zip(self.parts, lifts, strict=True)
        ]
        known = [lift for lift in filled if lift is not None]
        curved = any(lift is not None for lift in lifts)
        return block_diagonal(*known) if curved and len(known) == len(filled) else None

    def retract_blocks(self) -> Rule | None:
        known = all_of([form.retract_blocks() for form in self.parts])
        return self.retract_rule(known) if known else None

    def local_blocks(self) -> Rule | None:
        known = all_of([form.local_blocks() for form in self.parts])
        return self.local_rule(known) if known else None

    def retract_rule(self, rules: Sequence[Rule]) -> Rule:
        """The rule of ``retract`` from those of the parts."""
        return _by_part(rules, self.split, self.split, self.split_tangent)

    def local_rule(self, rules: Sequence[Rule]) -> Rule:
        """The rule of ``local`` from those of the parts."""
        return _by_part(rules, self.split_tangent, self.split, self.split)

    def draw(self, source: Source, spread: float) -> Sequence[float]:
        return joined([form.draw(source, spread) for form in self.parts])

    def draw_tangent(self, source: Source, angle: float, offset: float | None) -> Sequence[float]:
        return joined([form.draw_tangent(source, angle, offset) for form in self.parts])


class GroupProductForm(ProductForm, GroupForm):
    """A product of groups."""

    def __init__(self, name: str, names: Sequence[str], parts: Sequence[GroupForm]) -> None:
        super().__init__(name, names, parts)
        self.groups = tuple(parts)
        self.turns = any(form.turns for form in parts)
        self.exponential = all(form.exponential for form in parts)

    def _each(self, name: str, *coords: list[Coords]) -> list[Any]:
        own = zip(*coords, strict=True)
        return [getattr(form, name)(*of_part) for form, of_part in zip(self.groups, own, strict=True)]

    def retract_blocks(self) -> Rule:
        return self.retract_rule([form.retract_blocks() for form in self.groups])

    def local_blocks(self) -> Rule:
        return self.local_rule([form.local_blocks() for form in self.groups])

    def identity(self) -> Vector:
        return joined([form.identity() for form in self.groups])

    def compose(self, a: Coords, b: Coords) -> Vector:
        return joined(self._each("compose", self.split(a), self.split(b)))

    def inverse(self, a: Coords) -> Vector:
        return joined(self._each("inverse", self.split(a)))

    def between(self, a: Coords, b: Coords) -> Vector:
        return joined(self._each("between", self.split(a), self.split(b)))

    def exp(self, d: Coords) -> Vector:
        return joined(self._each("exp", self.split_tangent(d)))

    def log(self, a: Coords) -> Vector:
        return joined(self._each("log", self.split(a)))

    def adjoint(self, a: Coords) -> Chain:
        return diagonal_chain(self._each("adjoint", self.split(a)))

    def adjoint_inverse(self, a: Coords) -> Chain:
        return diagonal_chain(self._each("adjoint_inverse", self.split(a)))

    def Jr(self, d: Coords) -> Matrix:
        return block_diagonal(*self._each("Jr", self.split_tangent(d)))

    def Jr_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        pairs = zip(self.groups, self.split_tangent(d), strict=True)
        return block_diagonal(*(form.Jr_inv(e, principal=principal) for form, e in pairs))

    def matrix(self, a: Coords) -> Matrix:
        """The matrices of the parts along the diagonal."""
        return block_diagonal(*self._each("matrix", self.split(a)))


def product_form(name: str, names: Sequence[str], parts: Sequence[ManifoldForm]) -> ProductForm:
    """The product; a group where all parts are groups."""
    groups = [form for form in parts if isinstance(form, GroupForm)]
    if len(groups) == len(parts):
        return GroupProductForm(name, names, groups)
    return ProductForm(name, names, parts)
