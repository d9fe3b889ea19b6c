"""``Step``: one operation whose frames are sought, and the errors about it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NoReturn

from liegen.manifolds import Node

from .frame_names import Kind
from .frame_terms import Frame, Framed, Solver

#: An operand and which of its frames: (0, "inner").
Place = tuple[int, str]
#: If both are the same frame, this text is the likely repair.
Repair = tuple[Place, Place, str]
HATCH = "rename what is named wrongly, or give frames=False to the decorator where names do not mean frames"
_CALLED = {"outer": "outer frame", "inner": "inner frame", "body": "body frame", "frame": "frame"}


@dataclass(frozen=True)
class Step:
    """One node whose frames are sought."""

    node: Node
    operands: tuple[Framed, ...]
    solver: Solver
    say: Callable[[], tuple[str, ...]]  # the operands' texts, ready to take a dot
    refuse: Callable[[str], NoReturn]
    #: (operand, what it is, the frame where it is needed) -> how to move it with what is declared
    route: Callable[[int, Kind, Frame], str | None]
    #: Whether the factor's frames fit where a text, a repair, stands for the node
    mends: Callable[[str], bool]

    @property
    def texts(self) -> tuple[str, ...]:
        """What the operands are called; asked only when something is wrong."""
        return self.say()

    def at(self, place: Place) -> Frame:
        """The frame of an operand."""
        x = self.operands[place[0]]
        return x.inner if place[1] in ("inner", "body") else x.outer

    def kind(self, k: int) -> Kind:
        """What stands in the frame; open unless declared names say it."""
        x = self.operands[k]
        return x.kind if self.solver.declared(x.outer) else Kind.OPEN

    def need(self, a: Place, b: Place, *repairs: Repair) -> None:
        """Raise DefinitionError unless both frames may be one."""
        if self.solver.equal(self.at(a), self.at(b)):
            return
        said = ", ".join(
            f"the {_CALLED[place[1]]} of {self.texts[place[0]]} is {self.solver.name(self.at(place))}"
            for place in (a, b)
        )
        likely = [t for p, q, t in repairs if self.solver.same(self.at(p), self.at(q))]
        write = next(filter(self.mends, likely), None)
        moved = None
        if write is None and b[1] == "frame":
            moved = self.route(b[0], self.kind(b[0]), self.at(a))
        self.refuse(f"{said}; {f'write {moved}' if moved else self.cure(write)}")

    def cure(self, repair: str | None) -> str:
        """What to write instead, where that mends the factor."""
        return f"write {repair.format(*self.texts)}" if repair and self.mends(repair) else HATCH
