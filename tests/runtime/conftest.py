from __future__ import annotations

import pytest
from runtime_tools import needs_compiler

import liegen


@pytest.fixture(params=[pytest.param("c", marks=needs_compiler), "numpy"])
def compiled(request):
    """Compile on either backend."""
    return lambda factor: liegen.compile(factor, backend=request.param)
