"""Efforts as the measurement: recordings made by MuJoCo, with physics and pushes that model and effort column know nothing of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from driven_arm import COM, INERTIA, MASS, URDF, arm

from harness.diagnose.diagnose import diagnose
from harness.diagnose.inverse import effort
from harness.diagnose.inverse.band import cutoff_for, motion_noise
from harness.diagnose.inverse.effort_left import _memory
from harness.diagnose.inverse.effort_motion import effort_run
from harness.diagnose.inverse.pushes import find_pushes
from harness.diagnose.problem.deadline import TimeUp
from harness.errors import InputError
from harness.recording import Recording
from harness.recording.recording import Channel
from harness.system import System, load

RATE = 250.0


@pytest.fixture(scope="module")
def system(tmp_path_factory: pytest.TempPathFactory) -> System:
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(URDF, encoding="utf-8")
    return load(path)


def drive(seed: int) -> Callable[[float], float]:
    """Torque of five sines between 0.15 and 1.6 Hz [N·m]."""
    rng = np.random.default_rng(seed)
    frequency, phase = np.geomspace(0.15, 1.6, 5), rng.uniform(0.0, 2.0 * np.pi, 5)
    size = np.array([0.5, 0.6, 0.6, 0.5, 0.4])
    return lambda t: float(np.sum(size * np.sin(2.0 * np.pi * frequency * t + phase)))


def recorded(
    seed: int,
    *,
    duration: float = 16.0,
    damping: float = 0.0,
    friction: float = 0.0,
    factor: float = 1.0,
    push: tuple[float, float, float] | None = None,
    noise: float = 2e-4,
    effort_noise: float = 0.02,
) -> Recording:
    """An arm driven in MuJoCo; factor: recorded over applied torque; push: from, to [s] and torque [N·m] that nobody records."""
    model = arm(friction=friction, damping=damping)
    data = mujoco.MjData(model)
    torque = drive(seed)
    every = round(1.0 / (RATE * model.opt.timestep))
    time, position, effort = [], [], []
    for k in range(round(duration / model.opt.timestep)):
        # MuJoCo holds it over the step, so it is taken from the middle; half a step late would be found as a delay.
        applied = torque(data.time + 0.5 * model.opt.timestep)
        if k % every == 0:
            time.append(data.time)
            position.append(float(data.qpos[0]))
            effort.append(torque(data.time))
        outside = push[2] if push and push[0] <= data.time < push[1] else 0.0
        data.qfrc_applied[0] = applied + outside
        mujoco.mj_step(model, data)
    rng = np.random.default_rng(seed + 1000)
    q = np.array(position) + noise * rng.standard_normal(len(position))
    u = factor * np.array(effort) + effort_noise * rng.standard_normal(len(effort))
    return Recording(
        f"run{seed}",
        f"run{seed}.csv",
        np.array(time),
        (Channel("pivot.position", "pivot", "position", "rad", q),),
        (Channel("pivot.effort", "pivot", "effort", "N*m", u),),
    )


def test_nothing_missing_is_consistent(system: System) -> None:
    found = diagnose([recorded(1), recorded(2)], system, fit_effort=True)
    assert found.verdict == "consistent"
    assert not found.findings
    assert not [n for n in found.quality if n["kind"] == "outside_push"]


def test_dry_friction_is_named_from_efforts(system: System) -> None:
    found = diagnose([recorded(3, friction=0.11), recorded(4, friction=0.11)], system, fit_effort=True)
    finding = next(f for f in found.findings if f["effect"] == "coulomb_friction")
    # As concealed; the few per cent are reversals that the low-pass rounds.
    assert finding["parameters"]["torque"]["value"] == pytest.approx(0.11, rel=0.06)
    assert len(found.findings) == 1
    fit = found.fit[0]
    assert fit["channel"] == "pivot.effort"
    assert fit["augmented"]["heldout_rmse"] < 0.25 * fit["nominal"]["heldout_rmse"]


@pytest.mark.parametrize(
    ("physics", "told", "number", "grade"),
    [
        ({"damping": 0.04}, "viscous_damping", "coefficient", "established"),
        # Friction that falls with speed may be in its place.
        ({"friction": 0.11}, "coulomb_friction", "torque", "likely"),
    ],
)
def test_what_repeats_without_each_recording(
    system: System, physics: dict[str, float], told: str, number: str, grade: str
) -> None:
    found = diagnose([recorded(seed, **physics) for seed in (3, 4, 7)], system, fit_effort=True)
    (finding,) = found.findings
    assert (finding["effect"], finding["grade"]) == (told, grade)
    rows = finding["repeatability"]
    assert [row["recording"] for row in rows] == ["run3", "run4", "run7"]
    (true,) = physics.values()
    for row in rows:
        low, high = row["parameters"][number]["ci95"]
        assert low < row["parameters"][number]["value"] < high
        assert row["parameters"][number]["value"] == pytest.approx(true, rel=0.06)
    assert found.explained_share == pytest.approx(1.0, abs=0.1)


def test_what_is_left_of_efforts_is_told_as_a_force(system: System) -> None:
    runs = [recorded(seed, friction=0.11) for seed in (3, 4, 7)]
    found = diagnose(runs, system, fit_effort=True, only=("viscous_damping",))
    assert found.verdict == "partly_explained"
    (left,) = found.discrepancy
    # Of a friction of 0.11 N·m a line through its speeds leaves less than all and more than a quarter.
    assert 0.25 * 0.11 < left["size"] < 0.11
    assert left["share"] == pytest.approx(left["size"] / (9.81 * MASS * COM), rel=1e-3)
    # A line through friction's speeds leaves a little everywhere.
    assert "place" not in left
    assert f"a force of {left['size']:.2g} N·m at pivot" in found.summary


@pytest.mark.parametrize("memory", [5.0, 40.0])
def test_a_force_keeps_for_as_long_as_its_correlation(memory: float) -> None:
    rng, course = np.random.default_rng(2), [0.0]
    share = np.exp(-1.0 / memory)
    for push in rng.standard_normal(60_000):
        course.append(share * course[-1] + push)
    # Ornstein and Uhlenbeck's process forgets to 1/e over its time constant.
    assert _memory([np.array(course)]) == pytest.approx(memory, rel=0.1, abs=1.0)


def test_viscous_damping_is_named_from_efforts(system: System) -> None:
    found = diagnose([recorded(5, damping=0.04), recorded(6, damping=0.04)], system, fit_effort=True)
    assert [f["effect"] for f in found.findings] == ["viscous_damping"]
    values = found.findings[0]["parameters"]["coefficient"]
    assert values["value"] == pytest.approx(0.04, rel=0.05)


def test_intervals_hold_the_truth(system: System) -> None:
    misses = []
    for seed in range(100, 112, 2):
        runs = [recorded(seed, damping=0.04), recorded(seed + 1, damping=0.04)]
        found = diagnose(runs, system, fit_effort=True, only=("viscous_damping",))
        values = found.findings[0]["parameters"]["coefficient"]
        misses.append((values["value"] - 0.04) / values["std"])
    # χ² of six degrees of freedom exceeds 18.5 once in two hundred times.
    assert float(np.sum(np.square(misses))) < 18.5
    assert float(np.sum(np.square(misses))) > 0.5


def test_effort_that_reads_high_is_a_gain(system: System) -> None:
    # A gain scales inertia and gravity alike, and so, but for little, does more mass at the tip: evidence parts them by two, and
    # which is named is the one that is likelier to be so large.
    found = diagnose([recorded(7, factor=1.2), recorded(8, factor=1.2)], system, fit_effort=True)
    (finding,) = found.findings
    named = {finding["effect"], *(other.split("@")[0] for other in finding["indistinguishable_from"])}
    assert named == {"actuator_gain", "payload_mass"}
    gain = diagnose(
        [recorded(7, factor=1.2), recorded(8, factor=1.2)], system, fit_effort=True, only=("actuator_gain",)
    )
    assert gain.findings[0]["parameters"]["gain"]["value"] == pytest.approx(1.0 / 1.2, rel=0.02)
    assert gain.augmented is not None
    assert gain.augmented.attachments[0].effect == "actuator_gain"


def test_a_push_that_nobody_records_is_told_and_left_out(system: System) -> None:
    runs = [recorded(9, friction=0.11, push=(6.0, 6.4, 2.5)), recorded(10, friction=0.11)]
    found = diagnose(runs, system, fit_effort=True)
    notes = [n for n in found.quality if n["kind"] == "outside_push"]
    assert len(notes) == 1
    assert notes[0]["recording"] == "run9"
    assert "from 6.0" in notes[0]["what"] or "from 5.9" in notes[0]["what"]
    assert "+2." in notes[0]["what"]  # of +2.5 N·m, rounded off by the low-pass
    finding = next(f for f in found.findings if f["effect"] == "coulomb_friction")
    assert finding["parameters"]["torque"]["value"] == pytest.approx(0.11, rel=0.06)
    assert found.verdict == "partly_explained"  # the push is no part of any model


def test_no_push_is_seen_where_a_whole_recording_is_strange(system: System) -> None:
    # Forces beyond any ordinary one for most of the time are the model's fault, not a passer-by's.
    run = recorded(11)
    strange = 3.0 * np.sin(7.0 * run.time) ** 3
    run = replace(run, efforts=(replace(run.efforts[0], values=run.efforts[0].values + strange),))
    assert find_pushes(system, [effort_run(system, run, 4.0)]) == ()


def test_cutoff_falls_with_the_noise_of_the_angle(system: System) -> None:
    swing = np.sqrt(MASS * 9.81 * COM / (INERTIA + MASS * COM**2)) / (2.0 * np.pi)
    quiet, loud = recorded(12, noise=1e-4), recorded(12, noise=5e-3)
    assert cutoff_for(system, loud, swing) < cutoff_for(system, quiet, swing)
    # ∫₀^f (2πf)⁴ 2σ²Δt df: the noise that twice differentiated white noise leaves below f.
    expected = 5e-3 * np.sqrt(2.0 / RATE * (2.0 * np.pi) ** 4 * 3.0**5 / 5.0)
    assert motion_noise(loud, "pivot", 3.0, 2) == pytest.approx(expected, rel=0.1)


def test_what_cannot_be_fitted_is_refused_by_name(system: System) -> None:
    run = recorded(13, duration=8.0)
    with pytest.raises(InputError, match="no effort"):
        diagnose([replace(run, efforts=())], system, fit_effort=True)
    speed = Channel("pivot.velocity", "pivot", "velocity", "rad/s", np.gradient(run.channels[0].values, run.time))
    with pytest.raises(InputError, match="not measured"):
        diagnose([replace(run, channels=(speed,))], system, fit_effort=True)
    with pytest.raises(InputError, match="cannot be weighed from efforts"):
        diagnose([run], system, fit_effort=True, only=("dahl_friction",))


def test_written_answer_can_be_read_again(system: System, tmp_path: Path) -> None:
    from harness.report.diagnosis import write_diagnosis

    found = diagnose([recorded(14, friction=0.11)], system, fit_effort=True)
    paths = write_diagnosis(found, tmp_path / "out")
    models = {"augmented.toml", "augmented.urdf", "augmented.xml"}
    assert {p.name for p in paths} == {"diagnosis.json", "report.html"} | models
    again = load(tmp_path / "out" / "augmented.toml")
    assert any(a.effect == "coulomb_friction" for a in again.attachments)


def test_the_right_joint_of_two_is_named(tmp_path: Path) -> None:
    text = """<robot name="two"><link name="base"/>
    <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
    <link name="upper"><inertial><origin xyz="0 0 -0.15"/><mass value="0.8"/>
    <inertia ixx="0.006" iyy="0.006" izz="0.0002" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/>
    <origin xyz="0 0 -0.3"/><axis xyz="0 1 0"/></joint>
    <link name="lower"><inertial><origin xyz="0 0 -0.1"/><mass value="0.4"/>
    <inertia ixx="0.002" iyy="0.002" izz="0.0001" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
    (tmp_path / "two.urdf").write_text(text, encoding="utf-8")
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><option timestep="0.0005" integrator="RK4"><flag contact="disable"/></option><worldbody><body>
        <joint type="hinge" axis="0 1 0" damping="0.05"/>
        <inertial pos="0 0 -0.15" mass="0.8" diaginertia="0.006 0.006 0.0002"/>
        <body pos="0 0 -0.3"><joint type="hinge" axis="0 1 0" damping="0.012"/>
        <inertial pos="0 0 -0.1" mass="0.4" diaginertia="0.002 0.002 0.0001"/></body></body></worldbody></mujoco>"""
    )
    runs = []
    for seed in (31, 32):
        data = mujoco.MjData(model)
        first, second = drive(seed), drive(seed + 50)
        rows = []
        for k in range(24000):
            middle = data.time + 0.5 * model.opt.timestep
            if k % 8 == 0:
                rows.append([data.time, *data.qpos, 0.8 * first(data.time), 0.25 * second(data.time)])
            data.qfrc_applied[:] = 0.8 * first(middle), 0.25 * second(middle)
            mujoco.mj_step(model, data)
        table = np.array(rows)
        noise = np.random.default_rng(seed).standard_normal((len(table), 4)) * np.array([1e-4, 1e-4, 0.01, 0.004])
        table[:, 1:] += noise
        joints = ("shoulder", "elbow")
        runs.append(
            Recording(
                f"run{seed}",
                f"run{seed}.csv",
                table[:, 0],
                tuple(Channel(f"{n}.position", n, "position", "rad", table[:, 1 + j]) for j, n in enumerate(joints)),
                tuple(Channel(f"{n}.effort", n, "effort", "N*m", table[:, 3 + j]) for j, n in enumerate(joints)),
            )
        )
    # The shoulder's damping is known, the elbow's is not.
    known = load(tmp_path / "two.urdf")
    known = known.replace_joint(replace(known.joint("shoulder"), damping=0.05))
    found = diagnose(runs, known, fit_effort=True, only=("viscous_damping", "coulomb_friction", "quadratic_drag"))
    assert [(f["effect"], f["site"]) for f in found.findings] == [("viscous_damping", "elbow")]
    assert found.findings[0]["parameters"]["coefficient"]["value"] == pytest.approx(0.012, rel=0.05)
    assert found.verdict == "explained"


def test_too_little_motion_for_the_smoothing_is_a_line(system, monkeypatch):
    """Two periods at either end are left out: at 0.2 Hz nothing is left of 16 s."""
    monkeypatch.setattr(effort, "band", lambda *_: 0.2)
    with pytest.raises(InputError, match="nothing can be compared"):
        diagnose([recorded(1), recorded(2)], model=system, fit_effort=True)


def test_a_noise_that_the_time_was_up_for_costs_no_finding(system: System, monkeypatch: pytest.MonkeyPatch) -> None:
    def up(*_: object) -> None:
        raise TimeUp

    monkeypatch.setattr(effort, "noises_beside", up)
    runs = [recorded(seed, friction=0.1) for seed in (1, 2)]
    found = diagnose(runs, system, fit_effort=True, only=("coulomb_friction", "viscous_damping"))
    assert [f["effect"] for f in found.findings] == ["coulomb_friction"]
    assert any("noise of the efforts" in left.what for left in found.not_tried)
