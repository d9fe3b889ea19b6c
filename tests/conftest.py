"""Compiled factors of the tests are kept in a folder of their own."""

from __future__ import annotations

import pytest


@pytest.fixture(scope="session")
def kept(tmp_path_factory):
    """One cache for all tests that do not test the cache."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(autouse=True)
def _cache(kept, monkeypatch):
    monkeypatch.setenv("LIEGEN_CACHE_DIR", str(kept))
