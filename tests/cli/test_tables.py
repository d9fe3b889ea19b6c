"""Tables on terminals of several widths: no number is cut, no line is wider than the terminal."""

import os
import pty
import re
import struct
import subprocess
import sys

import pytest

from liegen.cli.tables import parted

fcntl, termios = pytest.importorskip("fcntl"), pytest.importorskip("termios")

TABLE = """
from liegen.cli.tables import table
numbers = ("1.25e-16", "8.50e-16", "3.75e-11", "2.00", "128", "12")
table(("factor", "checks", "value", "Jacobian", "differences", "slope", "samples", "left out", "unused"),
      [("a_factor_with_a_rather_long_name", "8 passed", *numbers, ""), ("b", "9 passed", *numbers, "")],
      right=range(2, 9))
"""


def on_terminal(columns, *command):
    """What a command prints on a terminal of this width, without the codes of colours."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
    leave_out = {"COLUMNS", "LINES"}
    environment = {k: v for k, v in os.environ.items() if k not in leave_out} | {"TERM": "xterm"}
    process = subprocess.Popen(command, stdout=theirs, env=environment)
    os.close(theirs)
    printed = b""
    try:
        while chunk := os.read(ours, 4096):
            printed += chunk
    except OSError:  # the end, on Linux
        pass
    assert process.wait() == 0
    os.close(ours)
    return re.sub(r"\x1b\[[0-9;]*m", "", printed.decode()).replace("\r\n", "\n")


@pytest.mark.parametrize("columns", [68, 80, 100, 200])
def test_numbers_are_whole(columns):
    text = on_terminal(columns, sys.executable, "-c", TABLE)
    assert "…" not in text
    for number in ("1.25e-16", "8.50e-16", "3.75e-11", "2.00", "128", "12"):
        assert len(re.findall(rf"(?<!\S){re.escape(number)}(?!\S)", text)) == 2
    assert max(map(len, text.splitlines())) <= columns
    folded = "".join(line.split()[0] for line in text.splitlines()[2:-1] if line.split())
    assert "a_factor_with_a_rather_long_name" in folded.replace("─", "")


@pytest.mark.parametrize("columns", [20, 50, 60])
def test_rows_in_lines_where_columns_do_not_fit(columns):
    first, second = on_terminal(columns, sys.executable, "-c", TABLE).strip().split("\n\n")
    numbers = "1.25e-16", "8.50e-16", "3.75e-11", "2.00", "128", "12"
    titles = "value", "Jacobian", "differences", "slope", "samples", "left out"
    lines = [f"{title}: {number}" for title, number in zip(titles, numbers, strict=True)]
    assert second.splitlines() == ["factor: b", "checks: 9 passed", *lines]
    assert first.splitlines()[0] == "factor: a_factor_with_a_rather_long_name"
    assert first.splitlines()[2:] == lines


def test_verify_fits_80_columns():
    command = [sys.executable, "-m", "liegen", "verify", "-f", "bearing_se3_r3_gtsam", "--samples", "4"]
    table = on_terminal(80, *command).split("\nbearing_se3_r3_gtsam: ")[0]
    assert max(map(len, table.splitlines()[:4])) <= 80
    assert "…" not in table
    assert " passed" in table


@pytest.mark.parametrize(
    ("title", "lines"),
    [
        ("value", "value"),
        ("Jacobian", "Jacobian"),
        ("differences", "differ-\nences"),
        ("ns a factor", "ns a\nfactor"),
        ("a b c", "a b c"),
    ],
)
def test_titles_are_parted_to_8_characters(title, lines):
    assert parted(title, 8) == lines
