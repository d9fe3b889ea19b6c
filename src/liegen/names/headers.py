"""The names in ``taken.txt``."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from importlib import resources


@cache
def taken() -> Mapping[str, frozenset[str]]:
    """By the title of a section, its names."""
    text = resources.files("liegen.names").joinpath("taken.txt").read_text(encoding="utf-8")
    lines = "".join(line for line in text.splitlines(keepends=True) if not line.startswith("#"))
    parts = re.split(r"^\[(.*)\]$", lines, flags=re.MULTILINE)[1:]
    return {title: frozenset(names.split()) for title, names in zip(parts[::2], parts[1::2], strict=True)}
