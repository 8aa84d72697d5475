"""A last link whose inertia is not the drawn one, moved by three joints: it is no rotor at its own. Truth: Pinocchio's RNEA."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from harness.diagnose.claims.grades import POSSIBLE
from harness.diagnose.diagnose import diagnose
from harness.recording import Recording
from harness.recording.recording import Channel
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

AXES = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0))
PLACES = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.3), (0.4, 0.0, 0.0))
MASSES = (3.0, 2.5, 1.2)
COMS = ((0.0, 0.0, 0.1), (0.18, 0.0, 0.0), (0.15, 0.0, 0.0))
INERTIAS = ((0.02, 0.02, 0.01), (0.004, 0.03, 0.03), (0.001, 0.012, 0.012))
VISCOUS = 0.5  # N·m·s/rad, at the second joint
NAMES = ("j1", "j2", "j3")
RATE, DURATION = 250.0, 8.0  # Hz, s
ENCODER, TORQUE = 5e-5, 0.03  # rad, N·m: noise


def arm() -> System:
    """The arm as it is drawn."""
    parents = ("base", "l1", "l2")
    joints = tuple(
        Joint(name, JointType.REVOLUTE, parent, f"l{k + 1}", xyz=constant(place), axis=constant(axis))
        for k, (name, parent, axis, place) in enumerate(zip(NAMES, parents, AXES, PLACES, strict=True))
    )
    links = tuple(
        Link(f"l{k + 1}", mass=mass, com=constant(com), inertia=constant(np.diag(inertia)))
        for k, (mass, com, inertia) in enumerate(zip(MASSES, COMS, INERTIAS, strict=True))
    )
    return System("arm", joints, links)


def recorded(seed: int, share: float) -> Recording:
    """A course of sines with the efforts that it takes; share: by which the last link's inertia is larger than drawn."""
    model = pin.Model()
    parent = 0
    for k, (axis, place) in enumerate(zip(AXES, PLACES, strict=True)):
        joint = pin.JointModelRZ() if axis[2] else pin.JointModelRY()
        parent = model.addJoint(parent, joint, pin.SE3(np.eye(3), np.array(place)), NAMES[k])
        larger = 1.0 + (share if k == 2 else 0.0)
        inertia = pin.Inertia(MASSES[k], np.array(COMS[k]), larger * np.diag(INERTIAS[k]))
        model.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
    data, rng = model.createData(), np.random.default_rng(seed)
    time = np.arange(0.0, DURATION, 1.0 / RATE)
    omega = 2.0 * np.pi * np.array([0.15, 0.4, 0.9])[:, None]
    q, v, a = np.zeros((3, 3, len(time)))
    for j in range(3):
        phase, size = rng.uniform(0.0, 2.0 * np.pi, (3, 1)), rng.uniform(0.2, 0.4, (3, 1))
        angle = omega * time + phase
        q[j] = np.sum(size * np.sin(angle), axis=0)
        v[j] = np.sum(size * omega * np.cos(angle), axis=0)
        a[j] = -np.sum(size * omega**2 * np.sin(angle), axis=0)
    tau = np.array([pin.rnea(model, data, *row) for row in zip(q.T, v.T, a.T, strict=True)]).T
    tau[1] += VISCOUS * v[1]
    q, tau = q + ENCODER * rng.standard_normal(q.shape), tau + TORQUE * rng.standard_normal(tau.shape)
    channels = tuple(
        Channel(f"{n}.position", n, "position", "rad", constant(row)) for n, row in zip(NAMES, q, strict=True)
    )
    efforts = tuple(
        Channel(f"{n}.effort", n, "effort", "N*m", constant(row)) for n, row in zip(NAMES, tau, strict=True)
    )
    return Recording(f"run{seed}", "made here", constant(time), channels, efforts)


@pytest.mark.parametrize("share", [0.5, -0.3])
def test_the_inertia_of_a_link_is_no_rotor(share: float) -> None:
    found = diagnose([recorded(seed, share) for seed in (1, 2, 3)], arm(), fit_effort=True)
    told = {f"{f['effect']}@{f['site']}": f for f in found.findings if f["grade"] != POSSIBLE}
    assert set(told) == {"viscous_damping@j2", "link_inertia@l3"} and found.verdict == "explained"
    low, high = told["link_inertia@l3"]["parameters"]["share"]["ci95"]
    assert low <= share <= high and high - low < 0.2
    low, high = told["viscous_damping@j2"]["parameters"]["coefficient"]["ci95"]
    assert low <= VISCOUS <= high


def test_an_arm_as_drawn_has_no_such_inertia() -> None:
    found = diagnose([recorded(seed, 0.0) for seed in (1, 2, 3)], arm(), fit_effort=True)
    assert [f["effect"] for f in found.findings] == ["viscous_damping"] and found.verdict == "explained"
