"""Tables, verdicts, JSON and the chart, from results made by hand."""

import json

import pytest
from bench_tools import entry, result, variant, wrong

from liegen.bench import report
from liegen.bench.callgrind import Instructions
from liegen.bench.race import Plan


def test_a_loss_is_called_a_loss():
    found = result(entry("liegen", 1.0, operations=50), entry("rival", 0.8, operations=40))
    assert "LOSS: rival takes 0.80 (random), 0.80 (small)" in report.verdict(found)
    assert "1.25 of the operations of rival" in report.verdict(found)


def test_a_loss_on_either_inputs_is_a_loss():
    found = result(entry("liegen", 1.0), entry("rival", 1.5, small=0.9))
    assert "LOSS" in report.verdict(found)


def test_a_win_and_a_draw():
    assert "faster: rival takes 3.00" in report.verdict(result(entry("liegen", 1.0), entry("rival", 3.0)))
    assert "even: rival" in report.verdict(result(entry("liegen", 1.0), entry("rival", 1.01)))


def test_the_best_flags_of_both_sides_are_compared():
    found = result(
        entry("liegen", 1.0),
        entry("liegen", 0.9, flags="fast math"),
        entry("rival", 2.0),
        entry("rival", 1.8, flags="no errno"),
    )
    assert "takes 2.00 (random)" in report.verdict(found)
    assert [(e.variant.peer, e.flags) for e in found.best] == [("liegen", "fast math"), ("rival", "no errno")]


def test_borrowed_closed_forms_are_no_peer_but_show_losses_of_code_generation():
    found = result(
        entry("liegen", 1.0),
        entry("rival", 2.0),
        entry("rival", 0.7, note="liegen's closed forms", borrowed=True),
    )
    text = report.verdict(found)
    assert "faster: rival takes 2.00" in text
    assert "LOSS of code generation to rival: liegen's closed forms" in text


def test_batches_are_not_the_base_of_the_verdict():
    found = result(entry("liegen", 1.0), entry("liegen", 0.3, note="batches of 256"), entry("rival", 2.0))
    assert "takes 2.00" in report.verdict(found)


def test_no_peer():
    assert report.verdict(result(entry("liegen", 1.0))) == "turn: no peer to compare with"


def test_rows_say_what_is_wrong_and_missing():
    found = result(entry("liegen", 1.0), wrong("rival"), missing=[("absent", "not installed")])
    rows = report.rows(found, every=False)
    assert all(len(row) == len(report.TITLES) for row in rows)
    assert rows[1][3] == "wrong"
    assert rows[1][-1] == "inf"
    assert rows[2][:3] == ("turn", "absent", "missing: not installed")


def test_calls_are_listed_apart():
    kinds = {"mul": 5, "atan2": 1, "call": 2, "sqrt": 3}
    assert report.calls(kinds) == 3
    found = result(entry("liegen", 1.0))
    only = report.rows(
        result(type(found.entries[0])(variant("a", "", kinds), "plain", {}, {"random": 0.0})), every=True
    )
    assert only[0][7:9] == ("8", "3")


def test_json_is_strict():
    found = result(entry("liegen", 1.0, operations=5), wrong("rival"), missing=[("absent", "why")])
    text = json.dumps(report.as_json([found], Plan(), "cc 1"), allow_nan=False)
    content = json.loads(text)["functions"]["turn"]
    assert content["entries"][0]["operations"] == {"mul": 5}
    assert content["entries"][1]["errors"]["small"] is None
    assert content["missing"] == [{"peer": "absent", "reason": "why"}]


def test_the_chart_has_the_same_bytes_each_time():
    pytest.importorskip("matplotlib")
    from liegen.bench.chart import svg

    found = [result(entry("liegen", 1.0), entry("wrenfold", 3.0), entry("Ceres", 4.5), wrong("SymForce"))]
    text = svg(found)
    assert text == svg(found)
    assert text.startswith("<?xml")
    for shown in ("turn", " 3.0", " 4.5", "wrenfold"):
        assert shown in text
    assert "SymForce" not in text


def test_instructions_show_what_changed():
    now = Instructions("cc", "glibc", (), {"a": {"value": 5, "jacobians": 9}, "b": {"value": 7}})
    before = Instructions("cc", "glibc", (), {"a": {"value": 5, "jacobians": 8}})
    assert report.instruction_rows(now, before) == [("a", "5", "", "9", "8"), ("b", "7", "", "", "")]
