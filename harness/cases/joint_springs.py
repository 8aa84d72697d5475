"""Springs at joints, slack away from zero, in every engine, and the linear oscillator they make."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Case, Row, Series
from harness.cases.checks import Measured, TrajectoryAgreement
from harness.cases.rotor import INERTIA
from harness.cases.rotor import system as rotor
from harness.cases.users import state_checks
from harness.engines.protocol import EngineModel
from harness.system import System, random_chain

STIFFNESS, REST, START = 0.5, 0.3, 1.1  # N·m/rad, rad, rad


def system() -> System:
    chain = random_chain(5, seed=15, prismatic=0.2, armature=True, damping=True)
    joints = [replace(joint, stiffness=2.0 + k, rest_position=0.4 - 0.3 * k) for k, joint in enumerate(chain.joints)]
    return replace(chain, joints=tuple(joints))


def oscillator(bench: Bench) -> Iterable[Row | Series]:
    """A wheel on a spring swings as a cosine about where the spring is slack."""
    wheel = rotor()
    sprung = wheel.replace_joint(replace(wheel.joint("hub"), stiffness=STIFFNESS, rest_position=REST))
    time = np.linspace(0.0, 4.0, 201)
    omega = np.sqrt(STIFFNESS / INERTIA)
    true = REST + (START - REST) * np.cos(omega * time)
    for name in bench.models:
        run = bench.build(name, sprung).simulate(np.array([START]), np.zeros(1), time, step=1e-3)
        apart = float(np.abs(run.position[:, 0] - true).max())
        said, place = ("", None) if apart <= 1e-7 else _blame(bench.build(name, sprung), true)
        yield bench.row(
            "spring_swing",
            (name, "analytic"),
            apart,
            1e-7,
            unit="rad",
            why="RK4 at 1 ms over three periods, or adaptive integration at 1e-10",
            first_divergence=place,
            note=said,
            source="θ(t) = θ₀ + (θ(0) − θ₀) cos √(k/J) t",
        )


def _blame(model: EngineModel, true: Array) -> tuple[str, dict[str, object]]:
    """Whether the engine pulls otherwise than the spring, or is integrated wrongly."""
    place: dict[str, object] = {"term": "stiffness", "joint": "hub"}
    pulls = np.array([model.forward_dynamics(q[None], np.zeros(1), np.zeros(1))[0] for q in true[:8]])
    if not np.abs(pulls + STIFFNESS / INERTIA * (true[:8] - REST)).max() <= 1e-9 * STIFFNESS / INERTIA:
        return "it does not accelerate as the spring pulls", place
    said = "it accelerates as the spring pulls, so it is the integration"
    return said, {"term": "integration", "joint": "hub"}


CASE = Case(
    name="joint_springs",
    title="Springs at the joints, slack away from zero",
    source="agreement of independent engines; the linear oscillator",
    system=system,
    checks=(
        *state_checks(5),
        TrajectoryAgreement(1e-7, "RK4 at 0.2 ms on a regular motion", duration=1.0, rate=50.0, step=2e-4),
        Measured("spring_swing", oscillator),
    ),
    group="rigid",
    engines=(NATIVE, "pinocchio", "mujoco", "exudyn"),
)
