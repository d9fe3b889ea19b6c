"""The command line: one file per group of commands. ``--help`` and ``--version`` load nothing heavy."""

from __future__ import annotations

from .app import app as app
from .app import main as main
