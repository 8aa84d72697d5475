"""Flexible links in lanes against the scalar recursion, the written-out equations of one link, and energy."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import harness
from harness.denoc import Denoc
from harness.denoc.beam.integrals import beam_data
from harness.denoc.lanes.model import LaneModel
from harness.system import System, random_chain, random_tree
from harness.system.flexible_link import flexible_link

MODELS = Path(__file__).parents[2] / "models" / "toml"


def flexible_pendulum(**changes: object) -> System:
    """The flexible pendulum of the models folder, its beam changed."""
    system = harness.load(MODELS / "flexible_pendulum.toml")
    link = system.links[0]
    assert link.beam is not None
    return system.replace_link(flexible_link(link.name, replace(link.beam, **changes)))


@pytest.mark.parametrize("seed", range(8))
def test_accelerations_of_random_mechanisms_are_those_of_the_scalar_recursion(seed):
    if seed % 2:
        system = random_chain(4, seed=seed, flexible=0.6, modes=1 + seed % 3, fixed=0.3, armature=True, damping=True)
    else:
        system = random_tree(5, seed=seed, flexible=0.6, modes=1 + seed % 3, fixed=0.3)
    model, scalar = LaneModel(system), Denoc(system)
    assert model.names == system.coordinate_names
    rng = np.random.default_rng(seed)
    elastic = np.array([".mode" in name for name in model.names])
    q, v, tau = (rng.normal(size=(9, model.n)) for _ in range(3))
    q[:, elastic] *= 0.02
    v[:, elastic] *= 0.1
    effort = np.repeat(tau[:, None], 2, axis=1)
    ours = model.simulate(model.row(), q, v, np.array([0.0, 1e-9]), tau=effort)[2][:, 0]
    reference = np.array([scalar.forward_dynamics(*state) for state in zip(q, v, tau, strict=True)])
    assert np.abs(ours - reference).max() < 1e-11 * np.abs(reference).max()


def test_one_flexible_link_against_its_written_out_equations():
    # One mode, no foreshortening; θ from the vertical, b along the bending direction:
    # [I + S1' b²] θ̈ + S2' b̈ + 2 S1' b ḃ θ̇ = −g (m1 sin θ + S0' b cos θ) up to the sign of the bending direction,
    # S2' θ̈ + S1' b̈ − S1' b θ̇² + k b = ∓ g S0' sin θ, primes with the payload's share.
    system = flexible_pendulum(
        modes=1, geometric_stiffening=False, payload=0.01, modal_damping=(), material_damping=0.0
    )
    joint, beam = system.joints[0], beam_data(system, system.links[0].name)
    mp, l, s3 = 0.01, beam.length, float(beam.S3[0])
    inertia = beam.rho * l**3 / 3 + mp * l * l + joint.armature
    s0 = beam.rho * float(beam.S0[0]) + mp * s3
    s1 = beam.rho * float(beam.S1[0, 0]) + mp * s3**2
    s2 = beam.rho * float(beam.S2[0]) + mp * l * s3
    first, k, g = beam.rho * l * l / 2 + mp * l, float(beam.K[0, 0]), 9.81
    # Does a positive turn move the tip along the bending direction?
    sign = float(np.cross(joint.axis, beam.direction) @ beam.bending)
    assert abs(abs(sign) - 1.0) < 1e-12
    damping = joint.damping

    def f(t, y):
        theta, b, w, bd = y
        b, bd = sign * b, sign * bd
        mass = np.array([[inertia + s1 * b * b, s2], [s2, s1]])
        force = np.array(
            [
                -2 * s1 * b * bd * w - g * (first * np.sin(theta) + s0 * b * np.cos(theta)) - damping * w,
                s1 * b * w * w - k * b - g * s0 * np.sin(theta),
            ]
        )
        qdd = np.linalg.solve(mass, force)
        return [w, sign * bd, qdd[0], sign * qdd[1]]

    direction = beam.direction @ np.array([0.0, 0.0, -1.0])
    assert direction == pytest.approx(1.0)  # hangs straight down at θ = 0
    time = np.linspace(0.0, 1.0, 201)
    model = LaneModel(system)
    ours = model.simulate(model.row(), [1.2, 0.002], [0.0, 0.0], time)[0][0]
    reference = solve_ivp(f, (0, 1), [1.2, 0.002, 0, 0], "DOP853", t_eval=time, rtol=1e-12, atol=1e-14).y[:2].T
    assert np.abs(ours[:, 0] - reference[:, 0]).max() < 1e-8
    assert np.abs(ours[:, 1] - reference[:, 1]).max() < 1e-9


@pytest.mark.parametrize("stiffening", [True, False])
def test_energy_of_an_undamped_flexible_pendulum(stiffening):
    system = flexible_pendulum(
        modes=3, modal_damping=(), material_damping=0.0, geometric_stiffening=stiffening, payload=0.02
    )
    system = system.replace_joint(replace(system.joints[0], damping=0.0, friction=0.0))
    model, scalar = LaneModel(system), Denoc(system)
    time = np.linspace(0.0, 2.0, 101)
    q, v, _ = model.simulate(model.row(), [1.57, 0.004, 0.0, 0.0], [0.0] * 4, time)
    energy = np.array([sum(scalar.energy(a, b)) for a, b in zip(q[0], v[0], strict=True)])
    kinetic = max(scalar.energy(a, b)[0] for a, b in zip(q[0], v[0], strict=True))
    assert np.ptp(energy) < 1e-7 * kinetic


def test_named_slots_say_what_the_system_says():
    plain = flexible_pendulum(modes=2, modal_damping=(0.01, 0.02), material_damping=1e-5, payload=0.0)
    model = LaneModel(plain)
    time = np.linspace(0.0, 1.0, 101)
    start, rest = [1.2, 0.003, 0.0], [0.0, 0.0, 0.0]
    rod = plain.links[0].name
    beam = plain.links[0].beam
    assert beam is not None
    changes = {
        "stiffness_factor": (1.3, {"bending_stiffness": 1.3 * beam.bending_stiffness}),
        "material_damping": (3e-5, {"material_damping": 3e-5}),
        "stiffening": (0.0, {"geometric_stiffening": False}),
    }
    for slot, (value, change) in changes.items():
        row = model.row()
        row[model.slot(rod, slot)] = value
        # Same shapes, so the coordinates mean the same; modal damping ratios are left out, they follow the stiffness.
        for k in (1, 2):
            row[model.slot(rod, f"modal_damping_{k}")] = 0.0
        other = flexible_pendulum(modes=2, modal_damping=(), **{"material_damping": 1e-5, "payload": 0.0} | change)
        ours = model.simulate(row, start, rest, time)[0]
        theirs = model.simulate(model.row(other), start, rest, time)[0]
        assert np.abs(ours - theirs).max() < 1e-9
    row = model.row()
    row[model.slot(rod, "payload")] = 0.015
    row[model.slot(rod, "mass_factor")] = 1.1
    scalar = Denoc(
        flexible_pendulum(modes=2, modal_damping=(), mass=beam.mass * 1.1, payload=0.015, shapes="clamped_free")
    )
    nominal = LaneModel(flexible_pendulum(modes=2, modal_damping=(), payload=0.0, shapes="clamped_free"))
    row = nominal.row()
    row[nominal.slot(rod, "payload")] = 0.015
    row[nominal.slot(rod, "mass_factor")] = 1.1
    ours = nominal.simulate(row, start, rest, np.array([0.0, 1e-9]))[2][0, 0]
    reference = scalar.forward_dynamics(np.array(start), np.array(rest))
    assert np.abs(ours - reference).max() < 1e-10 * np.abs(reference).max()


def test_friction_at_the_hub_holds_while_the_beam_rings_down():
    system = flexible_pendulum(modes=2, modal_damping=(0.02, 0.02))
    system = system.replace_joint(replace(system.joints[0], friction=0.5))
    model = LaneModel(system)
    time = np.linspace(0.0, 2.0, 401)
    q, v, _ = model.simulate(model.row(), [1.0, 0.004, 0.0], [0.0] * 3, time)
    assert np.all(q[0, :, 0] == 1.0)
    assert np.all(v[0, :, 0] == 0.0)
    early, late = np.ptp(q[0, :50, 1]), np.ptp(q[0, -50:, 1])
    assert late < 0.2 * early


def test_motion_of_a_two_link_flexible_chain_against_the_scalar_recursion():
    system = harness.load(MODELS / "two_link_flexible.toml")
    model, scalar = LaneModel(system), Denoc(system)
    n = model.n
    start = np.zeros(n)
    start[0] = 0.8
    time = np.linspace(0.0, 0.5, 26)
    ours = model.simulate(model.row(), start, np.zeros(n), time)[0][0]

    def f(t, y):
        return np.concatenate([y[n:], scalar.forward_dynamics(y[:n], y[n:])])

    reference = solve_ivp(
        f, (0, 0.5), np.concatenate([start, np.zeros(n)]), "DOP853", t_eval=time, rtol=1e-10, atol=1e-12
    ).y[:n].T  # fmt: skip
    assert np.abs(ours - reference).max() < 1e-7
