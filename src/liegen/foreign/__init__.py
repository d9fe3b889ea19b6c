"""Jacobians that liegen did not write, held against a formula of liegen."""

from __future__ import annotations

from .calls import Foreign as Foreign
from .calls import foreign as foreign
from .comparison import Comparison as Comparison
from .comparison import Finding as Finding
from .comparison import compare as compare
from .process import separate as separate
