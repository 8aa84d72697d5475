"""When the time is up the best answer so far is told, with what was not tried, and never a firmer one than the work done."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from simulated_recordings import ARM, Rig, nominal, recording, releases
from test_friction_between_recordings import LEVELS, drops

from harness.cases.single_run import run_once
from harness.diagnose.claims import conclude as conclusions
from harness.diagnose.diagnose import diagnose
from harness.diagnose.problem import deadline as module
from harness.diagnose.problem.deadline import Deadline, Stage, TimeUp
from harness.recording import Channel, Recording
from harness.system import Attachment, System, load
from harness.system.description import constant

FIRM = ("explained", "consistent")
UNJUDGED, UNCRITICISED, UNSEARCHED = (
    "the judgement on data held out",
    "all tests of what is left",
    "sets of effects beyond",
)
FEW = ("coulomb_friction", "viscous_damping", "constant_torque")
LATEST = 5.0  # s after the limit


class After(Deadline):
    """Over in one stage from its ``count``-th question on; the others have their time. asked: questions in every stage."""

    def __init__(self, ending: Stage, count: float = np.inf) -> None:
        super().__init__()
        self.ending, self.count, self.now = ending, count, Stage.SEARCH
        self.asked = dict.fromkeys(Stage, 0)

    def begin(self, stage: Stage) -> None:
        super().begin(stage)
        self.now = stage

    def check(self) -> None:
        if not module._spared.get():
            self.asked[self.now] += 1
            if self.now == self.ending and self.asked[self.now] >= self.count:
                raise TimeUp


@pytest.fixture(scope="module")
def swings() -> list[Recording]:
    return releases(Rig(dry=0.01), (0.9, 0.6), noise=1e-3, seed=3, duration=6.0, rate=50.0)


@pytest.mark.slow
def test_there_is_an_answer_wherever_the_time_is_up(swings: list[Recording]) -> None:
    asked = After(Stage.SEARCH)
    whole = diagnose(swings, nominal(), only=FEW, time_limit=asked)
    assert whole.complete and whole.verdict == "explained"
    assert whole.to_json()["complete"] is True and "not_tried" not in whole.to_json()
    for stage, share, expected in (
        (Stage.SEARCH, 0.0, UNSEARCHED),
        (Stage.SEARCH, 0.5, UNSEARCHED),
        (Stage.RIVALS, 0.5, "all that could stand in the place"),
        (Stage.CRITICISM, 0.0, UNJUDGED),
        (Stage.TELLING, 0.0, "in which a parameter may lie"),
    ):
        found = diagnose(swings, nominal(), only=FEW, time_limit=After(stage, share * asked.asked[stage]))
        document = found.to_json()
        what = " ".join(note["what"] for note in document["not_tried"])
        assert document["complete"] is False and expected in what
        assert all(note["may_change"] for note in document["not_tried"])
        assert "time was up" in found.summary
        if UNJUDGED in what:
            assert not found.findings and found.verdict == "unexplained"
        elif stage > Stage.SEARCH:
            assert [f["effect"] for f in found.findings] == ["coulomb_friction"] and found.verdict == "explained"
        else:
            assert found.verdict != "consistent"


def test_what_was_not_criticised_explains_no_more_than_partly(
    swings: list[Recording], monkeypatch: pytest.MonkeyPatch
) -> None:
    def up(*_: object) -> None:
        raise TimeUp

    monkeypatch.setattr(conclusions, "_remains", up)
    found = diagnose(swings, nominal(), only=FEW)
    assert [f["effect"] for f in found.findings] == ["coulomb_friction"] and found.verdict == "partly_explained"
    assert any(UNCRITICISED in note.what for note in found.not_tried)
    assert "has not been examined to the end" in found.summary


def read(system: System, attached: list[Attachment], k: int, tau: np.ndarray | None, **of: float) -> Recording:
    """A recording of positions in which the system has something attached that the model does not."""
    rng, rate, duration = np.random.default_rng(k), of.pop("rate"), of.pop("duration")
    stamps = np.arange(0.0, duration, 1.0 / rate)
    columns = run_once(
        replace(system, attachments=tuple(attached)), stamps, of, {}, engine="denoc",
        tau=None if tau is None else tau[: len(stamps)],
    ).columns  # fmt: skip
    return recording(
        f"run{k}",
        stamps,
        {
            **{n: np.asarray(v) + 1e-3 * rng.standard_normal(len(stamps)) for n, v in columns.items() if n.endswith("position")},
            **({} if tau is None else {f"{j}.effort": tau[:, i] for i, j in enumerate(system.joint_names)}),
        },
    )  # fmt: skip


def driven() -> tuple[System, list[Recording]]:
    """A driven double pendulum, 3 × 5 s at 500 Hz."""
    system = load("models/urdf/double_pendulum.urdf", physical=False)
    stamps = np.arange(0.0, 5.0, 1.0 / 500.0)
    tau = np.stack([3.0 * np.sin(4.0 * stamps), 1.2 * np.sin(6.0 * stamps + 1.0)], axis=1)
    rubs = [
        Attachment("coulomb_friction", "elbow", {"torque": 0.08}),
        Attachment("cogging_torque", "shoulder", {"amplitude": 0.1, "periods": 4.0, "phase": 0.3}),
    ]
    return system, [read(system, rubs, k, tau, shoulder=0.4 * (k - 1), rate=500.0, duration=5.0) for k in range(3)]


def decay() -> tuple[System, list[Recording]]:
    """A pendulum that comes to rest, 95 s at 100 Hz."""
    system = load("models/urdf/rigid_pendulum.urdf", physical=False)
    rubs = [
        Attachment("quadratic_drag", "pivot", {"coefficient": 0.02}),
        Attachment("dahl_friction", "pivot", {"torque": 0.03, "stiffness": 2.0}),
    ]
    return system, [read(system, rubs, 0, None, pivot=1.2, rate=100.0, duration=95.0)]


def arm() -> tuple[System, list[Recording]]:
    """A flexible arm, 3 × 10 s at 1 kHz."""
    system = load("models/toml/flexible_pendulum.toml", physical=False)
    rubs = [Attachment("viscous_damping", "pivot", {"coefficient": 2e-4})]
    return system, [read(system, rubs, k, None, pivot=0.3 * (k + 1), rate=1000.0, duration=10.0) for k in range(3)]


@pytest.mark.slow
@pytest.mark.parametrize("make", [driven, decay, arm])
def test_the_limit_is_kept(make) -> None:
    """None of these is done in so little time."""
    system, recordings = make()
    diagnose(recordings, system, time_limit=0.1)  # kernels are compiled once
    limit = 3.0
    before = time.monotonic()
    found = diagnose(recordings, system, time_limit=limit)
    assert time.monotonic() - before < limit + LATEST
    assert not found.complete
    assert found.verdict not in FIRM or not {UNJUDGED, UNCRITICISED} & {n.what for n in found.not_tried}


def test_efforts_are_answered_in_time_too(swings: list[Recording]) -> None:
    stamps = swings[0].time
    push = Channel("pivot.effort", "pivot", "effort", "N*m", constant(0.3 * np.sin(stamps)))
    pushed = [replace(run, efforts=(push,)) for run in swings]
    found = diagnose(pushed, nominal(), fit_effort=True, time_limit=1e-3)
    assert not found.complete and found.verdict == "unexplained" and not found.findings
    assert "time was up" in found.summary


INTERRUPTED = """
import os, signal, sys
sys.path.insert(0, {here!r})
from simulated_recordings import Rig, nominal, releases
from harness.cli.interrupt import answers_to_interrupt
from harness.diagnose.claims import conclude as conclusions
from harness.diagnose.diagnose import diagnose
from harness.diagnose.problem.deadline import Deadline
swings = releases(Rig(dry=0.01), (0.9, 0.6), noise=1e-3, seed=3, duration=6.0, rate=50.0)
deadline = Deadline()
def progress(done, total, what):
    if done == 4:
        for _ in range({times}):
            os.kill(os.getpid(), signal.SIGINT)
try:
    with answers_to_interrupt(deadline.interrupt):
        found = diagnose(swings, nominal(), progress=progress, time_limit=deadline)
except KeyboardInterrupt:
    print("stopped")
else:
    print("complete" if found.complete else "so far")
"""


@pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGINT to send")
@pytest.mark.parametrize(("times", "outcome"), [(1, "so far"), (2, "stopped")])
def test_the_first_interrupt_is_answered_and_the_second_ends(times: int, outcome: str) -> None:
    child = subprocess.run(
        [sys.executable, "-c", INTERRUPTED.format(here=str(Path(__file__).parent), times=times)],
        capture_output=True, text=True, timeout=120, check=False,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    assert child.returncode == 0, child.stderr
    assert child.stdout.strip() == outcome


class Gone(After):
    """Over for good from its ``count``-th question of a stage on, for what is spared for a while, too."""

    @property
    def over(self) -> bool:
        return self.now > self.ending or (self.now == self.ending and self.asked[self.now] >= self.count)

    def check(self) -> None:
        if module._spared.get() is module.Spared.TO_ITS_END:
            return
        self.asked[self.now] += 1
        if self.over:
            raise TimeUp


@pytest.mark.slow
@pytest.mark.parametrize("stage", Stage)
@pytest.mark.parametrize("share", [0.02, 0.3, 0.6, 0.9])
def test_a_rig_that_leaves_a_force_out_has_an_answer_wherever_the_time_is_up(
    stage: Stage, share: float, tmp_path: Path
) -> None:
    model = tmp_path / "arm.toml"
    model.write_text(ARM)
    asked = Gone(Stage.TELLING)
    named = ("viscous_damping", "coulomb_friction", "payload_mass")
    diagnose(drops(LEVELS), model, only=named, time_limit=asked)
    found = diagnose(drops(LEVELS), model, only=named, time_limit=Gone(stage, share * asked.asked[stage]))
    assert not found.complete and "time was up" in found.summary
    assert found.verdict in ("unexplained", "partly_explained")
    assert all(finding["grade"] != "established" for finding in found.findings)
