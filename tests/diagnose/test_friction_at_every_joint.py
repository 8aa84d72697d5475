"""Geared arms rub at every joint, and models of them say nothing of it: efforts are Pinocchio's, with laws added in closed form."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.diagnose import diagnose
from harness.diagnose.inverse import effort
from harness.diagnose.inverse.effort_fit import EffortFit
from harness.diagnose.inverse.effort_search import EffortStudy
from harness.diagnose.problem.deadline import Deadline, TimeUp
from harness.recording import Recording
from harness.recording.recording import Channel
from harness.system import System, load

Array = NDArray[np.float64]

JOINTS = ("shoulder", "upper", "elbow")
AXES = ("0 0 1", "0 1 0", "0 1 0")
VISCOUS, DRY = np.array([1.5, 2.5, 0.8]), np.array([1.0, 2.0, 0.6])  # N·m·s/rad, N·m
NOISE = 0.02  # N·m

LINKS = "".join(
    f"""<joint name="{name}" type="continuous"><parent link="l{k}"/><child link="l{k + 1}"/><origin xyz="0 0 {0.4 if k else 0.1}"/>
<axis xyz="{axis}"/></joint><link name="l{k + 1}"><inertial><origin xyz="0.02 0.01 0.2"/><mass value="{4.0 - k}"/>
<inertia ixx="0.05" iyy="0.06" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
    for k, (name, axis) in enumerate(zip(JOINTS, AXES, strict=True))
)
URDF = f'<robot name="arm"><link name="l0"/>{LINKS}</robot>'


@pytest.fixture(scope="module")
def system(tmp_path_factory: pytest.TempPathFactory) -> System:
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(URDF, encoding="utf-8")
    return load(path)


def moved(seed: int, time: Array) -> tuple[Array, Array, Array]:
    """Positions, velocities, accelerations (T, 3) of a Fourier series at every joint."""
    rng = np.random.default_rng(seed)
    w = 2.0 * np.pi * 0.15 * np.arange(1, 5)[None, :, None]
    size, phase = 0.5 * rng.uniform(0.4, 1.0, (1, 4, 3)) / w, rng.uniform(0.0, 2.0 * np.pi, (1, 4, 3))
    at = w * time[:, None, None] + phase
    return (
        np.sum(size * np.sin(at), axis=1) + np.array([0.0, 0.6, 0.9]),
        np.sum(size * w * np.cos(at), axis=1),
        -np.sum(size * w**2 * np.sin(at), axis=1),
    )


def recorded(seed: int, further: Array | float = 0.0) -> Recording:
    """A recording at 200 Hz; further: torque that nobody knows of (T, 3) [N·m]."""
    time = np.arange(0.0, 16.0, 0.005)
    q, v, a = moved(seed, time)
    robot = pin.buildModelFromXML(URDF)
    data = robot.createData()
    # Joints that go round have a cosine and a sine each.
    turned = np.stack([np.cos(q), np.sin(q)], axis=2).reshape(len(time), -1)
    torque = np.array([pin.rnea(robot, data, *row) for row in zip(turned, v, a, strict=True)])
    torque += VISCOUS * v + DRY * np.sign(v) + further
    rng = np.random.default_rng(seed + 1000)
    positions = [
        Channel(f"{name}.position", name, "position", "rad", q[:, j] + 2e-5 * rng.standard_normal(len(time)))
        for j, name in enumerate(JOINTS)
    ]
    efforts = [
        Channel(f"{name}.effort", name, "effort", "N*m", torque[:, j] + NOISE * rng.standard_normal(len(time)))
        for j, name in enumerate(JOINTS)
    ]
    return Recording(f"run{seed}", f"run{seed}.csv", time, tuple(positions), tuple(efforts))


def numbers(found: Diagnosis, effect: str) -> dict[str, float]:
    """What an effect's only number is at each joint."""
    return {f["site"]: next(iter(f["parameters"].values()))["value"] for f in found.findings if f["effect"] == effect}


def test_every_joint_is_told_to_rub(system: System) -> None:
    found = diagnose([recorded(1), recorded(2), recorded(3)], system, fit_effort=True)
    assert {f["effect"] for f in found.findings} == {"viscous_damping", "coulomb_friction"}
    assert numbers(found, "viscous_damping") == pytest.approx(dict(zip(JOINTS, VISCOUS, strict=True)), rel=0.05)
    assert numbers(found, "coulomb_friction") == pytest.approx(dict(zip(JOINTS, DRY, strict=True)), rel=0.05)
    assert "viscous damping at " in found.summary and found.summary.count("iscous damping") == 1


def test_what_one_joint_leaves_says_nothing_of_the_others(system: System) -> None:
    def force(seed: int) -> Array:
        # A force with a memory of a second, twice the friction, that no law has.
        rng, course = np.random.default_rng(seed), np.zeros(3200)
        for k in range(1, len(course)):
            course[k] = 0.995 * course[k - 1] + 4.0 * np.sqrt(1.0 - 0.995**2) * rng.standard_normal()
        return np.stack([np.zeros(3200), course, np.zeros(3200)], axis=1)

    found = diagnose([recorded(k, force(k)) for k in (4, 5, 6)], system, fit_effort=True)
    assert found.verdict == "partly_explained"
    for joint, viscous, dry in ((JOINTS[0], VISCOUS[0], DRY[0]), (JOINTS[2], VISCOUS[2], DRY[2])):
        own = {f["effect"]: f for f in found.findings if f["site"] == joint}
        assert set(own) == {"viscous_damping", "coulomb_friction"}
        assert {f["grade"] for f in own.values()} == {"established"}
        assert own["viscous_damping"]["parameters"]["coefficient"]["value"] == pytest.approx(viscous, rel=0.1)
        assert own["coulomb_friction"]["parameters"]["torque"]["value"] == pytest.approx(dry, rel=0.1)


def over(*_: object) -> None:
    raise TimeUp


def test_what_stands_is_told_where_there_was_no_time_to_weigh_rivals(
    system: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(effort, "settle", over)
    monkeypatch.setattr(EffortStudy, "rivals", over)
    found = diagnose([recorded(1), recorded(2), recorded(3)], system, fit_effort=True)
    assert set(numbers(found, "viscous_damping")) == set(JOINTS)
    assert {f["grade"] for f in found.findings} <= {"likely", "possible"}
    assert not found.complete
    assert "another effect may be as likely as one of those told" in found.summary


def test_what_stands_without_a_doubt_is_told_where_there_was_no_time_to_judge_each_member(
    system: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    known = EffortStudy.reduce

    def reduce(study: EffortStudy, base: EffortFit, k: int) -> EffortFit:
        if base.hypothesis.without(k).identity not in study.fits:
            raise TimeUp
        return known(study, base, k)

    for name in ("standing", "settle"):
        monkeypatch.setattr(effort, name, over)
    monkeypatch.setattr(EffortStudy, "rivals", over)
    monkeypatch.setattr(EffortStudy, "reduce", reduce)
    found = diagnose([recorded(1), recorded(2), recorded(3)], system, fit_effort=True, time_limit=3600.0)
    assert numbers(found, "viscous_damping") == pytest.approx(dict(zip(JOINTS, VISCOUS, strict=True)), rel=0.05)
    assert numbers(found, "coulomb_friction") == pytest.approx(dict(zip(JOINTS, DRY, strict=True)), rel=0.05)
    assert {f["grade"] for f in found.findings} <= {"likely", "possible"}
    assert not found.complete
    assert "more of it may hold up" in found.summary and "nothing is claimed" not in found.summary


def test_rivals_that_take_all_the_time_leave_the_answer_standing(
    system: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    def until_the_end(*_: object) -> None:
        # From now on nothing at all is predicted any more, not even what is spared.
        monkeypatch.setattr(Deadline, "check", over)
        raise TimeUp

    monkeypatch.setattr(effort, "settle", over)
    monkeypatch.setattr(EffortStudy, "rivals", until_the_end)
    found = diagnose([recorded(1), recorded(2), recorded(3)], system, fit_effort=True)
    assert set(numbers(found, "viscous_damping")) == set(JOINTS)
    assert {f["grade"] for f in found.findings} <= {"likely", "possible"}
    assert found.ranking and found.fit and not found.complete
