from __future__ import annotations

import pytest

import liegen
from compiler_tools import needs_compiler


@pytest.fixture(params=[pytest.param("c", marks=needs_compiler), "numpy"])
def compiled(request):
    """Compile on either backend."""
    return lambda factor: liegen.compile(factor, backend=request.param)
