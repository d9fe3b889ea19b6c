from __future__ import annotations

import pytest
from runtime_tools import needs_compiler

import liegen


@pytest.fixture(scope="session")
def kept(tmp_path_factory):
    """One cache for all tests that do not test the cache."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(autouse=True)
def _cache(kept, monkeypatch):
    monkeypatch.setenv("LIEGEN_CACHE_DIR", str(kept))


@pytest.fixture(params=[pytest.param("c", marks=needs_compiler), "numpy"])
def compiled(request):
    """Compile on either backend."""
    return lambda factor: liegen.compile(factor, backend=request.param)
