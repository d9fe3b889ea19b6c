"""What the README shows is what a new user gets."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

README = (Path(__file__).resolve().parents[1] / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def test_the_example(tmp_path: Path) -> None:
    formula, use, _ = blocks("python")
    (tmp_path / "my_factors.py").write_text(formula)

    def liegen(*arguments: str) -> str:
        command = [sys.executable, "-m", "liegen", *arguments]
        return subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True).stdout

    explained, verified = blocks("text")
    assert liegen("explain", "lever_arm_range", "my_factors.py").startswith(explained.rstrip())
    said, shown = liegen("verify", "my_factors.py", "--samples", "12").splitlines(), verified.splitlines()
    assert said[0].split() == shown[0].split()
    liegen("generate", "my_factors.py", "-o", "out")
    shapes = "\nprint(J.res.shape, J.res_D_T_WB.shape, J.res_D_lever.shape)"
    printed = subprocess.run(
        [sys.executable, "-c", use + shapes], cwd=tmp_path / "out", check=True, capture_output=True, text=True
    )
    assert printed.stdout.strip() == "(1,) (1, 6) (1, 3)"
    declared = re.sub(r"\s+", " ", blocks("c")[0].partition(";")[0])
    emitted = re.sub(r"\s+", " ", (tmp_path / "out/c/lever_arm_range.h").read_text())
    plain = emitted.replace("MY_FACTORS_GEN_RESTRICT ", "").replace("( ", "(")
    assert declared in plain


def test_compiled_factors() -> None:
    *_, compiled = blocks("python")
    names: dict[str, Any] = {}
    exec(compiled, names)
    poses = np.zeros((4, 7))
    poses[:, 3], poses[:, 4] = 1, [0, 1, 2, 4]
    z = np.array([0, 0, 0, 1, 1, 0, 0.0])
    residuals = names["edges"](poses, poses, z=z, sqrt_info=2 * np.eye(6))
    np.testing.assert_allclose(residuals[:, 3], [0, 0, 2])
