"""The code of docs/compile.md runs as it stands."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from compiler_tools import needs_compiler

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "compile.md").read_text(encoding="utf-8")


@needs_compiler
def test_the_page():
    names: dict = {}
    blocks = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert len(blocks) == 2
    exec(blocks[0], names)
    np.testing.assert_allclose(names["r"], [0, 0, 0, -1, -2, -3], atol=1e-15)  # y in x is the identity
    assert names["J"].res_D_x.shape == (6, 6)
    exec(blocks[1], names)
    assert names["J"].res_D_y.shape == (99, 6, 6)
    np.testing.assert_allclose(names["J"].res, 0, atol=1e-15)
