"""``Choices``: a frozen dataclass whose fields are each one of a few literals."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import get_args, get_type_hints

from liegen.errors import DefinitionError
from liegen.manifolds.node import here


@dataclass(frozen=True)
class Choices:
    """Refuses, with those that exist, a choice that is none. Raises DefinitionError."""

    def __post_init__(self) -> None:
        hints, kind = get_type_hints(type(self)), type(self).__name__
        for choice in fields(self):
            value, possible = getattr(self, choice.name), get_args(hints[choice.name])
            if not isinstance(value, str | bool | int) or value not in possible:
                raise DefinitionError(
                    f"{here()}: {kind}({choice.name}={value!r}): {choice.name} is one of "
                    f"{', '.join(map(repr, possible))}"
                )

    @property
    def description(self) -> str:
        """The choices as keyword arguments; default ones are left out."""
        stated = {f.name: getattr(self, f.name) for f in fields(self) if getattr(self, f.name) != f.default}
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in stated.items())})"
