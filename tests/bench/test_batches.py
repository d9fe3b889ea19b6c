"""Profiles of kernels: the right calls are timed. No time is asserted."""

import numpy as np
import pytest

from compiler_tools import needs_compiler
from liegen.bench import batch_variants, batches, draws, ours
from liegen.bench.build import load
from liegen.bench.ceilings import load_loops, whole
from liegen.bench.variant import FLAGS, Task
from liegen.library import between_se2, between_so3
from liegen.program import Port, Program
from liegen.program.program import Instruction

pytestmark = needs_compiler
TASK = Task(between_se2)


@pytest.mark.parametrize("layout", batches.LAYOUTS)
def test_batches_compute_what_single_calls_do(layout, tmp_path):
    rows = draws.rows(draws.samples(between_se2, "random", 7, 0))
    (single,) = ours.variants(TASK)
    expected = load(TASK, single, FLAGS["plain"], tmp_path / "single").results(rows)
    batch = load(TASK, batches.batched(TASK, layout), FLAGS["plain"], tmp_path / "batch")
    out = np.zeros(expected.size)
    whole(batch.library["drive"], 2, 7, batches.arranged(TASK, rows, layout), out)()
    found, start = [], 0
    for port in TASK.outputs:
        block = out[start : start + 7 * port.size]
        found.append(block.reshape(7, -1) if layout == "aos" else block.reshape(-1, 7).T)
        start += 7 * port.size
    np.testing.assert_allclose(np.concatenate(found, axis=1), expected, rtol=0, atol=1e-14)


def test_variants_of_a_batch_compute_what_single_calls_do(tmp_path, monkeypatch):
    rows = draws.rows(draws.samples(between_se2, "random", 7, 0))
    (single,) = ours.variants(TASK)
    expected = load(TASK, single, FLAGS["plain"], tmp_path / "single").results(rows)
    buffers: list[tuple[batch_variants.Case, dict[str, np.ndarray]]] = []

    def watched(library, task, case, inputs):
        dtype = np.dtype(batch_variants.DTYPES[case.precision.suffix])
        into = {p.name: np.full(len(inputs) * p.size, 7.0, dtype) for p in task.outputs}
        buffers.append((case, into))
        return run_of(library, task, case, inputs, into)

    run_of = batch_variants.run_of
    monkeypatch.setattr(batch_variants, "run_of", watched)
    monkeypatch.setattr(batch_variants, "FACTORS", 7)
    timed = batch_variants.batch_variants(TASK, rounds=1, seed=0)
    assert [t.what for t in timed] == [case.what for case, _ in buffers]
    assert "all, columns, single" in [t.what for t in timed]
    for case, into in buffers:
        few = 1e-14 if case.precision.type == "double" else 1e-5
        start = 0
        for port in TASK.outputs:
            found = into[port.name]
            wanted = expected[:, start : start + port.size]
            start += port.size
            if port.name not in case.wanted:
                assert (found == 7.0).all()
                continue
            if case.column_major and len(port.shape) == 2:
                wanted = wanted.reshape(-1, *port.shape).transpose(0, 2, 1).reshape(7, -1)
            shaped = found.reshape(-1, 7).T if case.structure_of_arrays else found.reshape(7, -1)
            np.testing.assert_allclose(shaped, wanted, rtol=0, atol=few * max(1, np.abs(wanted).max()))


def test_a_chain_computes_what_single_calls_do(tmp_path):
    rows = draws.rows(draws.samples(between_se2, "random", 3, 0))
    (single,) = ours.variants(TASK)
    expected = load(TASK, single, FLAGS["plain"], tmp_path / "single").results(rows)
    chain = load(TASK, batches.chained(TASK, single), FLAGS["plain"], tmp_path / "chain")
    buffer = chain.buffer()
    chain.run(rows, buffer)()
    np.testing.assert_allclose(buffer[0], expected[-1], rtol=0, atol=1e-15)


def test_the_deepest_result():
    code = (
        Instruction("input", (), 0),
        Instruction("sin", (0,)),
        Instruction("mul", (1, 1)),
        Instruction("neg", (0,)),
    )
    program = Program("f", (Port("a", (1,)),), (Port("p", (2,)), Port("q", (2,))), code, ((0, 1), (2, 3)))
    assert batches.deepest(program.validate()) == 2


def test_a_profile():
    profile = batches.profile(Task(between_so3), sizes=(1, 5, 10**9), rounds=2, seed=0)
    assert profile.bytes == 8 * (4 + 4 + 4 + 3 + 9 + 9)
    assert [size.n for size in profile.sizes] == [1, 5]
    assert profile.left_out == (10**9,)
    assert all(ns > 0 for size in profile.sizes for ns in size.ns.values())


def test_loops_do_what_they_say(tmp_path):
    machine = load_loops(tmp_path)
    source, target = np.arange(16.0), np.zeros(16)
    machine.copy(1, 24, source, target)()
    assert target.tolist() == [0.0, 1.0, 2.0] + [0.0] * 13
    ceilings = machine.arithmetic(2)
    assert ceilings.width in (1, 2, 4, 8)
    assert ceilings.scalar > 0
    assert ceilings.vector > 0
