"""Variants are checked against the reference before they are timed; what is missing or wrong is said."""

from dataclasses import replace

import numpy as np
import pytest
from bench_tools import QUICK, made

from compiler_tools import needs_compiler
from liegen.bench import casadi_c, ceres_jets, formulas, ours, symforce_cpp, wrenfold_cpp
from liegen.bench.peers import PUBLISHED, tasks
from liegen.bench.race import race
from liegen.bench.variant import AbsentError, Task
from liegen.library import between_se2, projection_cal3_s2

pytestmark = needs_compiler

PEERS = {"wrenfold": wrenfold_cpp, "SymForce": symforce_cpp, "Ceres": ceres_jets}
QUICK_ONES = ("between_se2", "quaternion_interpolation")


@pytest.mark.parametrize("function", [between_se2, projection_cal3_s2], ids=lambda f: f.name)
def test_own_variants_agree_and_are_timed(function):
    makers = {"liegen": ours.variants, "batches": ours.batches, "CasADi": casadi_c.variants}
    found = race(Task(function), makers, QUICK)
    assert [e.variant.peer for e in found.entries] == ["liegen", "liegen", "CasADi", "CasADi"]
    assert found.missing == ()
    for e in found.entries:
        assert max(e.errors.values()) < 1e-12
        assert all(0 < t.minimum_ns <= t.median_ns for t in e.times.values())
    assert found.entries[0].times["random"].ratio == 1.0
    assert found.entries[0].operations < found.entries[3].operations


def test_gauss_newton_terms_are_those_of_the_references_jacobians():
    plain, terms = tasks((between_se2.whitened("full"),))
    assert terms.name == "between_se2_gauss_newton"
    assert [port.name for port in terms.outputs] == ["cost", "g_x", "g_y", "H_x_x", "H_x_y", "H_y_y"]
    found = race(terms, {"liegen": ours.variants, "batches": ours.batches}, QUICK)
    assert len(found.entries) == 2
    assert all(max(e.errors.values()) < 1e-12 for e in found.entries)
    assert found.entries[0].operations > race(plain, {"liegen": ours.variants}, QUICK).entries[0].operations


def test_a_wrong_variant_is_not_timed():
    def tampered(task):
        (good,) = ours.variants(task)
        name = f"{task.name}.c"
        text = good.sources[name]
        assert "res_D_y[0] = " in text
        bad = text.replace("res_D_y[0] = ", "res_D_y[0] = 1e-8 + ")
        return (replace(good, peer="tampered", sources={**good.sources, name: bad}),)

    found = race(Task(between_se2), {"liegen": ours.variants, "tampered": tampered}, QUICK)
    good, bad = found.entries
    assert good.agrees
    assert not bad.agrees
    assert bad.times == {}
    assert 0.9e-8 < bad.errors["random"] < 1.1e-8


def test_batches_are_right_when_sums_may_be_reordered():
    """Sine and cosine round to integers by adding a large number: -ffast-math must not fold that away."""
    (task,) = tasks((formulas.quaternion_interpolation,))
    makers = {"liegen": ours.variants, "batches": ours.batches}
    found = race(task, makers, replace(QUICK, flags=("fast math",)))
    assert [e.flags for e in found.entries] == ["fast math"] * 2
    assert all(max(e.errors.values()) < 1e-12 for e in found.entries)


def test_nan_is_wrong():
    def broken(task):
        (good,) = ours.variants(task)
        name = f"{task.name}.c"
        bad = good.sources[name].replace("res[0] = ", "res[0] = NAN * ")
        return (replace(good, peer="broken", sources={**good.sources, name: bad}),)

    found = race(Task(between_se2), {"liegen": ours.variants, "broken": broken}, QUICK)
    assert found.entries[1].errors["random"] == float("inf")


def test_missing_peers_have_a_reason():
    def absent(_):
        raise AbsentError("frobnicate is not installed")

    def uncompilable(task):
        (good,) = ours.variants(task)
        name = f"{task.name}.c"
        return (replace(good, peer="x", sources={**good.sources, name: "#include <no/such/header.h>\n"}),)

    def silent(_):
        return ()

    makers = {"liegen": ours.variants, "absent": absent, "x": uncompilable, "silent": silent}
    found = race(Task(between_se2), makers, QUICK)
    assert [e.variant.peer for e in found.entries] == ["liegen"]
    reasons = {m.peer: m.reason for m in found.missing}
    assert reasons["absent"] == "frobnicate is not installed"
    assert "no/such/header.h" in reasons["x"]
    assert "no formula" in reasons["silent"]


def test_column_major_results_are_turned():
    (task,) = tasks((between_se2,))
    (row,) = made(ours.variants, task)

    def columns(_):
        """The same C, told to be column-major: its square Jacobians are then transposed, and wrong."""
        return (replace(row, peer="columns", column_major=True),)

    found = race(task, {"liegen": ours.variants, "columns": columns}, QUICK)
    assert not found.entries[1].agrees
    assert found.entries[1].errors["random"] > 0.1


@pytest.mark.parametrize("peer", PEERS)
@pytest.mark.parametrize(
    "task",
    [
        pytest.param(t, marks=() if t.name in QUICK_ONES else pytest.mark.slow, id=t.name)
        for t in tasks(PUBLISHED)
    ],
)
def test_formulas_of_peers_agree(task, peer):
    module = PEERS[peer]
    made(module.variants, task)
    found = race(task, {"liegen": ours.variants, peer: module.variants}, QUICK)
    if not found.entries[1:]:
        pytest.skip(found.missing[0].reason)
    assert found.missing == ()
    assert all(e.agrees for e in found.entries)
    assert all(np.isfinite(list(e.errors.values())).all() for e in found.entries)


@pytest.mark.parametrize("peer", ["wrenfold", "SymForce"])
def test_closed_forms_inside_a_peer_cost_fewer_operations(peer):
    (task,) = tasks((PUBLISHED[0],))
    variants = made(PEERS[peer].variants, task)
    *own, borrowed = [sum(v.operations.values()) for v in variants]
    assert borrowed < 0.5 * min(own)


def test_users_functions_get_no_published_formula():
    variants = made(wrenfold_cpp.variants, Task(between_se2))
    assert [v.note.partition(",")[0] for v in variants] == ["liegen's closed forms"]
