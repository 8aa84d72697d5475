"""Motion in a plane by its own kernels, against the scalar recursion in space and against the lanes' own recursion in space."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.denoc.lanes.model import LaneModel
from harness.denoc.model import Denoc
from harness.system import Beam, Joint, JointType, Link, System
from harness.system.description import constant
from harness.system.flexible_link import flexible_link


def planar(seed: int, kinds: str, *, branch: bool = False) -> System:
    """A tree in a plane of any direction: r revolute, p prismatic, f revolute with a bending link; axes both ways round.

    Bodies have mass off the plane and products of inertia, which motion in the plane does not feel.
    """
    rng = np.random.default_rng(seed)
    plane = Rotation.random(random_state=seed).as_matrix()
    normal = plane[:, 2]
    joints, links = [], []
    parent, before = "base", np.eye(3)
    for k, kind in enumerate(kinds):
        placed = Rotation.random(random_state=100 * seed + k).as_matrix()
        seen = (before @ placed).T @ normal
        along = (before @ placed).T @ plane[:, 0]
        name = f"link{k}"
        if kind == "f":
            # Directions of a beam in its link's frame, bent about the normal or against it.
            bending = np.cross(seen, along) * rng.choice([-1.0, 1.0])
            beam = Beam(
                length=0.5,
                direction=constant(along),
                bending=constant(bending),
                mass=0.3,
                bending_stiffness=4.0,
                modes=2,
                payload=0.1,
                modal_damping=(0.01, 0.02),
            )
            links.append(flexible_link(name, beam))
        else:
            a = rng.normal(size=(3, 3))
            links.append(Link(name, rng.uniform(0.5, 2.0), constant(rng.normal(size=3)), constant(a @ a.T + np.eye(3))))
        joints.append(
            Joint(
                f"joint{k}",
                JointType.PRISMATIC if kind == "p" else JointType.REVOLUTE,
                parent,
                name,
                xyz=constant(rng.normal(size=3)),
                rotation=constant(placed),
                axis=constant(along if kind == "p" else seen * rng.choice([-1.0, 1.0])),
                armature=rng.uniform(0.0, 0.1),
                damping=rng.uniform(0.0, 0.1),
            )
        )
        if not branch or k == 0:
            parent, before = name, before @ placed
    return System("planar", tuple(joints), tuple(links), gravity=constant(rng.normal(size=3) * 9.81))


@pytest.mark.parametrize("kinds", ["r", "p", "pr", "rr", "rpr", "rrrr", "f", "fr", "pf", "ff", "rfp"])
@pytest.mark.parametrize("branch", [False, True])
def test_accelerations_are_those_of_the_recursion_in_space(kinds: str, branch: bool) -> None:
    system = planar(len(kinds), kinds, branch=branch)
    lanes, textbook = LaneModel(system), Denoc(system)
    rng = np.random.default_rng(5)
    copies, n = 24, lanes.n
    assert lanes.plane is not None
    # Angles up to 1e4 rad; what slides or bends stays within reach.
    turns = np.array([name.startswith("joint") for name in lanes.names])
    turns &= np.array(
        ["p" not in kinds or kinds[int(name[5])] != "p" if name[0] == "j" else False for name in lanes.names]
    )
    q = rng.normal(size=(copies, n)) * np.where(turns, 10.0 ** rng.uniform(-1, 4, size=(copies, 1)), 0.02)
    q = np.where(turns, np.clip(q, -1e4, 1e4), q)
    qd = rng.normal(size=(copies, n)) * 3.0
    tau = rng.normal(size=(copies, 1, n))
    _, _, found = lanes.simulate(lanes.row(), q, qd, np.array([0.0, 1e-9]), tau=np.repeat(tau, 2, axis=1), hold="zero")
    for k in range(copies):
        wanted = textbook.forward_dynamics(q[k], qd[k], tau[k, 0])
        # Ten decimals of the greatest: at 1e4 rad an angle itself has but twelve.
        assert np.abs(found[k, 0] - wanted).max() <= 1e-10 * (1.0 + np.abs(wanted).max())


@pytest.mark.parametrize("kinds", ["rr", "pr", "fr"])
def test_motion_with_friction_stops_and_shaking_is_the_same_in_space(kinds: str) -> None:
    system = planar(7, kinds)
    system = replace(system, gravity=constant([1.0, -4.0, 9.0]))
    flat, space = LaneModel(system), LaneModel(system, planar=False)
    assert flat.plane is not None and space.plane is None
    rows = np.repeat(flat.row()[None], 3, axis=0)
    last = system.movable_joints[-1].name
    rows[:, flat.slot(last, "coulomb_torque")] = [0.0, 0.5, 1.0]
    rows[:, flat.slot(last, "mu_radius")] = [0.0, 0.0, 0.01]
    rows[:, flat.slot(last, "stop_angle")] = 0.4
    rows[:, flat.slot(last, "stop_stiffness")] = 200.0
    rows[:, flat.slot("base", "excitation_amplitude")] = 2.0
    rows[:, flat.slot("base", "excitation_frequency")] = 3.0
    start = np.zeros((3, flat.n))
    time = np.linspace(0.0, 0.6, 61)
    mine = flat.simulate(rows, start, start + 0.3, time)
    other = space.simulate(rows, start, start + 0.3, time)
    for a, b in zip(mine, other, strict=True):
        assert np.isfinite(a).all()
        # Steps of both keep 1e-11; contacts and accelerations magnify that.
        assert np.abs(a - b).max() <= 1e-6 * (1.0 + np.abs(b).max())
    assert np.abs(mine[0] - other[0]).max() <= 1e-8


def test_copies_out_of_the_plane_go_their_own_way() -> None:
    system = planar(3, "rr")
    flat, space = LaneModel(system), LaneModel(system, planar=False)
    rows = np.repeat(flat.row()[None], 10, axis=0)
    rows[::3, flat.slot("joint1", "turn_x")] = 0.2
    rows[::3, flat.slot("joint1", "turn_y")] = -0.1
    start = np.random.default_rng(0).normal(size=(10, 2))
    time = np.linspace(0.0, 0.5, 26)
    position, velocity, _ = flat.simulate(rows, start, 0.0 * start, time)
    wanted, speeds, _ = space.simulate(rows, start, 0.0 * start, time)
    assert np.array_equal(position[::3], wanted[::3])
    assert np.abs(position - wanted).max() < 1e-9
    assert np.abs(velocity - speeds).max() < 1e-8
    # And a copy alone is what it is among others, bit by bit.
    for k in (0, 1):
        alone = flat.simulate(rows[k], start[k], 0.0 * start[k], time)
        assert np.array_equal(alone[0][0], position[k])


def test_what_leaves_the_plane_is_not_taken_for_it() -> None:
    system = planar(2, "rr")
    second = system.joints[1]
    across = np.cross(second.axis, [1.0, 0.0, 0.0])
    tilted = second.axis + 1e-6 * across / np.linalg.norm(across)
    assert LaneModel(system).plane is not None
    assert (
        LaneModel(system.replace_joint(replace(second, axis=constant(tilted / np.linalg.norm(tilted))))).plane is None
    )


def test_arithmetic_is_on_vectors_in_the_machine_code() -> None:
    from numba import types

    from harness.denoc.lanes.planar import planar_accelerations

    numbers, whole = types.float64[::1], types.int64
    signature = (whole[:, ::1], whole[::1], numbers, numbers, numbers, numbers, whole, whole, whole, whole)
    planar_accelerations.compile(signature)
    code = planar_accelerations.inspect_asm(signature)
    packed, single = (
        len(re.findall(rf"^\tv?(?:f[n]?m(?:add|sub)\d+|add|sub|mul|div|sqrt){kind}\t", code, re.MULTILINE))
        for kind in ("pd", "sd")
    )
    if packed + single == 0:
        pytest.skip("the instructions of another kind of processor")
    # What is left to single numbers is the sign of a joint.
    assert packed > 500
    assert single < 0.02 * packed
