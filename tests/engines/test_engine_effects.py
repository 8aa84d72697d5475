"""Effects attached to a system: every engine that takes one gives the same accelerations and the same motion.

MuJoCo says drag and cubic springs by its own joint polynomials and moves gravity for a shaking base; Pinocchio and Exudyn are
handed forces; the native lanes have compiled laws. What they share is the law on paper alone.
"""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from harness.effects.catalogue import catalogue
from harness.engines import registry
from harness.engines.expressed import described, express
from harness.errors import UnsupportedError
from harness.system import Attachment, JointType, System
from harness.system.random_systems import random_chain
from harness.system.write_mjcf import to_mjcf

TIME = np.linspace(0.0, 1.5, 76)
LAWS = {
    "viscous_damping": {"coefficient": 0.3},
    "quadratic_drag": {"coefficient": 0.2},
    "joint_stiffness": {"stiffness": 3.0, "rest_angle": 0.4},
    "cubic_stiffness": {"stiffness": 2.0},
    "constant_torque": {"torque": -0.7},
    "cogging_torque": {"amplitude": 0.5, "periods": 6.0, "phase": 0.3},
    "end_stop": {"angle": 0.6, "stiffness": 300.0, "damping": 2.0},
    "added_inertia": {"inertia": 0.05},
    "base_tilt": {"angle": 0.1},
    "payload_mass": {"mass": 0.2},
    "joint_flexibility": {"stiffness": 40.0, "damping": 0.1},
}
FORCES_ONLY = ("quadratic_drag", "cubic_stiffness", "constant_torque", "cogging_torque", "end_stop")


def arm(*attachments: Attachment) -> System:
    return replace(random_chain(2, 2, prismatic=0.0, armature=True, damping=True), attachments=attachments)


def with_effect(name: str) -> System:
    kind = catalogue()[name].site
    site = {"joint": "joint2", "link": "link2", "base": "base"}[kind]
    return arm(Attachment(name, site, LAWS[name]))


def runs(system: System, names: tuple[str, ...]) -> dict[str, np.ndarray]:
    found = {}
    for name in names:
        model = registry.engine(name).build(system)
        n = len(model.names)
        q0, qd0 = np.linspace(0.3, 0.5, n), np.linspace(1.0, 2.0, n)
        step = 2.5e-4 if name in ("mujoco", "exudyn") else None
        found[name] = model.simulate(q0, qd0, TIME, step=step).position
    return found


@pytest.mark.parametrize("name", LAWS)
def test_same_acceleration(name: str) -> None:
    system = with_effect(name)
    models = [registry.engine(engine).build(system) for engine in ("pinocchio", "mujoco", "exudyn", "denoc")]
    n = len(models[0].names)
    for state in np.random.default_rng(4).normal(size=(6, 3, n)):
        q, qd, tau = state
        expected = models[0].forward_dynamics(q, qd, tau)
        plain = registry.engine("pinocchio").build(arm())
        if n == len(plain.names) and name not in ("end_stop", "base_tilt"):
            # The effect is really there.
            assert np.max(np.abs(plain.forward_dynamics(q, qd, tau) - expected)) > 1e-6
        for model in models[1:]:
            assert model.forward_dynamics(q, qd, tau) == pytest.approx(expected, rel=1e-9, abs=1e-9)
            # Inverse dynamics counts the effect on the other side.
            assert model.inverse_dynamics(q, qd, expected) == pytest.approx(tau, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("name", LAWS)
def test_same_motion(name: str) -> None:
    found = runs(with_effect(name), ("pinocchio", "mujoco", "exudyn"))
    # RK4 at 0.25 ms. A drag's change of sign is a kink; the damping of a stop sets in with a jump, at which RK4 is of
    # first order and no better than the force's jump over the inertia times the step (measured: 6e-4 at 0.5 ms).
    allowed = {"end_stop": 5e-4, "quadratic_drag": 1e-7}.get(name, 1e-8)
    assert found["mujoco"] == pytest.approx(found["pinocchio"], abs=allowed)
    assert found["exudyn"] == pytest.approx(found["pinocchio"], abs=allowed)


@pytest.mark.parametrize("name", FORCES_ONLY)
def test_native_lanes_move_alike(name: str) -> None:
    # Both adapt their steps to kinks and jumps.
    found = runs(with_effect(name), ("pinocchio", "denoc"))
    assert found["denoc"] == pytest.approx(found["pinocchio"], abs=1e-8)


def test_shaking_base() -> None:
    shaking = Attachment("base_excitation", "base", {"amplitude": 2.0, "frequency": 3.0, "phase": 0.4})
    system = arm(shaking)
    found = runs(system, ("mujoco", "denoc"))
    assert found["denoc"] == pytest.approx(found["mujoco"], abs=1e-8)
    still = runs(arm(), ("mujoco",))
    assert np.max(np.abs(still["mujoco"] - found["mujoco"])) > 1e-3
    for engine in ("pinocchio", "exudyn", "analytic"):
        assert "base_excitation" in str(registry.engine(engine).refuses(system))
    # MuJoCo's gravity is put back.
    model = registry.engine("mujoco").build(system)
    before = model.gravity(np.zeros(2))
    model.simulate(np.zeros(2), np.zeros(2), TIME[:5])
    assert np.array_equal(model.gravity(np.zeros(2)), before)


def test_base_that_shakes_in_free_space_carries_a_slider_along() -> None:
    # No gravity, no spring: a slider along the shaking direction stays where it is in space, so its coordinate is minus
    # the base's displacement, ∬ A sin(ωt+φ), by hand.
    slider = random_chain(1, 0, prismatic=1.0)
    joint = replace(slider.joints[0], rotation=np.eye(3), axis=np.array([1.0, 0.0, 0.0]))
    law = {"amplitude": 2.0, "frequency": 1.5, "phase": 0.4}
    system = replace(
        slider, joints=(joint,), gravity=np.zeros(3), attachments=(Attachment("base_excitation", "base", law),)
    )
    shaking = express(system).shaking
    assert shaking is not None
    # The slider's own horizontal direction; a pendulum about y shakes along y × (-z) = -x.
    assert shaking.direction == pytest.approx((1.0, 0.0, 0.0))
    turning = replace(system, joints=(replace(joint, type=JointType.REVOLUTE, axis=np.array([0.0, 1.0, 0.0])),))
    assert getattr(express(turning).shaking, "direction", None) == pytest.approx((-1.0, 0.0, 0.0))
    w = 2.0 * np.pi * 1.5
    base = 2.0 * (np.cos(0.4) / w * TIME + (np.sin(0.4) - np.sin(w * TIME + 0.4)) / w**2)
    for engine in ("mujoco", "denoc"):
        model = registry.engine(engine).build(system)
        # Starting at another time changes nothing: the shaking counts from the first sample.
        position = model.simulate(np.zeros(1), np.zeros(1), TIME + 3.0).position[:, 0]
        assert position == pytest.approx(-base, abs=1e-8)


def test_laws_only_native_has() -> None:
    for name, law in (
        ("stribeck_friction", {"coulomb_torque": 0.1, "static_torque": 0.2, "stribeck_velocity": 0.1}),
        ("dahl_friction", {"torque": 0.1, "stiffness": 10.0}),
        ("load_dependent_friction", {"mu_radius": 0.01}),
    ):
        system = arm(Attachment(name, "joint1", law))
        for engine in ("pinocchio", "mujoco", "exudyn", "analytic"):
            assert name in str(registry.engine(engine).refuses(system))
            with pytest.raises(UnsupportedError):
                registry.engine(engine).build(system)
        assert registry.engine("denoc").refuses(system) is None
        moved = runs(system, ("denoc",))["denoc"]
        assert np.all(np.isfinite(moved))
        assert np.max(np.abs(moved - runs(arm(), ("mujoco",))["mujoco"])) > 1e-4


def test_dry_friction_as_a_soft_constraint_is_mujocos() -> None:
    rubs = [
        Attachment("coulomb_friction", joint, {"torque": torque})
        for joint, torque in (("joint1", 0.3), ("joint2", 0.1))
    ]
    soft = [Attachment("friction_softness", a.site, {"time": 0.008, "inertia": 0.05}) for a in rubs]
    system = arm(*rubs, *soft)
    found = runs(system, ("mujoco", "denoc"))
    # What is left is due to MuJoCo's steps, in which kinks of the force lie anywhere.
    assert found["denoc"] == pytest.approx(found["mujoco"], abs=1e-6)
    stuck = runs(arm(*rubs), ("denoc",))["denoc"]
    assert np.max(np.abs(stuck - found["denoc"])) > 1e-3
    for engine in ("pinocchio", "exudyn", "analytic"):
        assert "friction" in str(registry.engine(engine).refuses(system))
    creeping = arm(*rubs, Attachment("friction_creep", "joint1", {"velocity": 0.05}))
    assert "friction_creep" in str(registry.engine("mujoco").refuses(creeping))


def test_a_stop_with_inertia_is_mujocos_limit() -> None:
    stops = [
        Attachment("end_stop", joint, {"angle": angle, "stiffness": 80.0, "damping": 4.0})
        for joint, angle in (("joint1", -0.2), ("joint2", 0.55))
    ]
    heavy = [Attachment("stop_inertia", a.site, {"inertia": 0.3}) for a in stops]
    found = runs(arm(*stops, *heavy), ("mujoco", "denoc"))
    # What is left is due to MuJoCo's steps, which a blow may fall anywhere into: 7e-5 at steps of 0.1 ms.
    assert found["denoc"] == pytest.approx(found["mujoco"], abs=4e-4)
    light = runs(arm(*stops), ("denoc",))["denoc"]
    assert np.max(np.abs(light - found["denoc"])) > 1e-2
    for engine in ("pinocchio", "exudyn"):
        assert "stop_inertia" in str(registry.engine(engine).refuses(arm(*stops, *heavy)))


def test_soft_constraints_are_written_as_mjcf() -> None:
    system = arm(
        Attachment("coulomb_friction", "joint1", {"torque": 0.3}),
        Attachment("friction_softness", "joint1", {"time": 0.008, "inertia": 0.05}),
        Attachment("end_stop", "joint2", {"angle": 0.55, "stiffness": 80.0, "damping": 4.0}),
        Attachment("stop_inertia", "joint2", {"inertia": 0.3}),
    )
    text, left_out = to_mjcf(described(system))
    assert not left_out
    theirs = mujoco.MjModel.from_xml_string(text)
    theirs.opt.timestep = 2.5e-4
    data = mujoco.MjData(theirs)
    data.qpos[:], data.qvel[:] = (0.3, 0.5), (1.0, 2.0)
    found = []
    for now in TIME:
        while data.time < now - 1e-9:
            mujoco.mj_step(theirs, data)
        found.append(data.qpos.copy())
    assert np.array(found) == pytest.approx(runs(system, ("mujoco",))["mujoco"], abs=1e-9)
    # A stop that is no such constraint is left out, and so is a softness with no friction to be soft.
    plain = arm(system.attachments[1], system.attachments[2])
    assert len(to_mjcf(described(plain))[1]) == 2


def test_effects_of_sensors_and_inputs_are_none_of_the_engines_business() -> None:
    gain = Attachment("sensor_gain", "joint1.position", {"gain": 1.1})
    system = arm(gain, Attachment("actuator_gain", "joint1", {"gain": 0.9}))
    for name in ("pinocchio", "mujoco", "exudyn", "denoc"):
        assert registry.engine(name).refuses(system) is None


def test_mistakes_in_effects_are_told() -> None:
    for name in ("denoc", "pinocchio", "mujoco", "exudyn"):
        engine = registry.engine(name)
        assert "no_such" in str(engine.refuses(arm(Attachment("no_such", "joint1", {}))))
        assert "joint9" in str(engine.refuses(arm(Attachment("cubic_stiffness", "joint9", {"stiffness": 1.0}))))
    both = arm(
        Attachment("cubic_stiffness", "joint1", {"stiffness": 1.0}),
        Attachment("joint_stiffness", "joint1", {"stiffness": 1.0, "rest_angle": 0.2}),
    )
    assert "rest position" in str(registry.engine("mujoco").refuses(both))
    assert registry.engine("pinocchio").refuses(both) is None


def test_forces_of_laws_take_many_states_at_once() -> None:
    laws = (Attachment(name, "joint2", LAWS[name]) for name in FORCES_ONLY)
    forces = express(arm(*laws)).forces
    q, qd = np.linspace(-1.0, 1.2, 14).reshape(7, 2), np.linspace(2.0, -2.0, 14).reshape(7, 2)
    one_by_one = [forces(*state) for state in zip(q, qd, strict=True)]
    np.testing.assert_array_equal(forces(q, qd), np.array(one_by_one))
