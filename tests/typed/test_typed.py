"""A user's file passes the strict type check as it stands, and its factors evaluate."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from liegen.sources import load

HERE = Path(__file__).parent
FILE = HERE / "user_factors.py"
checker = pytest.mark.skipif(
    importlib.util.find_spec("basedpyright") is None, reason="no basedpyright here (pip install .[dev])"
)


def run_checker(file):
    config = HERE.parents[1] / "pyproject.toml"
    command = [sys.executable, "-m", "basedpyright", "--pythonpath", sys.executable, "-p", str(config)]
    command.append(str(file))
    return subprocess.run(command, capture_output=True, text=True, check=False)


@checker
def test_users_file_passes_the_strict_type_check():
    done = run_checker(FILE)
    assert done.returncode == 0, done.stdout
    assert "0 errors" in done.stdout


@checker
@pytest.mark.parametrize(
    ("line", "rule"),
    [
        ("    return x.local(y)", "reportArgumentType"),
        ("    return x.compose(3)", "reportArgumentType"),
        ("    return x.transform_from(y.rotation)", "reportArgumentType"),
        ("    return x.nothing", "reportAttributeAccessIssue"),
    ],
)
def test_the_type_check_sees_mistakes(tmp_path, line, rule):
    head = "from liegen import SE2, SE3, factor\n\n\n@factor\ndef f(x: SE3, y: SE2):\n"
    file = tmp_path / "mistaken.py"
    file.write_text(head + line + "\n")
    done = subprocess.run(
        [sys.executable, "-m", "basedpyright", "--pythonpath", sys.executable, str(file)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert rule in done.stdout


@pytest.mark.parametrize("function", load(str(FILE)), ids=lambda f: f.name)
def test_it_loads_and_derives(function):
    from liegen.samples import CASES, Draw, default_sampler

    sampler = default_sampler({p.name: p.manifold for p in function.graph.parameters})
    values = sampler(Draw(np.random.default_rng(3)), CASES[0])
    variables = [s.name for s in function.declared if s.variable and s.bound is None]
    given = {k: v for k, v in values.items() if k not in variables}
    out = function.jacobians(*(values[k] for k in variables), **given)
    assert len(out) == len(function.graph.outputs) * (1 + len(variables))


def test_it_generates(tmp_path):
    from click.testing import CliRunner

    from liegen.cli import app

    done = CliRunner().invoke(app, ["generate", str(FILE), "-o", str(tmp_path)])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "c" / "midpoint.h").is_file()
