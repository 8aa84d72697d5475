"""Whole mechanisms in the lanes: chains and trees, in the plane and in space, rigid and flexible, by each stepper."""

from dataclasses import replace
from functools import partial
from typing import Any

from harness.cases.beams import flexible_pendulum, strip, two_strips
from harness.cases.case import Case
from harness.cases.checks.lane_motion import LaneAgreement
from harness.cases.double_pendulum import CASE as DOUBLE_PENDULUM
from harness.system import System, random_chain, random_tree

RIGID = ("denoc", "pinocchio", "mujoco")
WHY = "adaptive integration at 1e-11 a step against RK4 at 0.2 ms or 1e-12, on a regular motion"
FIXED = "RK4 at 0.5 ms on a regular motion"
FLEXIBLE = "adaptive integration at 1e-11 a step in both, of a vibration of up to some hundred hertz"


def sprung_tree() -> System:
    tree = random_tree(6, seed=61, prismatic=0.3, fixed=0.2, armature=True, damping=True)
    return replace(tree, joints=tuple(replace(joint, stiffness=1.5, rest_position=0.2) for joint in tree.joints))


def _both(**options: Any) -> tuple[LaneAgreement, ...]:
    """By the recursion for the plane and by the one for space."""
    return tuple(LaneAgreement(planar=planar, **options) for planar in (True, False))


CASES = (
    Case(
        name="lanes_chain",
        title="A chain of four joints in general position, in the lanes",
        source="Pinocchio's and MuJoCo's equations and integrators",
        system=partial(random_chain, 4, seed=64, prismatic=0.25, armature=True, damping=True),
        checks=(
            LaneAgreement(1e-8, WHY, velocity=(("joint1", 0.4),), step=2e-4),
            LaneAgreement(1e-7, FIXED, method="rk4", lane_step=5e-4, velocity=(("joint1", 0.4),), step=2e-4),
        ),
        group="lanes",
        engines=RIGID,
    ),
    Case(
        name="lanes_tree",
        title="A tree with sliders, fixed joints and springs, in the lanes",
        source="Pinocchio's and MuJoCo's equations and integrators",
        system=sprung_tree,
        checks=(LaneAgreement(1e-8, WHY, step=2e-4),),
        group="lanes",
        engines=RIGID,
    ),
    Case(
        name="lanes_double_pendulum",
        title="The double pendulum, in the lanes",
        source="Pinocchio's and MuJoCo's equations and integrators",
        system=DOUBLE_PENDULUM.system,
        checks=(
            *_both(allowed=1e-8, why=WHY, position=(("shoulder", 1.0), ("elbow", 0.5)), step=2e-4),
            *_both(allowed=1e-7, why=FIXED, method="rk4", lane_step=5e-4, position=(("shoulder", 1.0),), step=2e-4),
        ),
        group="lanes",
        engines=RIGID,
    ),
    Case(
        name="lanes_flexible_pendulum",
        title="A strip with a payload on a hinge, in the lanes",
        source="the native run of one mechanism, which finite elements hold in the case flexible_pendulum",
        system=partial(flexible_pendulum, strip(modes=2, payload=0.02)),
        checks=(
            *_both(allowed=1e-8, why=FLEXIBLE, position=(("pivot", 1.0),), duration=0.5, against_single=True),
            *_both(
                allowed=1e-6,
                why="exponential method of order four at 0.5 ms, which need not resolve the vibration",
                method="exponential",
                lane_step=5e-4,
                position=(("pivot", 1.0),),
                duration=0.5,
                against_single=True,
            ),
        ),
        group="lanes",
        engines=("denoc",),
    ),
    Case(
        name="lanes_long_steps",
        title="The same strip, swinging little, in the lanes with steps longer than its vibration's radian",
        source="the native run of one mechanism, which finite elements hold in the case flexible_pendulum",
        system=partial(flexible_pendulum, strip(modes=2, payload=0.02)),
        checks=_both(
            allowed=1e-8,
            why="what is linear is carried exactly over any step; what is not is as small as the swing cubed",
            method="exponential",
            lane_step=5e-3,
            position=(("pivot", 0.02),),
            duration=0.5,
            against_single=True,
        ),
        group="lanes",
        engines=("denoc",),
    ),
    Case(
        name="lanes_two_flexible_links",
        title="Two strips hinged end to end, in the lanes",
        source="the native run of one mechanism, which finite elements hold in the case two_flexible_links",
        system=partial(two_strips, 2),
        checks=_both(allowed=1e-7, why=FLEXIBLE, position=(("shoulder", -1.0),), duration=0.25, against_single=True),
        group="lanes",
        engines=("denoc",),
    ),
)
