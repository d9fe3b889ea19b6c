"""Odd values of every option, and files that fail in every command: one message each, nothing written."""

import shlex
from itertools import product

import pytest
from test_command_lines import CASES, FILES, is_refused, written

from liegen.cli import app

#: Numbers: a command line with ``{}`` for the value, and what the message says.
NUMBERS = {
    "verify good.py --samples {}": "--samples",
    "verify good.py --seed {}": "--seed",
    "verify good.py --accuracy --samples {}": "--samples",
    "check-jacobian pull good.py --against foreign.py:f --samples {}": "--samples",
    "check-jacobian pull good.py --against foreign.py:f --seed {}": "--seed",
    "check-jacobian pull good.py --against foreign.py:f --tolerance {}": "--tolerance",
    "bench good.py --rounds {}": "--rounds",
    "bench good.py --calls {}": "--calls",
    "bench good.py --seed {}": "--seed",
    "bench good.py --largest {}": "--largest",
}
#: None of these is a number, or it is in no range.
NO_NUMBERS = ("-1", "nan", "inf", "1_0", "0x10", "ten", "1,5", "", " ", "1e999", "\u0663", "1 2", "\x1b[2J")
NAMES = {
    "generate good.py -o out --chart {}": "unknown chart",
    "verify good.py --chart {}": "unknown chart",
    "explain pull good.py --chart {}": "unknown chart",
    "check-jacobian pull good.py --against foreign.py:f --chart {}": "unknown chart",
    "generate good.py -o out --layout {}": "unknown layout",
    "verify good.py --layout {}": "unknown layout",
    "explain pull good.py --layout {}": "unknown layout",
    "check-jacobian pull good.py --against foreign.py:f --layout {}": "unknown layout",
    "generate good.py -o out --noise {}": "unknown noise",
    "verify good.py --noise {}": "unknown noise",
    "explain pull good.py --noise {}": "unknown noise",
    "generate good.py -o out --loss {}": "unknown loss",
    "verify good.py --loss {}": "unknown loss",
    "explain pull good.py --loss {}": "unknown loss",
    "generate good.py -o out --loss huber --mode {}": "unknown mode",
    "verify good.py --loss huber --mode {}": "unknown mode",
    "explain pull good.py --loss huber --mode {}": "unknown mode",
    "generate -o out --group {}": "no group",
    "verify --group {}": "no group",
    "list --group {}": "no group",
    "explain se3_exp --group {}": "no group",
    "generate good.py -o out -f {}": "no factor",
    "verify good.py -f {}": "no factor",
    "bench good.py -f {}": "no factor",
    "explain {} good.py": "no factor",
    "check-jacobian {} good.py --against foreign.py:f": "no factor",
    "generate good.py -o out --package {}": "no C identifier",
    "generate good.py -o out --target {}": "is not one of",
    "generate good.py -o out --major {}": "is not one of",
    "generate good.py -o out --scalar {}": "is not one of",
    "check-jacobian pull good.py --against {}": "FILE.py:FUNCTION",
    "check-jacobian pull good.py --against foreign.py:f --given {}": "--given",
}
NO_NAMES = ("x y", "../x", "x;y", "\x1b[2J", "a\nb", "\u00e9-1", "x" * 300 + "-", "<b>")
#: Command lines that are right but for what is added to them.
COMMANDS = {
    "list": "list good.py",
    "generate": "generate good.py -o out",
    "verify": "verify good.py",
    "check": "check filled filled",
    "explain": "explain pull good.py",
    "bench": "bench good.py",
    "check-jacobian": "check-jacobian pull good.py --against foreign.py:f",
}
FLAGS = {
    "list": "--json",
    "generate": "--normalise --gauss-newton",
    "verify": "--normalise --accuracy --peers --gauss-newton --json",
    "explain": "--normalise --latex",
    "bench": "--peers --instructions --growth --all-flags --json",
    "check-jacobian": "--normalise --json",
}
VALUED = {
    "list": "--group",
    "generate": "-f --group -t -o --package --major --scalar --chart --layout --noise --loss --mode",
    "verify": "-f --group --noise --loss --mode --samples --seed --chart --layout",
    "explain": "--group --chart --layout --noise --loss --mode",
    "bench": "-f --graph --calls --rounds --seed --largest --chart --compare --write",
    "check-jacobian": "--against --given --chart --layout --samples --seed --tolerance",
}
FACTOR = "from liegen import R3, factor\n\n\n@factor\ndef pull(x: R3):\n    return x + nosuch\n"
#: Files that fail when they are imported, and what the message says of them.
BROKEN = {
    "syntax.py": ("def f(:\n", "syntax.py:1: syntax error"),
    "open.py": ("x = (\n", "open.py:1: syntax error"),
    "raises.py": ("\nraise ValueError('over')\n", "raises.py:2: ValueError: over"),
    "exits.py": ("import sys\nsys.exit(0)\n", "exits.py:2: it ends the program"),
    "missing.py": ("import nosuch_package\n", "missing.py:1: cannot import nosuch_package"),
    "none.py": ("x = 1\n", "none.py defines no factor"),
    "wrong.py": (FACTOR, "wrong.py:6: pull: NameError"),
}
WITH_FILES = (
    "list {}",
    "generate {} -o out",
    "verify {}",
    "explain pull {}",
    "bench {}",
    "check-jacobian pull {} --against foreign.py:f",
)


def filled(lines, values):
    return {line.replace("{}", shlex.quote(v)): says for (line, says), v in product(lines.items(), values)}


LINES = {
    **filled(NUMBERS, NO_NUMBERS),
    **filled(NAMES, NO_NAMES),
    **{f"{line} {odd}": "No such option" for line, odd in product(COMMANDS.values(), ("--nosuch", "-z"))},
    **{f"{line} more and more": "extra argument" for line in COMMANDS.values()},
    **{f"{COMMANDS[c]} {flag}=1": "not take a value" for c, flags in FLAGS.items() for flag in flags.split()},
    **{f"{COMMANDS[c]} {name}": "requires an arg" for c, names in VALUED.items() for name in names.split()},
    **{line.replace("{}", name): says for line, (name, (_, says)) in product(WITH_FILES, BROKEN.items())},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One folder for all: no command may change what is in it."""
    broken = {name: text for name, (text, _) in BROKEN.items()}
    return written(tmp_path_factory.mktemp("commands"), FILES | broken)


@pytest.mark.parametrize("line", LINES)
def test_an_odd_value_of_an_option(line, folder, monkeypatch):
    is_refused(line, LINES[line], folder, monkeypatch)


def test_every_option_of_every_command_is_in_the_tables():
    for name, command in app.commands.items():
        lines = [words for line in [*CASES, *LINES] if (words := shlex.split(line)) and words[0] == name]
        given = {word.partition("=")[0] for words in lines for word in words}
        for option in command.params:
            if option.param_type_name == "option":
                assert given & {*option.opts, *option.secondary_opts}, (name, option.opts)


def test_the_tables_hold_at_least_300_command_lines():
    assert len(set(CASES) | set(LINES)) >= 300
