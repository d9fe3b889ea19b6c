"""``Libraries``: the shared objects of a factor, each compiled when it is first needed."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from liegen.emit.loops import Method, symbol

from .build import load
from .source import JACOBIANS, PACKAGE, SINGLES, VALUE, Source
from .ufuncs import gufunc, joined_gufunc


@dataclass(frozen=True, eq=False)
class Libraries:
    """The parts of a factor in C. What compiles one raises ToolError where the compiler fails."""

    source: Source

    @cached_property
    def value(self) -> ctypes.CDLL:
        """Value and status on doubles."""
        return load(self.source, VALUE)

    @cached_property
    def whole(self) -> ctypes.CDLL:
        """The batch of all outputs in double precision, and what gathers."""
        return self.value if self.source.whole == VALUE else load(self.source, JACOBIANS)

    @cached_property
    def singles(self) -> ctypes.CDLL:
        """Everything in single precision."""
        return load(self.source, SINGLES)

    def doubles_of(self, method: Method) -> np.ufunc:
        """The gufunc of a method on doubles alone."""
        return gufunc(self._of(method), self._symbol(method))

    def all_of(self, method: Method) -> np.ufunc:
        """The gufunc of a method, with what computes in single precision where all arguments are of it."""
        return joined_gufunc((self.singles, self._of(method)), self._symbol(method)).call

    def _of(self, method: Method) -> ctypes.CDLL:
        return self.whole if method.name == JACOBIANS else self.value

    def _symbol(self, method: Method) -> str:
        return symbol(self.source.name, method.name, PACKAGE)
