"""The runner: verdicts, broken engines, missing engines, order, users' models."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.cases import Results, validate
from harness.cases.case import Bench, Case
from harness.cases.checks import FrequencyTruth, StateAgreement, TrajectoryAgreement
from harness.cases.pendulums import paper_inertia, paper_pendulum, paper_restoring, paper_small_frequency
from harness.cases.results import from_dict, read_results
from harness.cases.run import run_case
from harness.cases.users import names_of
from harness.errors import EngineUnavailableError, InputError, UnsupportedError
from harness.system import Trajectory

WHY = "closed form"


@dataclass
class Pendulum:
    """The paper's pendulum by hand: J q'' = τ − G sin q; ``gravity_factor`` spoils it."""

    names: tuple[str, ...] = ("pivot",)
    gravity_factor: float = 1.0
    nan: bool = False

    def forward_dynamics(self, q, qd, tau):
        if self.nan:
            return np.full(1, np.nan)
        return (np.asarray(tau) - self.gravity(q)) / paper_inertia()

    def inverse_dynamics(self, q, qd, qdd):
        return paper_inertia() * np.asarray(qdd) + self.gravity(q)

    def mass_matrix(self, q):
        return np.array([[paper_inertia()]])

    def bias(self, q, qd):
        return self.gravity(q)

    def gravity(self, q):
        return self.gravity_factor * paper_restoring() * np.sin(q)

    def energy(self, q, qd):
        return 0.5 * paper_inertia() * float(qd[0]) ** 2, -paper_restoring() * math.cos(q[0])

    def simulate(self, q0, qd0, time, *, tau=None, step=None):
        """Small swings about the bottom: q0 cos ωt."""
        omega = 2.0 * math.pi * paper_small_frequency() * math.sqrt(self.gravity_factor)
        position = q0[0] * np.cos(omega * time)[:, None]
        return Trajectory(time, self.names, position, -q0[0] * omega * np.sin(omega * time)[:, None])

    def frequencies(self, q):
        return np.array([paper_small_frequency() * math.sqrt(self.gravity_factor)])


@dataclass
class Fake:
    name: str
    model: Any = None
    missing: str = ""
    refusal: str | None = None
    crash: str = ""

    def version(self):
        if self.missing:
            raise EngineUnavailableError(self.missing)
        return "1"

    def refuses(self, system):
        return self.refusal

    def build(self, system):
        if self.crash:
            raise RuntimeError(self.crash)
        return self.model or Pendulum()


def case(*checks, engines=None):
    return Case("swing", "a swing", "by hand", paper_pendulum, checks, engines=engines)


def rows_of(a_case, *engines):
    return run_case(a_case, {engine.name: engine for engine in engines}).rows


ACCELERATION = StateAgreement("acceleration", 1e-12, WHY)


def test_engines_that_agree_pass():
    (row,) = rows_of(case(ACCELERATION), Fake("denoc"), Fake("other"))
    assert (row.verdict, row.engines, row.quantity) == ("pass", ("denoc", "other"), "acceleration")
    assert row.why_allowed == WHY


def test_the_odd_one_out_is_named_with_where_and_why():
    spoiled = Fake("wrong", Pendulum(gravity_factor=1.001))
    rows = rows_of(case(ACCELERATION), Fake("denoc"), spoiled, Fake("third"))
    verdicts = {row.engines[1]: row.verdict for row in rows}
    assert verdicts == {"wrong": "fail", "third": "pass"}
    failed = next(row for row in rows if row.verdict == "fail")
    assert "odd one out: wrong" in failed.note
    assert "gravity is" in failed.note
    assert failed.first_divergence["coordinate"] == "pivot"


def test_what_is_not_a_number_never_passes():
    (row,) = rows_of(case(ACCELERATION), Fake("denoc"), Fake("other", Pendulum(nan=True)))
    assert row.verdict == "fail"
    assert "not a finite number" in row.note
    both = rows_of(case(ACCELERATION), Fake("denoc", Pendulum(nan=True)), Fake("other", Pendulum(nan=True)))
    assert all(row.verdict == "fail" for row in both)


def test_a_bench_row_with_nan_or_infinity_fails():
    bench = Bench(case(ACCELERATION), paper_pendulum(), {})
    assert bench.row("q", ("a", "b"), math.nan, 1.0, why=WHY).verdict == "fail"
    assert bench.row("q", ("a", "b"), math.inf, math.inf, why=WHY).verdict == "fail"
    assert bench.row("q", ("a", "b"), 1.0, 1.0, why=WHY).verdict == "pass"


def test_an_engine_that_is_not_installed_is_a_line_in_the_table():
    rows = rows_of(case(ACCELERATION), Fake("denoc"), Fake("absent", missing="pip install absent"), Fake("other"))
    assert [(row.engines[1], row.verdict) for row in rows] == [("other", "pass"), ("absent", "skipped")]
    assert rows[1].note == "pip install absent"


def test_an_engine_that_refuses_is_skipped_with_its_reason():
    rows = rows_of(case(ACCELERATION), Fake("denoc"), Fake("other", refusal="too long"))
    assert [(row.verdict, row.note) for row in rows] == [("skipped", "too long")]


def test_an_engine_that_breaks_fails_and_leaves_the_others_alone():
    rows = rows_of(case(ACCELERATION), Fake("denoc"), Fake("broken", crash="boom"), Fake("other"))
    found = {row.engines: (row.verdict, row.note) for row in rows}
    assert found[("denoc", "other")][0] == "pass"
    assert found[("broken",)] == ("fail", "RuntimeError: boom")


def test_a_check_that_breaks_fails_and_leaves_the_others_alone():
    rows = rows_of(
        case(TrajectoryAgreement(1e-8, WHY, position=(("elbow", 1.0),)), ACCELERATION), Fake("denoc"), Fake("x")
    )
    assert {row.quantity: row.verdict for row in rows} == {"trajectory": "fail", "acceleration": "pass"}


def test_a_quantity_an_engine_cannot_give_is_skipped():
    class Mute(Pendulum):
        def frequencies(self, q):
            raise UnsupportedError("no frequencies here")

    rows = rows_of(case(FrequencyTruth((paper_small_frequency(),), 1e-9, WHY)), Fake("denoc"), Fake("mute", Mute()))
    assert {row.engines[0]: row.verdict for row in rows} == {"denoc": "pass", "mute": "skipped"}


def test_frequencies_are_held_against_the_truth():
    wrong = Fake("wrong", Pendulum(gravity_factor=1.0 + 1e-4))
    rows = rows_of(case(FrequencyTruth((paper_small_frequency(),), 1e-6, WHY)), Fake("denoc"), wrong)
    assert {row.engines[0]: row.verdict for row in rows} == {"denoc": "pass", "wrong": "fail"}
    # f ∝ √g, so that 1e-4 in gravity is 0.5e-4 in frequency.
    assert next(row.difference for row in rows if row.engines[0] == "wrong") == pytest.approx(0.5e-4, rel=1e-3)


def test_a_trajectory_says_when_it_left_the_line_and_which_term_is_to_blame():
    check = TrajectoryAgreement(1e-4, WHY, position=(("pivot", 0.1),), duration=5.0)
    rows = rows_of(case(check), Fake("denoc"), Fake("wrong", Pendulum(gravity_factor=1.001)))
    (row,) = rows
    assert row.verdict == "fail"
    assert 0.0 < row.first_divergence["time"] < 5.0
    assert row.first_divergence["signal"] == "pivot"
    assert "gravity" in row.note


def test_only_the_engines_a_case_names_take_part():
    rows = rows_of(case(ACCELERATION, engines=("denoc", "chosen")), Fake("denoc"), Fake("chosen"), Fake("left out"))
    assert [row.engines for row in rows] == [("denoc", "chosen")]


def test_rows_do_not_depend_on_the_number_of_workers():
    names = ["chain_2", "chain_7", "tree_2"]
    alone = validate(cases=names, engines=["pinocchio"], workers=1)
    spread = validate(cases=names, engines=["pinocchio"], workers=2)
    # Where the allocator puts an array decides how it is vectorised, so differences that are rounding may differ by rounding;
    # everything else is the same, row by row.
    assert [replace(row, difference=0.0) for row in alone.rows] == [replace(row, difference=0.0) for row in spread.rows]
    for one, other in zip(alone.rows, spread.rows, strict=True):
        assert other.difference == pytest.approx(one.difference, abs=0.01 * one.allowed)
    assert alone.ok


def test_results_survive_their_file(tmp_path):
    results = validate(cases=["chain_2"], engines=["pinocchio"], workers=1)
    broken = replace(results.rows[0], difference=math.nan, verdict="fail")
    results = replace(results, rows=(*results.rows, broken))
    file = tmp_path / "results.json"
    file.write_text(results.to_text(), encoding="utf-8")
    again = read_results(tmp_path)
    assert again.rows[:-1] == results.rows[:-1]
    assert again.rows[-1].difference is None
    assert not again.ok
    assert again.versions == results.versions


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "not JSON"),
        ("[1, 2", "not JSON"),
        ('{"schema": "other/1", "rows": []}', "schema is 'other/1'"),
        ('{"schema": "denoc.results/1", "rows": [{"case": "x"}]}', "incomplete"),
        ("[]", "schema is None"),
    ],
)
def test_a_broken_results_file_is_one_line(tmp_path, text, words):
    file = tmp_path / "results.json"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words) as caught:
        read_results(file)
    assert str(file) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_results_of_nothing_are_not_well():
    assert not Results(()).ok
    assert not from_dict({"schema": "denoc.results/1", "rows": []}).ok


def test_users_models_are_compared(tmp_path):
    source = Path(__file__).parents[2] / "models" / "urdf" / "double_pendulum.urdf"
    results = validate([source], engines=["pinocchio", "mujoco"], workers=1)
    assert results.ok
    assert {row.quantity for row in results.rows} >= {
        "acceleration",
        "inverse_dynamics",
        "mass_matrix",
        "bias",
        "energy",
    }


def test_models_of_one_name_keep_apart(tmp_path):
    a, b, c = tmp_path / "a" / "arm.urdf", tmp_path / "b" / "arm.urdf", tmp_path / "b" / "arm.xml"
    assert list(names_of([a, b])) == ["a/arm", "b/arm"]
    assert len(names_of([b, c])) == 2
    assert len(names_of([a, a])) == 1


def test_bad_calls_are_refused():
    with pytest.raises(InputError, match="empty"):
        validate([])
    with pytest.raises(InputError, match="did you mean 'pinocchio'"):
        validate(cases=["chain_2"], engines=["pinochio"])
    with pytest.raises(InputError, match="no such file"):
        validate(["nowhere.urdf"])
