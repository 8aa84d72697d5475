"""A servo that is softer than its model: told as that, by its command and its feedback alike. Truth: MuJoCo with another kp."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import harness
from harness.diagnose.answer.augmented import attached
from harness.diagnose.problem.acting import acting
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis, compatible
from harness.effects.attach import apply, input_chain
from harness.effects.lanes import lane_model, lane_row
from harness.engines.expressed import described
from harness.errors import InputError, UnsupportedError
from harness.recording import Recording, read_recording
from harness.system import Attachment, System

ARM = """<mujoco><option timestep="0.0005" integrator="RK4"/><worldbody>{bodies}</worldbody>
<actuator>{drives}</actuator></mujoco>"""
UPPER = """<body name="arm"><joint name="pivot" axis="0 1 0" damping="0.06" frictionloss="{rub}" armature="0.01"/>
<inertial pos="0 0 -.2" mass=".8" diaginertia=".008 .008 .001"/>{more}</body>"""
LOWER = """<body name="fore" pos="0 0 -.3"><joint name="elbow" axis="0 1 0" damping="0.05" frictionloss="{rub}" armature="0.006"/>
<inertial pos="0 0 -.13" mass=".5" diaginertia=".004 .004 .0005"/></body>"""
KP, TRUE, NOISE = 15.0, 0.85, 5e-4


def written(
    kp: float = 1.0,
    kv: float = 1.0,
    more: str = "",
    kind: str = "position",
    rub: float = 0.04,
    elbow: float | None = None,
) -> str:
    """An arm with its servo's stiffness and damping so many times as large; elbow: dry friction of a second joint, with a servo."""
    drives = {
        "position": f'<position name="a" joint="pivot" kp="{kp * KP}" kv="{kv * 0.4}" {more}/>',
        "velocity": '<velocity name="a" joint="pivot" kv="2"/>',
        "motor": '<motor name="a" joint="pivot" gear="2"/>',
    }[kind]
    below = ""
    if elbow is not None:
        below, drives = (
            LOWER.format(rub=elbow),
            drives + f'<position name="b" joint="elbow" kp="{kp * 9.0}" kv="{kv * 0.25}"/>',
        )
    return ARM.format(bodies=UPPER.format(rub=rub, more=below), drives=drives)


def recorded(folder: Path, model: str, seed: int, noise: float, system: System, seconds: float = 8.0) -> Recording:
    """Commands that are held for 10 ms each, and the angles that MuJoCo's own steps of the file make of them."""
    theirs, random = mujoco.MjModel.from_xml_string(model), np.random.default_rng(seed)
    data, rows = mujoco.MjData(theirs), []
    size, rate, phase = (random.uniform(a, b, (theirs.nu, 3)) for a, b in ((0.2, 0.6), (1.2, 7.5), (0.0, 6.3)))
    for k in range(round(100 * seconds)):
        data.ctrl[:] = np.sum(size * (np.sin(rate * k / 100.0 + phase) - np.sin(phase)), axis=1)
        rows.append((k / 100.0, *(data.qpos + noise * random.standard_normal(theirs.nq)), *data.ctrl))
        mujoco.mj_step(theirs, data, 20)
    file = folder / f"run{seed}.csv"
    names = [
        *(f"{name}.position" for name in system.joint_names),
        *(f"{a.name}.command" for a in system.actuators or ()),
    ]
    motors = ["pivot.command"] if not system.actuators else []
    np.savetxt(file, rows, delimiter=",", header=",".join(["time", *names, *motors]), comments="", fmt="%.12g")
    return read_recording(file, system=system)


def loaded(folder: Path, model: str) -> System:
    (folder / "arm.xml").write_text(model)
    return harness.load(folder / "arm.xml")


@pytest.mark.parametrize(("reach", "allowed"), [("", 1e-6), ('forcerange="-3 3"', 1e-4)], ids=["free", "bounded"])
@pytest.mark.parametrize(("effect", "kv"), [("servo_gain", 1.0), ("servo_torque", TRUE)])
def test_a_servo_that_is_off_moves_the_arm_as_in_mujoco(
    tmp_path: Path, reach: str, allowed: float, effect: str, kv: float
) -> None:
    system = loaded(tmp_path, written(more=reach, rub=0.0))
    read = recorded(tmp_path, written(TRUE, kv, more=reach, rub=0.0), 1, 0.0, system, 4.0)
    whole, (driven,) = acting(system, [read])
    gain = Attachment(effect, "pivot", {"gain": TRUE})
    for changed in (apply(whole, gain), attached(whole, [gain]), described(attached(whole, [gain]))):
        # What is left of it is the command's share, so that nothing acts twice.
        assert [a.effect for a in changed.attachments] == ["actuator_gain"]
        ((law, kept),) = input_chain(changed.attachments, "pivot")
        assert law.input is not None
        tau = law.input.apply(driven.efforts[0].values[None], read.time, law.values(kept.parameters)[None]).T
        lanes = lane_model(changed)
        start = read.channels[0].values[:1]
        run = lanes.simulate(lane_row(lanes, changed), start, np.zeros(1), read.time, tau=tau, hold="zero")[0][0, :, 0]
        assert np.abs(run - read.channels[0].values).max() < allowed


@pytest.mark.parametrize(
    ("kp", "kv", "effect"), [(TRUE, 1.0, "servo_gain"), (TRUE, TRUE, "servo_torque"), (1.0, 1.0, "")]
)
def test_a_servo_that_is_off_is_told_by_what_of_it_is_and_a_right_one_is_not(
    tmp_path: Path, kp: float, kv: float, effect: str
) -> None:
    system = loaded(tmp_path, written())
    runs = [recorded(tmp_path, written(kp, kv), seed, NOISE, system) for seed in range(3)]
    found = harness.diagnose(runs, tmp_path / "arm.xml", fit_effort=True)
    if not effect:
        assert found.verdict == "consistent" and not found.findings
        return
    (told,) = found.findings
    assert found.verdict == "explained" and told["effect"] == effect and told["grade"] == "established"
    low, high = told["parameters"]["gain"]["ci95"]
    assert low <= TRUE <= high and high - low < 0.06


def test_servos_of_two_joints_are_told_together_and_no_load_in_their_place(tmp_path: Path) -> None:
    system = loaded(tmp_path, written(elbow=0.0))
    runs = [recorded(tmp_path, written(TRUE, elbow=0.06), seed, NOISE, system) for seed in range(3)]
    found = harness.diagnose(runs, tmp_path / "arm.xml", fit_effort=True)
    told = {(f["effect"], f["site"]): next(iter(f["parameters"].values()))["ci95"] for f in found.findings}
    assert set(told) == {("servo_gain", "pivot"), ("servo_gain", "elbow"), ("coulomb_friction", "elbow")}
    for (effect, _), (low, high) in told.items():
        true = TRUE if effect == "servo_gain" else 0.06
        assert low <= true <= high and high - low < 0.05, (effect, low, high)


def test_it_is_looked_for_where_a_servo_acts_by_its_command_and_not_beside_a_gain_of_that_alone(tmp_path: Path) -> None:
    asked = ("servo_gain", "servo_torque", "actuator_gain")
    for kind, told in (
        ("position", asked),
        ("velocity", ("servo_gain", "actuator_gain")),
        ("motor", ("actuator_gain",)),
    ):
        system = loaded(tmp_path, written(kind=kind))
        whole, read = acting(system, [recorded(tmp_path, written(kind=kind), 1, 0.0, system, 1.0)])
        known = {c.effect.name: c for c in candidates(whole, read, only=asked)}
        assert set(known) == set(told)
        for name in told:
            assert not any(compatible(Hypothesis((known[name],)), other) for other in known.values())
    off, read = acting(loaded(tmp_path, written()), read, actuators=False)
    assert not candidates(off, read, only=asked[:2])
    with pytest.raises(InputError, match="no servo acts"):
        apply(off, Attachment("servo_gain", "pivot", {"gain": TRUE}))


def test_a_drive_with_a_range_of_force_is_refused_by_fitted_efforts(tmp_path: Path) -> None:
    model = written(more='forcerange="-3 3"')
    run = recorded(tmp_path, model, 1, NOISE, loaded(tmp_path, model), 4.0)
    with pytest.raises(UnsupportedError, match="range of force"):
        harness.diagnose([run], tmp_path / "arm.xml", fit_effort=True)
