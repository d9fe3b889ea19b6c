from __future__ import annotations

import pytest

import liegen
from compiler_tools import needs_compiler
from liegen import native
from liegen.runtime import build, cache


@pytest.fixture(params=[pytest.param("c", marks=needs_compiler), "numpy"])
def compiled(request):
    """Compile on either backend."""
    return lambda factor: liegen.compile(factor, backend=request.param)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty cache of its own."""
    monkeypatch.setenv("LIEGEN_CACHE_DIR", str(tmp_path / "own"))
    return tmp_path / "own" / cache.FOLDER


@pytest.fixture
def compilations(monkeypatch):
    """The shared objects that were compiled."""
    made = []

    def counted(sources, library, flags, **named):
        made.append(library)
        native.compile_shared(sources, library, flags, **named)

    monkeypatch.setattr(build, "compile_shared", counted)
    return made


@pytest.fixture
def quick_builds(monkeypatch):
    monkeypatch.setattr(build, "FLAGS", ("-std=c99", "-O0"))
