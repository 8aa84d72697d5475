"""A wheel without gravity, braked by dry or by viscous friction: both have closed forms."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from harness.cases.case import NATIVE, Bench, Case, Row, Series
from harness.cases.checks import Measured
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

INERTIA, SPEED, DRY, VISCOUS = 0.02, 3.0, 0.012, 0.01  # kg·m², rad/s, N·m, N·m·s


def system() -> System:
    hub = Joint("hub", JointType.CONTINUOUS, "base", "wheel", axis=constant([0.0, 0.0, 1.0]))
    return System(
        "wheel",
        (hub,),
        (Link("wheel", 1.0, inertia=constant(np.diag([0.01, 0.01, INERTIA]))),),
        gravity=constant(np.zeros(3)),
    )


def dry(bench: Bench) -> Iterable[Row | Series]:
    """It stops after J ω / T at the angle J ω² / 2T, and stays there."""
    stop, angle = INERTIA * SPEED / DRY, INERTIA * SPEED**2 / (2.0 * DRY)
    if NATIVE not in bench.models:
        return
    model = bench.build(NATIVE, bench.system.replace_joint(replace(bench.system.joint("hub"), friction=DRY)))
    time = np.linspace(0.0, 2.0 * stop, 401)
    run = model.simulate(np.zeros(1), np.array([SPEED]), time)
    sliding = np.minimum(time, stop)
    true = SPEED * sliding - DRY * sliding**2 / (2.0 * INERTIA)
    yield bench.row(
        "dry_friction_stop",
        (NATIVE, "analytic"),
        float(np.abs(run.position[:, 0] - true).max()),
        1e-9,
        unit="rad",
        why="piecewise quadratic motion; the stop is an event located in time",
        note=f"at rest after {stop:g} s at {angle:g} rad, and held there",
        about={"term": "dry_friction", "joint": "hub"},
        source="J dω/dt = −T until rest, then stuck",
    )


def viscous(bench: Bench) -> Iterable[Row | Series]:
    """The speed falls as exp(−ξ t / J)."""
    time = np.linspace(0.0, 5.0, 251)
    true = SPEED * INERTIA / VISCOUS * (1.0 - np.exp(-VISCOUS * time / INERTIA))
    braked = bench.system.replace_joint(replace(bench.system.joint("hub"), damping=VISCOUS))
    for name in bench.models:
        if name == "analytic":
            continue
        run = bench.build(name, braked).simulate(np.zeros(1), np.array([SPEED]), time)
        yield bench.row(
            "viscous_decay",
            (name, "analytic"),
            float(np.abs(run.position[:, 0] - true).max()),
            1e-8,
            unit="rad",
            why="RK4 at 1 ms or adaptive integration at 1e-10",
            about={"term": "damping", "joint": "hub"},
            source="θ(t) = ω J/ξ (1 − exp(−ξ t / J))",
        )


CASE = Case(
    name="rotor",
    title="A wheel braked by dry and by viscous friction",
    source="closed forms of the braked wheel",
    system=system,
    checks=(Measured("dry_friction_stop", dry), Measured("viscous_decay", viscous)),
)
