"""Every error a user can cause. Each message names the factor, the argument and the cure."""

from __future__ import annotations

import functools
import inspect
import warnings
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Site:
    """A line of the user's file."""

    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}"


class LiegenError(Exception):
    """Base of all errors that liegen raises for wrong input."""


class DefinitionError(LiegenError):
    """A factor is written in a way that liegen cannot accept."""


class NoAttributeError(DefinitionError, AttributeError):
    """A value has no such attribute; the message says what to write."""


class DomainError(LiegenError):
    """A residual or Jacobian has no finite value anywhere that samples reach."""


class UncertaintyError(LiegenError):
    """A covariance, a square-root information matrix or a stacked Jacobian that describes no distribution."""


class SourceError(LiegenError):
    """A file with factors cannot be found, imported, or holds no such factor."""


class OutputError(LiegenError):
    """An output folder cannot be written without harm to what is there."""


class ToolError(LiegenError):
    """An outside tool (a C compiler) is missing or failed."""


class CompilerWarning(UserWarning):
    """There is no C compiler, so that compiled factors run as NumPy code."""


class CacheWarning(UserWarning):
    """The cache of compiled factors cannot be used; the message says why."""


def warned(message: str, category: type[Warning]) -> None:
    """Warn with the line of the caller's program, the first one outside of liegen."""
    between, level = (Path(__file__).parent, Path(functools.__file__)), 1  # a cached property calls liegen
    frame = inspect.currentframe()
    while frame is not None and any(map(Path(frame.f_code.co_filename).is_relative_to, between)):
        frame, level = frame.f_back, level + 1
    warnings.warn(message, category, stacklevel=level - (frame is None))
