"""Explanations: what a foreign output is, if it is not the formula's, in terms of known differences."""

from __future__ import annotations

from .difference import Difference as Difference
from .difference import Subject as Subject
from .search import Explanation as Explanation
from .search import explained as explained
