from __future__ import annotations

import pytest

from liegen.verify.backends import workspace
from liegen.verify.run import library


@pytest.fixture(scope="session")
def library_place():
    """The whole library, rendered and compiled once."""
    with workspace([f.kernel for f in library().values()]) as place:
        yield place
