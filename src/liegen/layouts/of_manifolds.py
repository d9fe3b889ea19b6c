"""``Storage``: a manifold in a layout, as maps between the stored scalars and the manifold's own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from liegen.algebra.linear import Vector
from liegen.manifolds import ManifoldForm
from liegen.manifolds.form import Coords, PoseForm, RotationForm
from liegen.manifolds.gal3_form import Gal3Form
from liegen.manifolds.product_form import ProductForm, slices
from liegen.manifolds.s2_form import S2Form
from liegen.manifolds.se23_form import SE23Form
from liegen.manifolds.turning import Turned, known_matrix

from .layout import Layout, Stored
from .rotations import Numbers, numbers, unit

Map = Callable[[Coords], Vector]


@dataclass(frozen=True)
class Storage:
    """``read`` makes a manifold's own scalars of the stored ones, ``write`` the stored ones of those.

    ``names`` and ``shape`` are those of the stored scalars, ``text`` says what they are; empty for the
    manifold's own. ``quaternions``: where each begins. ``units``: slices of the manifold's own scalars that
    should have unit length and need not have it as they are read; ``lengths``: the places of the stored
    scalars that say so, of a quaternion, a (cos, sin), a direction, or a rotation matrix.
    """

    names: tuple[str, ...]
    read: Map
    write: Map
    text: str = ""
    shape: tuple[int, ...] = ()
    quaternions: tuple[int, ...] = ()
    units: tuple[slice, ...] = ()
    lengths: tuple[tuple[int, ...], ...] = ()

    @property
    def size(self) -> int:
        """Number of stored scalars."""
        return len(self.names)

    @property
    def own(self) -> bool:
        """Whether the stored scalars are the manifold's own."""
        return not self.text

    def taken(self, stored: Coords, *, normalise: bool) -> Vector:
        """The manifold's own scalars of the stored ones, ``units`` with length 1 where asked for."""
        own = self.read(stored)
        if not normalise:
            return own
        scalars = list(own)
        for place in self.units:
            scalars[place] = unit(scalars[place])
        return tuple(scalars)


def storage(form: ManifoldForm, stored: Stored) -> Storage:
    """A manifold in a layout; manifolds without rotations are stored as ever."""
    if isinstance(form, ProductForm):
        return _product(form, stored)
    units = _units(form)
    lengths = tuple(tuple(range(u.start, u.stop)) for u in units)
    plain = Storage(form.storage, tuple, tuple, "", form.shape, form.quaternions, units, lengths)
    rotation = _rotation_of(form)
    if rotation is None:
        return plain
    layout = stored.layout(form)
    if isinstance(form, PoseForm) and layout.pose != "parts":
        rows = _homogeneous(form, numbers(rotation, Layout("matrix", "matrix")), layout.pose == "4x4")
        return _by_columns(rows) if layout.order == "column" else rows
    own = numbers(rotation, layout)
    found = _parts(form, rotation, own, rotation_first=layout.first == "rotation" or not _movable(form))
    if own.matrix and layout.order == "row" and isinstance(form, RotationForm):
        return replace(found, shape=(form.space, form.space))
    return plain if found.names == plain.names else found


def _rotation_of(form: ManifoldForm) -> RotationForm | None:
    """The rotations that come first in a manifold's own scalars."""
    if isinstance(form, RotationForm):
        return form
    return form.rotation if isinstance(form, PoseForm | SE23Form | Gal3Form) else None


def _movable(form: ManifoldForm) -> bool:
    """Whether the order of the parts is a choice: that of poses."""
    return isinstance(form, PoseForm)


def _units(form: ManifoldForm) -> tuple[slice, ...]:
    rotation = _rotation_of(form)
    if rotation is not None:
        return (slice(0, rotation.size),)
    return (slice(0, 3),) if isinstance(form, S2Form) else ()


def _parts(form: ManifoldForm, rotation: RotationForm, own: Numbers, *, rotation_first: bool) -> Storage:
    n, m = len(own.names), rotation.size
    rest = form.storage[m:]
    k = len(rest)

    def read(x: Coords) -> Vector:
        q, t = (x[:n], x[n:]) if rotation_first else (x[k:], x[:k])
        return _with_rest(own.read(q), t)

    def write(x: Coords) -> Vector:
        q, t = own.write(x[:m]), tuple(x[m:])
        return (*q, *t) if rotation_first else (*t, *q)

    others = f"({', '.join(rest)})"
    texts = (own.text, others) if rotation_first else (others, own.text)
    return Storage(
        (*own.names, *rest) if rotation_first else (*rest, *own.names),
        read,
        write,
        ", then ".join(texts) if k else own.text,
        (n + k,),
        ((0 if rotation_first else k),) if own.quaternion else (),
        () if own.exact else (slice(0, m),),
        () if own.exact else (tuple(range(n)) if rotation_first else tuple(range(k, k + n)),),
    )


def _with_rest(q: Vector, rest: Coords) -> Vector:
    """Own scalars from those of the rotation and the others; a matrix that is known stays so."""
    known = known_matrix(q)
    return (*q, *rest) if known is None else Turned((*q, *rest), known)


def _homogeneous(form: PoseForm, own: Numbers, whole: bool) -> Storage:
    """[[R, t], [0, 1]] or [R, t], row by row."""
    n, m, t = form.space, form.rotation.size, form.storage[form.rotation.size :]
    names = tuple(x for i in range(n) for x in (*own.names[n * i : n * i + n], t[i]))
    width = n + 1
    bottom = tuple(f"b{j}" for j in range(width)) if whole else ()

    def read(x: Coords) -> Vector:
        R = tuple(e for i in range(n) for e in x[width * i : width * i + n])
        return _with_rest(own.read(R), [x[width * i + n] for i in range(n)])

    def write(x: Coords) -> Vector:
        R, moved = own.write(x[:m]), x[m:]
        rows = tuple(e for i in range(n) for e in (*R[n * i : n * i + n], moved[i]))
        return (*rows, *(0,) * n, 1) if whole else rows

    height = width if whole else n
    text = f"{height}x{width} matrix " + ("[[R, t], [0, 1]]" if whole else "[R, t]")
    turning = tuple(width * i + j for i in range(n) for j in range(n))
    return Storage((*names, *bottom), read, write, text, (height, width), (), (slice(0, m),), (turning,))


def _by_columns(found: Storage) -> Storage:
    """The same matrix column by column, as a flat array."""
    rows, columns = found.shape
    order = [columns * i + j for j in range(columns) for i in range(rows)]
    back = [order.index(k) for k in range(len(order))]

    def read(x: Coords) -> Vector:
        return found.read([x[k] for k in back])

    def write(x: Coords) -> Vector:
        stored = found.write(x)
        return tuple(stored[k] for k in order)

    return replace(
        found,
        names=tuple(found.names[k] for k in order),
        read=read,
        write=write,
        text=f"{found.text}, column by column",
        shape=(len(order),),
        lengths=tuple(tuple(back[k] for k in places) for places in found.lengths),
    )


def _product(form: ProductForm, stored: Stored) -> Storage:
    """Part by part, one after the other."""
    parts = [storage(part, stored) for part in form.parts]
    places = slices([part.size for part in parts])
    units = [
        slice(own.start + u.start, own.start + u.stop)
        for part, own in zip(parts, form.stored, strict=True)
        for u in part.units
    ]
    changed = [f"{n} as {part.text}" for n, part in zip(form.names, parts, strict=True) if not part.own]
    return Storage(
        tuple(f"{n}_{s}" for n, part in zip(form.names, parts, strict=True) for s in part.names),
        lambda x: _joined([part.read(x[place]) for part, place in zip(parts, places, strict=True)]),
        lambda x: _joined([part.write(x[own]) for part, own in zip(parts, form.stored, strict=True)]),
        ", ".join(changed),
        (sum(part.size for part in parts),),
        tuple(p.start + q for part, p in zip(parts, places, strict=True) for q in part.quaternions),
        tuple(units),
        tuple(
            tuple(p.start + k for k in length)
            for part, p in zip(parts, places, strict=True)
            for length in part.lengths
        ),
    )


def _joined(parts: Sequence[Vector]) -> Vector:
    return tuple(x for part in parts for x in part)
