"""Wrong command lines: exit code 1 or 2, one message that names the cause, no traceback, nothing written."""

import shlex

import pytest
from click.testing import CliRunner

from liegen.cli import app

GOOD = """from liegen import R3, factor, function, outputs


@factor
def pull(x: R3, *, z: R3):
    return x - z


@function
def both(x: R3, y: R3):
    return outputs(a=x + y, b=x - y)
"""
FOREIGN = "import numpy as np\n\nnumber = 3\n\n\ndef f(x, z):\n    return x - z, np.eye(3)\n"
GROUPS = "did you mean SE3? there are: SE23"
RANGE = "is not in the range"

#: The folder in which the commands run.
FILES = {
    "good.py": GOOD,
    "foreign.py": FOREIGN,
    "good.txt": "hello",
    "mine.c": "int f(void) { return 0; }",
    "bad.so": "no library",
    "filled/readme.txt": "mine",
    "badjson/bad.json": "{",
    "nested/deep.json": '{"a":' * 2000 + "1" + "}" * 2000,
    "otherformat/x.json": '{"format": 1}',
    "listed/x.json": "[1, 2]",
    "binary/x.json": "\x00\x01",
    "graph.g2o": "VERTEX_SE3:QUAT 0 0 0 0\n",
}

#: The command line, and what the message says; one a line.
LINES = """
nosuch | No such command 'nosuch'
--nosuch list | --nosuch
--debug | Missing command
list nosuch.py | nosuch.py does not exist
list . | is a folder
list filled | is a folder
list filled/ | is a folder
list good.py extra | extra argument (extra)
list nosuch_module | no module 'nosuch_module'
list nosuch.good | no module 'nosuch.good'
list os | os defines no factor
list os.path | defines no factor
list a..b | neither a Python file nor a dotted module
list .relative | neither a Python file nor a dotted module
list '' | neither a Python file nor a dotted module
list 'a b' | neither a Python file nor a dotted module
list 'good.py ' | neither a Python file nor a dotted module
list good.txt | good.txt:1
list --group SE4 | no group 'SE4'; {groups}
list --group se3 | no group 'se3'; {groups}
list --group '' | no group ''
list --group SE3 good.py | not both
list --nosuch | --nosuch
list --json=1 good.py | does not take a value
list --group | requires an argument
generate | Missing option '-o'
generate good.py | Missing option '-o'
generate good.py -o | requires an argument
generate good.py -o '' | the name of the output folder is empty
generate good.py -o out -t rust | 'rust' is not one of 'numpy', 'c'
generate good.py -o out -t '' | '' is not one of 'numpy', 'c'
generate good.py -o out -f nosuch | no factor 'nosuch'
generate good.py -o out -f pul | did you mean pull
generate good.py -o out -f '' | no factor ''
generate good.py -o out -f pull -f nosuch | no factor 'nosuch'
generate good.py -o out --package 1abc | '1abc' is no C identifier
generate good.py -o out --package '' | package name '' is no C identifier
generate good.py -o out --package 'a b' | 'a b' is no C identifier
generate good.py -o out --package é | no C identifier
generate good.py -o out --package ../x | '../x' is no C identifier
generate good.py -o out --package class | Python keyword
generate good.py -o out --package double | C keyword
generate good.py -o out --package numpy | numpy
generate good.py -o out --major diagonal | 'diagonal' is not one of 'row', 'col'
generate good.py -o out --scalar half | 'half' is not one of 'double', 'float'
generate good.py -o out --chart nosuch | unknown chart 'nosuch'; one of gtsam
generate good.py -o out --chart '' | unknown chart ''
generate good.py -o out --chart GTSAM | unknown chart 'GTSAM'
generate good.py -o out --layout nosuch | unknown layout 'nosuch'; one of xyzw
generate good.py -o out --layout '' | unknown layout ''
generate good.py -o out --layout 5 | unknown layout '5'
generate good.py -o out --noise nosuch | unknown noise 'nosuch'; choose from full
generate good.py -o out --noise '' | unknown noise ''
generate good.py -o out --loss nosuch | unknown loss 'nosuch'; choose from huber
generate good.py -o out --loss '' | unknown loss ''
generate good.py -o out --loss huber --mode nosuch | unknown mode 'nosuch'; choose from irls
generate good.py -o out --mode irls | mode='irls' is one of a loss
generate good.py -o good.py | good.py is a file
generate good.py -o good.py/sub | good.py is a file, so nothing can be written to good.py/sub
generate good.py -o good.py/sub/sub | good.py is a file
generate good.py --group SE3 -o out | not both
generate --group SE4 -o out | no group 'SE4'; {groups}
generate --group SE3 --group '' -o out | no group ''
generate nosuch.py -o out | nosuch.py does not exist
generate filled -o out | is a folder
generate good.txt -o out | good.txt:1
generate good.py extra -o out | extra argument
generate good.py -o out --gauss-newton=1 | does not take a value
verify good.py --samples 0 | {range}
verify good.py --samples -1 | {range}
verify good.py --samples x | 'x' is not a valid integer
verify good.py --samples 1.5 | '1.5' is not a valid integer
verify good.py --samples nan | 'nan' is not a valid integer
verify good.py --samples 1000000000 | {range}
verify good.py --samples '' | '' is not a valid integer
verify good.py --seed -1 | {range}
verify good.py --seed x | 'x' is not a valid integer
verify good.py --seed 99999999999999999999999 | {range}
verify good.py --peers | --peers is a part of --accuracy
verify good.py --accuracy --loss huber | without a loss
verify good.py --accuracy --loss nosuch | without a loss
verify good.py --accuracy --chart nosuch | unknown chart 'nosuch'
verify good.py -f nosuch | no factor 'nosuch'
verify good.py --chart nosuch | unknown chart 'nosuch'
verify good.py --layout nosuch | unknown layout 'nosuch'
verify good.py --noise nosuch | unknown noise 'nosuch'
verify good.py --loss nosuch | unknown loss 'nosuch'
verify good.py --mode triggs | mode='triggs' is one of a loss
verify good.py --group SE3 | not both
verify --group SE9 | no group 'SE9'
verify -f nosuch | no factor 'nosuch'
verify nosuch.py | nosuch.py does not exist
verify nosuch | no module 'nosuch'
verify good.py --json=1 | does not take a value
check nosuch | nosuch holds no manifest
check good.py | good.py is a file, not a folder that liegen wrote
check filled | filled holds no manifest
check nested | nested holds no manifest
check '' | holds no manifest
check badjson | badjson holds no manifest
check otherformat | otherformat holds no manifest
check listed | listed holds no manifest
check binary | binary holds no manifest
check filled nosuch.py | holds no manifest
check a b c | extra argument
explain | Missing argument 'NAME'
explain nosuch | no factor 'nosuch'
explain betwen_se3 | did you mean between_se3
explain Between_SE3 | did you mean between_se3
explain pull nosuch.py | nosuch.py does not exist
explain nosuch good.py | no factor 'nosuch'
explain pull good.py --chart nosuch | unknown chart 'nosuch'
explain pull good.py --layout nosuch | unknown layout 'nosuch'
explain pull good.py --noise nosuch | unknown noise 'nosuch'
explain pull good.py --loss nosuch | unknown loss 'nosuch'
explain pull good.py --mode irls | mode='irls' is one of a loss
explain both good.py --noise full | both is a @function
explain both good.py --loss huber | both is a @function
explain '' good.py | no factor ''
explain pull good.py --group SE3 | not both
explain se3_log --group SO3 | no factor 'se3_log'
check-jacobian | Missing argument 'NAME'
check-jacobian pull good.py | Missing option '--against'
check-jacobian pull good.py --against | requires an argument
check-jacobian pull good.py --against nosuch | is not FILE.py:FUNCTION
check-jacobian pull good.py --against '' | is not FILE.py:FUNCTION
check-jacobian pull good.py --against good.py: | is not FILE.py:FUNCTION
check-jacobian pull good.py --against :f | is not FILE.py:FUNCTION
check-jacobian pull good.py --against 'good.py:a b' | is not FILE.py:FUNCTION
check-jacobian pull good.py --against nosuch.py:f | nosuch.py does not exist
check-jacobian pull good.py --against foreign.py:nosuch | foreign.py has no function 'nosuch'
check-jacobian pull good.py --against foreign.py:number | foreign.py has no function 'number'
check-jacobian both good.py --against foreign.py:f | both has several outputs
check-jacobian nosuch good.py --against foreign.py:f | no factor 'nosuch'
check-jacobian pull nosuch.py --against foreign.py:f | nosuch.py does not exist
check-jacobian pull good.py --against good.txt:f | good.txt
check-jacobian pull good.py --against foreign.py:f --tolerance 0 | {range}
check-jacobian pull good.py --against foreign.py:f --tolerance -1 | {range}
check-jacobian pull good.py --against foreign.py:f --tolerance x | 'x' is not a valid float
check-jacobian pull good.py --against foreign.py:f --samples 0 | {range}
check-jacobian pull good.py --against foreign.py:f --samples x | 'x' is not a valid integer
check-jacobian pull good.py --against foreign.py:f --seed -1 | {range}
check-jacobian pull good.py --against foreign.py:f --given x=1 | --given x=1
check-jacobian pull good.py --against foreign.py:f --given z | --given z
check-jacobian pull good.py --against foreign.py:f --given = | --given =
check-jacobian pull good.py --against foreign.py:f --chart nosuch | unknown chart 'nosuch'
check-jacobian pull good.py --against foreign.py:f --layout nosuch | unknown layout 'nosuch'
bench --rounds 0 | {range}
bench --rounds -1 | {range}
bench --rounds x | 'x' is not a valid integer
bench --rounds 1e3 | '1e3' is not a valid integer
bench --rounds 1000000000000 | {range}
bench --calls 0 | {range}
bench --calls 1.5 | '1.5' is not a valid integer
bench --calls 10000000000 | {range}
bench --seed -1 | {range}
bench --seed x | 'x' is not a valid integer
bench --largest 0 | {range}
bench --largest -5 | {range}
bench --largest 10000000000 | {range}
bench -f nosuch | no factor 'nosuch'
bench nosuch.py | nosuch.py does not exist
bench good.py -f nosuch | no factor 'nosuch'
bench --peers --graph graph.g2o | two measurements
bench --growth --peers | two measurements
bench --instructions --growth | two measurements
bench --chart out.svg | --chart is a part of --peers
bench --all-flags | --all-flags is a part of --peers
bench --write counts.json | --write is a part of --instructions
bench --compare counts.json | --compare is a part of --instructions
bench --peers --chart nodir/out.svg | no folder nodir
bench --peers --chart filled | filled is a folder
bench --peers --chart '' | name of a file
bench --instructions --write nodir/counts.json | no folder nodir
bench --instructions --write filled | filled is a folder
bench --instructions --compare nosuch.json | nosuch.json
bench --instructions --compare badjson/bad.json | badjson/bad.json
bench --instructions --compare filled | filled
bench --graph nosuch.g2o | nosuch.g2o
bench --graph filled | filled
bench --graph '' | name of a file
"""
CASES = dict(line.split(" | ") for line in LINES.strip().splitlines())


def snapshot(folder):
    paths = [p for p in folder.rglob("*") if "__pycache__" not in p.parts]
    return {p: p.read_bytes() if p.is_file() else None for p in paths}


def written(place, files):
    """The folder, with the files in it."""
    for name, text in files.items():
        path = place / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    return place


def is_refused(line, says, folder, monkeypatch):
    """One message that names the cause, in a line of a terminal, and nothing written."""
    monkeypatch.chdir(folder)
    before = snapshot(folder)
    done = CliRunner().invoke(app, shlex.split(line))
    assert done.exit_code in (1, 2), done.output
    assert done.exception is None or isinstance(done.exception, SystemExit)
    assert says in done.stderr
    assert sum(text.startswith("Error: ") for text in done.stderr.splitlines()) == 1
    assert "Traceback" not in done.output
    assert "\x1b" not in done.output
    assert len(done.stderr) < 1500
    assert done.stdout == ""
    assert str(folder) not in done.output
    assert snapshot(folder) == before


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One folder for all: no command may change what is in it."""
    return written(tmp_path_factory.mktemp("commands"), FILES)


@pytest.mark.parametrize("line", CASES)
def test_a_wrong_command_line(line, folder, monkeypatch):
    is_refused(line, CASES[line].format(groups=GROUPS, range=RANGE), folder, monkeypatch)


def test_the_table_covers_all_commands():
    commands = {line.split()[0] for line in CASES}
    assert set(app.commands) <= commands
    assert len(CASES) >= 170
