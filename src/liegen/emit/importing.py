"""Emitted Python packages as modules, without files and without a trace in ``sys.modules``."""

from __future__ import annotations

import builtins
from collections.abc import Mapping
from types import ModuleType
from typing import Any


def load_modules(texts: Mapping[str, str], package: str) -> ModuleType:
    """The package with the given texts by file name, ``__init__.py`` among them.

    Its modules may import each other (``from ._support import evaluate``) and whatever is installed.
    """
    modules: dict[str, ModuleType] = {}

    def find(name: str, scope: Any = None, local: Any = None, chosen: Any = (), level: int = 0) -> Any:
        return module(name) if level else __import__(name, scope, local, chosen, level)

    def module(name: str) -> ModuleType:
        if name not in modules:
            made = modules[name] = ModuleType(f"{package}.{name}")
            made.__dict__["__builtins__"] = {**vars(builtins), "__import__": find}
            exec(compile(texts[f"{name}.py"], f"{package}/{name}.py", "exec"), made.__dict__)
        return modules[name]

    return module("__init__")
