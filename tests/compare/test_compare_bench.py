"""Benchmarks say what they measured, in what unit, and why something was not measured. No test looks at a clock."""

import json
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import harness
from harness.compare import bench
from harness.compare.bench import diagnosis, flexible, loop_scaling, measure, peers, scaling, simulation, single_call
from harness.compare.bench.batch import native_batch, pinocchio_batch
from harness.compare.bench.row import Row, document, skipped
from harness.compare.bench.two_threads import two_threads
from harness.errors import InputError, UnsupportedError


def test_row_as_the_contract_has_it() -> None:
    row = Row("forward_dynamics_batch", 7, "pinocchio", 1.9e-7, 2.1e-6, wanted=10.0)
    told = json.loads(json.dumps(document([row], {})))
    assert told["schema"] == "denoc.bench/1"
    (entry,) = told["rows"]
    expected = {
        "what": "forward_dynamics_batch",
        "n": 7,
        "peer": "pinocchio",
        "ours": 1.9e-7,
        "theirs": 2.1e-6,
        "unit": "s",
    }
    assert entry.items() >= expected.items()
    assert entry["ratio"] == pytest.approx(2.1 / 0.19)
    assert entry["met"] is True
    assert Row("x", 1, "p", 2.0, 1.0, wanted=1.0).met is False
    assert Row("x", 1, "p", 2.0, None).ratio is None


def test_what_cannot_be_measured_is_a_row_with_the_reason() -> None:
    def fails() -> list[Row]:
        raise UnsupportedError("500 coordinates are too many")

    (row,) = peers.or_skipped("forward_dynamics", 500, "pinocchio", fails)
    assert row.skipped
    assert row.ratio is None
    assert row.met is None
    assert "too many" in row.note
    assert row == skipped("forward_dynamics", 500, "pinocchio", "500 coordinates are too many")


def test_calls_take_turns_and_are_all_repeated() -> None:
    order: list[str] = []
    timings = measure.side_by_side(
        {"a": lambda: order.append("a"), "b": lambda: order.append("b")}, rounds=4, round_seconds=1e-5
    )
    assert set(timings) == {"a", "b"}
    for timing in timings.values():
        assert timing.rounds == 4
        assert 0.0 < timing.low <= timing.median <= timing.high
    # After the warm-up both come in every round: the last a is followed by the last round's b.
    changes = [x for k, x in enumerate(order) if k == 0 or order[k - 1] != x]
    assert changes == ["a", "b"] * 5
    half = timings["a"].per(2)
    assert half.median == timings["a"].median / 2


def test_child_answers_or_says_why_not() -> None:
    child = measure.in_child("answer = dict(sum=1 + 1)")
    assert child.answer == {"sum": 2}
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        measure.in_child("1 / 0")


def test_a_child_that_takes_too_long_is_given_up() -> None:
    with pytest.raises(RuntimeError, match=r"longer than 0\.2 s"):
        measure.in_child("import time; time.sleep(60)", patience=0.2)


def test_what_is_begun_is_told_before_its_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[str] = []
    monkeypatch.setattr(scaling, "run", lambda options: iter([Row("forward_dynamics_memory", 1, "p", 1.0, 1.0)]))
    told += [row.what for row in bench.run(["forward_dynamics_memory"], peers.Options(tell=told.append))]
    assert told == [f"scaling: {bench.BENCHMARKS['scaling'].title}", "forward_dynamics_memory"]


def test_diagnosis_that_is_timed_runs_as_a_user_would_have_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # The code of the child, on recordings and a diagnosis of its own making: what it reads of the answer must be there.
    diagnosis.recordings(tmp_path)
    assert sorted(path.name for path in tmp_path.glob("run*.csv")) == ["run1.csv", "run2.csv"]
    stand_in = SimpleNamespace(verdict="explained", findings=[{"effect": "coulomb_friction", "site": "pivot"}])
    monkeypatch.setattr(harness, "diagnose", lambda runs, model: stand_in)
    space: dict[str, object] = {}
    (_, both, _), (_, one, _) = diagnosis.CASES
    assert both == ["run1.csv", "run2.csv"] and one == ["run1.csv"]
    exec(diagnosis._OURS.format(folder=str(tmp_path), runs=both), space)
    answer = space["answer"]
    assert isinstance(answer, dict)
    assert answer["found"] == ["coulomb_friction@pivot"]
    assert answer["verdict"] == "explained"


def test_exponent_of_a_power_law() -> None:
    sizes = (10, 100, 1000)
    assert scaling.exponent(sizes, [3e-6 * n**1.7 for n in sizes]) == pytest.approx(1.7)


def test_both_sides_do_the_same_work() -> None:
    # A benchmark of two different things would be worth nothing.
    system, at = peers.chain(7), peers.states(7, 8)
    native, pinocchio = single_call.native_calls(system, at), single_call.pinocchio_calls(system, at)
    mujoco = single_call.mujoco_calls(system, at)
    assert set(native) == set(pinocchio) == set(mujoco)
    for what in native:
        assert np.asarray(native[what]()) == pytest.approx(np.asarray(pinocchio[what]()), rel=1e-9, abs=1e-9)
    many, pool = native_batch(system, at), pinocchio_batch(system, at)
    for what in ("forward_dynamics_batch", "inverse_dynamics_batch"):
        # The pool's states are columns.
        assert pytest.approx(np.asarray(many[what]()), rel=1e-9, abs=1e-9) == np.asarray(pool[what]()).T


def test_rollout_is_the_motion_of_the_adapter() -> None:
    system = simulation.damped(2)
    q0, qd0 = (x[:2] for x in simulation.start(2))
    positions = simulation.rollout(system, q0, qd0)()
    run = peers.peer_model("mujoco", system).simulate(q0[1], qd0[1], np.linspace(0.0, 0.5, 501), step=simulation.STEP)
    assert positions[1, :500] == pytest.approx(run.position[1:], abs=1e-12)


def test_error_of_a_deflection_by_hand() -> None:
    truth = np.array([0.0, 2.0, 0.0, -4.0])
    assert flexible.error(truth + 0.04, truth) == pytest.approx(0.01)


def test_native_deflection_is_that_of_the_public_simulation() -> None:
    from harness.denoc.lanes.model import LaneModel

    system = flexible.pendulum(2)
    model = peers.native(system)
    time = np.linspace(0.0, 0.2, 201)
    wanted = model.simulate(*flexible.start(model.n), time).channels[flexible.CHANNEL]
    lanes = LaneModel(system)
    for copies in (1, 9):
        rows = np.repeat(lanes.row()[None], copies, axis=0)
        found = flexible.native_deflection(lanes, rows, time, 2.5e-4)
        assert flexible.error(found, np.asarray(wanted)) < 1e-4


def test_unknown_benchmark_is_refused_before_anything_runs() -> None:
    with pytest.raises(InputError, match="single_calls"):
        next(bench.run(["single_calls"]))
    assert bench.select(["batch"]) == {"batch": bench.BENCHMARKS["batch"].rows}
    assert bench.select(["*_batch_two_threads"])["batch"] == tuple(
        f"{what}_batch_two_threads" for what in ("forward_dynamics", "inverse_dynamics", "mass_matrix")
    )
    assert bench.select(["forward_dynamics_b*", "startup_help"]) == {
        "batch": ("forward_dynamics_batch", "forward_dynamics_batch_two_threads"),
        "startup": ("startup_help",),
    }
    assert "suite" not in bench.select()
    assert peers.Options(quick=True).sizes((1, 50, 200)) == (1, 50)


def test_a_second_thread_is_told_with_what_it_had_of_the_machine() -> None:
    calls = []
    row = two_threads("x", 3, lambda: calls.append(1), lambda: calls.append(2), items=10, rounds=3, note="here")
    assert (row.what, row.n, row.wanted) == ("x", 3, 1.8)
    assert set(calls) == {1, 2}
    assert row.note.startswith("here; ")
    assert re.search(r"took \d+\.\d\d times the processor time .* had \d+% of two cores$", row.note)


def test_every_benchmark_has_its_file() -> None:
    from importlib import import_module

    for name in bench.BENCHMARKS:
        module = import_module(f"harness.compare.bench.{name}")
        assert callable(module.run)
        assert module.__doc__


def test_growth_of_closed_mechanisms_is_told_by_exponents_and_sizes() -> None:
    pytest.importorskip("pinocchio")
    rows = list(loop_scaling.run(bench.Options(quick=True, rounds=1)))
    assert [row.what for row in rows if row.unit == "1"] == ["loop_tree_exponent", "loop_count_exponent"]
    sizes = {row.case: [r.n for r in rows if r.case == row.case and r.n] for row in rows}
    # N four-bars have N + 1 cranks and N bars.
    assert sizes == {"a chain of n joints with one loop": [10, 30, 50], "N four-bars side by side": [5, 11, 21]}
    assert {row.what for row in rows} == set(bench.BENCHMARKS["loop_scaling"].rows)


def test_the_ring_of_a_chain_is_closed_where_it_is_measured() -> None:
    model = harness.Denoc(loop_scaling.ring(12))
    assert np.abs(model.open_by(np.zeros(12))).max() < 1e-12
    assert len(model.conditions) == 3
