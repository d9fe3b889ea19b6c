"""What the README shows is what a new user gets."""

import re
import subprocess
import sys
from pathlib import Path

README = (Path(__file__).resolve().parents[1] / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def test_the_example(tmp_path: Path) -> None:
    formula, use = blocks("python")
    (tmp_path / "my_factors.py").write_text(formula)

    def liegen(*arguments: str) -> str:
        command = [sys.executable, "-m", "liegen", *arguments]
        return subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True).stdout

    explained, verified = blocks("text")
    assert liegen("explain", "lever_arm_range", "my_factors.py").startswith(explained.rstrip())
    titles = verified.splitlines()[0].split()
    assert liegen("verify", "my_factors.py", "--samples", "12").splitlines()[0].split() == titles
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
