"""ANCF beams against closed forms and against a rigid engine in the rigid limit."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("exudyn")

from steel_strip import HUB, cantilever, pendulum, strip

from harness.denoc.beam.shapes import frequencies, mount_ratios
from harness.engines.exudyn_ancf import Ancf
from harness.engines.mujoco import Mujoco
from harness.engines.protocol import Engine
from harness.errors import EngineUnavailableError, UnsupportedError
from harness.system import Attachment, Joint, JointType, Link, System
from harness.system.description import constant
from harness.system.flexible_link import flexible_link


def double_pendulum(thickness=0.001, rigid=(), turned=False):
    """Two strips; the second one's joint turns the other way if ``turned``."""
    upper, lower = flexible_link("upper", strip(thickness)), flexible_link("lower", strip(thickness))
    shoulder = Joint("shoulder", JointType.REVOLUTE, "base", "upper", axis=constant([0.0, 1.0, 0.0]))
    elbow = Joint(
        "elbow",
        JointType.REVOLUTE,
        "upper",
        "lower",
        xyz=constant([0.0, 0.0, -0.3]),
        axis=constant([0.0, -1.0 if turned else 1.0, 0.0]),
    )
    system = System("double pendulum", (shoulder, elbow), (upper, lower))
    for name in rigid:
        system = system.replace_link(replace(system.link(name), beam=None))
    return system


@pytest.mark.parametrize(("elements", "relative"), [(4, 1e-2), (8, 1e-3), (16, 1e-4)])
def test_frequencies_converge_to_the_closed_forms(elements, relative):
    beam = strip()
    for joint, free, hub in ((JointType.REVOLUTE, True, HUB), (JointType.FIXED, False, 0.0)):
        exact = frequencies(beam, mount_ratios(beam, free_hub=free, hub_inertia=hub), 3)
        system = pendulum(gravity=0.0, joint=joint, armature=hub)
        found = Ancf(elements=elements).build(system).frequencies(np.zeros(len(system.coordinate_names)))
        np.testing.assert_allclose(found[:3], exact, rtol=relative)
        assert found[0] == pytest.approx(exact[0], abs=0.03 if elements == 4 else 0.003)


def test_frequency_with_a_payload_is_the_closed_form():
    payload, turning = 0.03, 5e-6
    system = pendulum(gravity=0.0, payload=payload, payload_inertia=constant(turning * np.eye(3)))
    beam = system.link("rod").beam
    mount = mount_ratios(beam, free_hub=True, hub_inertia=HUB, tip_mass=payload, tip_inertia=turning)
    found = Ancf().build(system).frequencies(np.zeros(2))
    np.testing.assert_allclose(found[:3], frequencies(beam, mount, 3), rtol=2e-4)


def test_a_hanging_beam_swings_as_a_rigid_one_and_gravity_stiffens_it():
    system = pendulum()
    found = Ancf().build(system).frequencies(np.zeros(2))
    mass, length = system.link("rod").mass, 0.3
    rigid = np.sqrt(mass * 9.81 * length / 2.0 / (mass * length**2 / 3.0 + HUB)) / (2.0 * np.pi)
    # The strip is stiff against its weight: its swing is slower by about (swing / bending frequency)², 1e-3.
    assert found[0] == pytest.approx(rigid, rel=2e-3)
    assert 0.05 < found[1] - 37.540 < 0.15


def test_no_frequencies_away_from_an_equilibrium():
    with pytest.raises(UnsupportedError, match="equilibrium"):
        Ancf().build(pendulum()).frequencies(np.array([1.0, 0.0]))


def test_two_thick_beams_move_as_two_rigid_rods():
    # 20 mm instead of 1 mm: first bending frequency 20 times higher, deflection 400 times smaller.
    beams = double_pendulum(0.02, turned=True)
    rods = beams.rigid()
    time = np.linspace(0.0, 0.5, 51)
    start = {"shoulder": 1.0, "elbow": 0.5}
    q0 = np.array([start.get(name, 0.0) for name in beams.coordinate_names])
    qd0 = np.array([{"shoulder": 2.0, "elbow": -1.0}.get(name, 0.0) for name in beams.coordinate_names])
    joints = [beams.coordinate_names.index(name) for name in rods.joint_names]
    ours = Ancf(elements=2).build(beams).simulate(q0, qd0, time, step=1e-4)
    theirs = Mujoco().build(rods).simulate(q0[joints], qd0[joints], time)
    np.testing.assert_allclose(ours.position[:, joints], theirs.position, atol=2e-4)
    # The sudden load rings the beams at some 200 Hz: 2e-5 rad of slope are 3e-2 rad/s.
    np.testing.assert_allclose(ours.velocity[:, joints], theirs.velocity, atol=5e-2)
    assert set(ours.channels) >= {"upper.tip_deflection", "lower.tip_deflection", "elbow.position"}


@pytest.mark.parametrize("rigid", [(), ("upper",), ("lower",)])
def test_rotor_inertia_damping_and_torque_act_between_the_links(rigid):
    # In the rigid limit MuJoCo has all three: armature, damping, applied torque held between samples.
    mixed = double_pendulum(0.02, rigid=rigid, turned=True)
    mixed = mixed.replace_joint(replace(mixed.joint("elbow"), armature=5e-3, damping=0.02))
    mixed = mixed.replace_joint(replace(mixed.joint("shoulder"), armature=2e-3, damping=0.01))
    rods = mixed.rigid()
    time = np.linspace(0.0, 0.5, 101)
    names = mixed.coordinate_names
    joints = [names.index(name) for name in rods.joint_names]
    q0 = np.zeros(len(names))
    q0[joints] = 1.0, 0.5
    drive = np.column_stack([2.0 * np.sin(10.0 * time), np.cos(7.0 * time)])
    tau = np.zeros((len(time), len(names)))
    tau[:, joints] = drive
    ours = Ancf(elements=2).build(mixed).simulate(q0, np.zeros(len(names)), time, tau=tau, step=1e-4)
    theirs = Mujoco().build(rods).simulate(q0[joints], np.zeros(2), time, tau=drive)
    np.testing.assert_allclose(ours.position[:, joints], theirs.position, atol=1e-3)
    # Each of the three moves the result by far more than that.
    bare = mixed.replace_joint(replace(mixed.joint("elbow"), armature=0.0))
    other = Ancf(elements=2).build(bare).simulate(q0, np.zeros(len(names)), time, tau=tau, step=1e-4)
    assert np.max(np.abs(other.position[:, joints] - ours.position[:, joints])) > 2e-2


@pytest.mark.parametrize("rigid", [("upper",), ("lower",)])
def test_rigid_links_mix_with_beams(rigid):
    mixed = double_pendulum(0.02, rigid=rigid)
    rods = mixed.rigid()
    time = np.linspace(0.0, 0.5, 51)
    names = mixed.coordinate_names
    joints = [names.index(name) for name in rods.joint_names]
    q0 = np.zeros(len(names))
    q0[joints] = 1.0, 0.5
    ours = Ancf(elements=2).build(mixed).simulate(q0, 0.0 * q0, time, step=1e-4)
    theirs = Mujoco().build(rods).simulate(q0[joints], np.zeros(2), time)
    np.testing.assert_allclose(ours.position[:, joints], theirs.position, atol=2e-4)


def test_a_released_cantilever_swings_about_its_static_deflection():
    # ρ g l⁴ / (8 EI) at the tip of a horizontal cantilever; released from straight it reaches twice that (its first
    # mode carries 97 % of it), at its own frequency.
    system, static = cantilever()
    time = np.linspace(0.0, 0.5, 2501)
    run = Ancf(elements=4).build(system).simulate(np.zeros(1), np.zeros(1), time, step=1e-4)
    deflection = run.channels["rod.tip_deflection"]
    assert np.mean(deflection) == pytest.approx(static, rel=0.02)
    assert np.min(deflection) == pytest.approx(2.0 * static, rel=0.05)


def test_elastic_initial_state_is_taken_over():
    # A released first mode of the clamped strip, no gravity: a cosine at 9.0598 Hz.
    system = pendulum(gravity=0.0, joint=JointType.FIXED, armature=0.0)
    time = np.linspace(0.0, 0.2, 201)
    run = Ancf(elements=8).build(system).simulate(np.array([1e-3]), np.zeros(1), time, step=5e-5)
    expected = 1e-3 * np.cos(2.0 * np.pi * 9.0598 * time)
    np.testing.assert_allclose(run.channels["rod.tip_deflection"], expected, atol=2e-6)


def test_uneven_samples_are_read_off_the_same_motion():
    model = Ancf(elements=4).build(pendulum())
    even = np.linspace(0.0, 0.1, 101)
    uneven = even[[0, 3, 10, 11, 40, 77, 100]]
    q0 = np.array([1.0, 0.0])
    one = model.simulate(q0, np.zeros(2), even, step=1e-4)
    other = model.simulate(q0, np.zeros(2), uneven, step=1e-4)
    np.testing.assert_allclose(other.position[:, 0], one.position[[0, 3, 10, 11, 40, 77, 100], 0], atol=1e-7)
    assert np.all(np.isnan(one.position[:, 1]))


def test_a_damper_at_the_base_brakes_the_swing():
    # Small swing of a nearly rigid rod: amplitude falls as exp(-d t / (2 I)).
    damping = 5e-4
    system = pendulum(thickness=0.005, damping=damping)
    time = np.linspace(0.0, 2.0, 401)
    run = Ancf(elements=2).build(system).simulate(np.array([0.05, 0.0]), np.zeros(2), time, step=2e-4)
    inertia = system.link("rod").mass * 0.3**2 / 3.0 + HUB
    rate = damping / (2.0 * inertia)
    omega = np.sqrt(system.link("rod").mass * 9.81 * 0.15 / inertia - rate**2)
    expected = 0.05 * np.exp(-rate * time) * (np.cos(omega * time) + rate / omega * np.sin(omega * time))
    np.testing.assert_allclose(run.position[:, 0], expected, atol=2e-4)


def test_nothing_is_printed_or_written(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    model = Ancf(elements=2).build(pendulum())
    model.simulate(np.array([1.0, 0.0]), np.zeros(2), np.linspace(0.0, 0.01, 11), step=1e-4)
    model.frequencies(np.zeros(2))
    assert capfd.readouterr() == ("", "")
    assert list(Path.cwd().iterdir()) == []


def _attached(system):
    return replace(system, attachments=(Attachment("coulomb_friction", "pivot", {"torque": 0.1}),))


def _branching(system):
    twin = replace(system.joints[0], name="twin", child="other")
    return replace(system, joints=(*system.joints, twin), links=(*system.links, Link("other", 1.0)))


@pytest.mark.parametrize(
    ("system", "word"),
    [
        (pendulum().rigid(), "no elastic link"),
        (_attached(pendulum()), "coulomb_friction"),
        (_branching(pendulum()), "chains"),
        (pendulum(joint=JointType.PRISMATIC), "slides"),
        (pendulum(geometric_stiffening=False), "stiffen"),
        (pendulum(modal_damping=(0.01,)), "modal damping"),
        (pendulum(axis=(1.0, 0.0, 0.0)), "out of the plane"),
        (pendulum(bending2=True, bending_stiffness2=1.0), "out of the plane"),
    ],
)
def test_what_it_cannot_express_is_refused_in_one_line(system, word):
    engine = Ancf()
    assert isinstance(engine, Engine)
    reason = engine.refuses(system)
    assert word in reason
    assert "\n" not in reason
    with pytest.raises(UnsupportedError, match=word):
        engine.build(system)


def test_quantities_of_other_coordinates_are_left_out():
    model = Ancf().build(pendulum())
    for call in (
        lambda: model.mass_matrix(np.zeros(2)),
        lambda: model.forward_dynamics(*np.zeros((3, 2))),
        lambda: model.energy(*np.zeros((2, 2))),
        lambda: model.simulate(np.zeros(2), np.zeros(2), np.array([0.0, 1e-3]), tau=np.ones((2, 2))),
    ):
        with pytest.raises(UnsupportedError):
            call()


def test_without_exudyn_it_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "exudyn", None)
    with pytest.raises(EngineUnavailableError, match=r"denoc-harness\[engines\]"):
        Ancf().build(pendulum())
