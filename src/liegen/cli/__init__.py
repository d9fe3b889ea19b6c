"""The command line: one file per group of commands. ``--help`` and ``--version`` load nothing heavy."""

from __future__ import annotations

from .application import app as app
from .application import main as main
