"""What all tests that compile share."""

import pytest

from liegen.native import find_compiler

needs_compiler = pytest.mark.skipif(not find_compiler(), reason="no C compiler")
