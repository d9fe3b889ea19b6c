"""Layouts: in which numbers an element is given to generated code, and by which it returns one."""

from __future__ import annotations

from .layout import Layout as Layout
from .layout import Stored as Stored
from .of_manifolds import Storage as Storage
from .of_manifolds import storage as storage
from .presets import LAYOUTS as LAYOUTS
from .presets import OWN as OWN
from .presets import stored as stored
