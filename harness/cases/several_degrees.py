"""Free, ball, planar, universal and screw joints and joints that follow others: states, motion, and steps on the manifold."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Case, Row, Series
from harness.cases.checks import EnergyKept, Measured, TrajectoryAgreement
from harness.cases.checks.trajectory import initial_state
from harness.cases.users import state_checks
from harness.compare import quantities
from harness.system import System
from harness.system.description import constant
from harness.system.manifold import quaternions
from harness.system.random_joints import following, free_of_a_link, in_space, random_position

STATES = 6
DURATION = 20.0  # s of flight: momentum and energy have no reason to change in it
# A throw that turns every joint, and none through a singular angle.
THROWN = (
    ("root.vx", 0.4), ("root.vz", 2.0), ("root.wx", 0.7), ("root.wy", -0.4), ("root.wz", 1.1), ("hip.wx", -0.8),
    ("hip.wz", 0.6), ("knee", 1.2), ("table.x", 0.3), ("table.angle", -0.7), ("cardan.angle1", 0.5),
)  # fmt: skip
ROUNDING = "one pass over the joints: rounding of double precision, twenty times over"
MARCHED = "MuJoCo by RK4 in rotations, the others in components of quaternions: errors of order h⁴ of steps of 0.2 ms"


def weightless() -> System:
    """The same in space, and nothing that takes energy or momentum from it."""
    system = in_space()
    joints = tuple(replace(joint, damping=0.0, armature=0.0) for joint in system.joints)
    return replace(system, joints=joints, gravity=constant([0.0, 0.0, 0.0]))


def momentum_kept(bench: Bench) -> Iterable[Row | Series]:
    """Momentum about the base's origin of what flies freely stands still: no force from outside acts."""
    if NATIVE not in bench.models:
        return
    model = bench.native
    run = model.simulate(
        *initial_state(bench.system, {}, dict(THROWN)), np.linspace(0.0, DURATION, 201), rtol=1e-12, atol=1e-13
    )
    found = np.array([model.momentum(q, v) for q, v in zip(run.position, run.velocity, strict=True)])
    yield bench.row(
        "momentum_kept",
        (NATIVE, "analytic"),
        float(np.abs(found - found[0]).max() / np.abs(found[0]).max()),
        1e-9,
        why="some thousand steps that err by 1e-12 each",
        note=f"over {DURATION:g} s",
        about={"term": "momentum"},
        source="conservation of momentum",
    )


def steps(bench: Bench) -> Iterable[Row | Series]:
    """A step of velocities, the step between two positions, and rates of quaternions, as MuJoCo moves its own positions."""
    other: Any = bench.models.get("mujoco")
    if other is None or NATIVE not in bench.models:
        return
    import mujoco

    system, model, rng = bench.system, bench.native, bench.rng()
    turning = [(at, spin) for _, at, spin in quaternions(system)]
    names = [joint for joint, _, _ in quaternions(system)]
    whole: dict[str, tuple[list[Array], list[Array]]] = {
        key: ([], []) for key in ("integrate", "difference", "position_rates")
    }
    for _ in range(STATES):
        q, step = random_position(system, rng), rng.standard_normal(model.n)
        reached = model.integrate(q, step)
        back = model.difference(q, reached)
        rates = model.position_rates(q, step)
        for at, spin in turning:
            turned, rotated, derived = q[at : at + 4].copy(), np.empty(3), np.empty(4)
            mujoco.mju_quatIntegrate(turned, step[spin : spin + 3], 1.0)
            mujoco.mju_subQuat(rotated, reached[at : at + 4], q[at : at + 4])
            # MuJoCo's derivative is of a spin in the world's axes.
            world = np.empty(3)
            mujoco.mju_rotVecQuat(world, step[spin : spin + 3], q[at : at + 4])
            mujoco.mju_derivQuat(derived, q[at : at + 4], world)
            sign = np.sign(turned @ reached[at : at + 4])  # a quaternion and its negative are one rotation
            for key, ours, theirs in (
                ("integrate", reached[at : at + 4], sign * turned),
                ("difference", back[spin : spin + 3], rotated),
                ("position_rates", rates[at : at + 4], derived),
            ):
                whole[key][0].append(ours)
                whole[key][1].append(theirs)
    for key, pair in whole.items():
        each = quantities.relative(np.array(pair[0]), np.array(pair[1]))
        off = sorted({joint for joint, far in zip(names * STATES, each, strict=True) if not far <= 1e-13})
        yield bench.row(
            f"manifold_{key}",
            (NATIVE, "mujoco"),
            float(each.max()),
            1e-13,
            why=ROUNDING,
            note=f"turning of {' and '.join(f'joint {name!r}' for name in off)}" if off else "",
            about={"term": f"manifold_{key}", "joint": off[0]} if off else None,
        )


def followers(bench: Bench) -> Iterable[Row | Series]:
    """Where followers and screws put their links against their parents, by the laws as they are written in ``following``."""
    if NATIVE not in bench.models:
        return
    from scipy.spatial.transform import Rotation

    system, model, rng = bench.system, bench.native, bench.rng()
    places = {name: k for k, name in enumerate(system.position_names)}
    found, true = [], []
    for _ in range(STATES):
        q = random_position(system, rng)
        thumb, screw = float(q[places["thumb"]]), float(q[places["screw"]])
        finger = -0.5 * thumb + 0.2
        tip = 2.0 * finger - 0.1
        # Turn [rad] and shift [m] along the axis, of each joint.
        moved = {"screw": (screw, 0.1 * screw), "thumb": (thumb, 0.0), "finger": (0.0, finger), "tip": (tip, 0.3 * tip)}
        for name, (angle, shift) in moved.items():
            joint = system.joint(name)
            (above, origin), (turn, place) = model.link_pose(q, joint.parent), model.link_pose(q, joint.child)
            found.append(np.append((above.T @ turn).ravel(), above.T @ (place - origin)))
            own = joint.rotation @ Rotation.from_rotvec(angle * joint.axis).as_matrix()
            true.append(np.append(own.ravel(), joint.xyz + joint.rotation @ (shift * joint.axis)))
    apart = np.abs(np.array(found) - np.array(true)).max(axis=1)
    names = list(moved)
    off = [name for k, name in enumerate(names) if not apart[k :: len(names)].max() <= 1e-13]
    yield bench.row(
        "followers_place",
        (NATIVE, "analytic"),
        float(apart.max()),
        1e-13,
        why=ROUNDING,
        note=f"what {' and '.join(f'joint {name!r}' for name in off)} does as it, or the one it follows, moves"
        if off
        else "",
        first_divergence={"term": "mimic" if system.joint(off[0]).mimic else "pitch", "joint": off[0]} if off else None,
        source="finger = −0.5 thumb + 0.2, tip = 2 finger − 0.1, pitches of 0.1 and 0.3 m/rad",
    )


def _case(name: str, title: str, build: Callable[[], System], *more: Any) -> Case:
    system = build()
    return Case(
        name=name,
        title=title,
        source="agreement of independent engines at random states",
        system=build,
        checks=(*state_checks(system.nv), *more),
        group="rigid",
    )


CASES = (
    _case(
        "joints_in_space",
        "Free body that carries a ball, a planar, a universal and a sprung revolute joint",
        in_space,
        TrajectoryAgreement(1e-8, MARCHED, velocity=THROWN, duration=0.5, rate=20.0, step=2e-4),
        Measured("manifold", steps),
    ),
    _case(
        "joints_that_follow",
        "Ball with a screw, and joints that follow others, one before what it follows",
        following,
        Measured("followers", followers),
    ),
    _case("free_of_a_link", "Free joint between two links that move", free_of_a_link),
    Case(
        name="free_flight",
        title="The same free body and its joints, thrown, without weight or losses",
        source="conservation of momentum and energy",
        system=weightless,
        checks=(
            Measured("momentum_kept", momentum_kept),
            EnergyKept(
                1e-8,
                "a thousand steps of DOP853 that err by its own tolerance of 1e-11",
                velocity=THROWN,
                duration=DURATION,
                samples=201,
            ),
        ),
        group="rigid",
    ),
)
