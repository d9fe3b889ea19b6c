"""Group modules: every operation of a Lie group as functions that are derived, emitted and verified."""

from __future__ import annotations

from .functions import every_function as every_function
from .functions import group_functions as group_functions
from .functions import group_named as group_named
from .functions import groups as groups
