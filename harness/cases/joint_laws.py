"""Every law that acts at a joint of the lanes, one at a time on a wheel, in the plane and in space."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Case, Row, Series
from harness.cases.checks import Measured
from harness.cases.joint_law_truths import LAWS, Law
from harness.cases.rotor import INERTIA, system
from harness.denoc import Denoc
from harness.denoc.joint_laws.address import teeth
from harness.denoc.lanes.model import LaneModel
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

RATE = 100.0


def _lanes(bench: Bench, planar: bool) -> Iterable[Row | Series]:
    plain = LaneModel(bench.system, planar=planar)
    toothed = LaneModel(bench.system, planar=planar, law=teeth)
    for law in LAWS:
        model = toothed if law.teeth else plain
        yield _row(bench, law, model, planar)


def _row(bench: Bench, law: Law, model: LaneModel, planar: bool) -> Row:
    time = np.linspace(0.0, law.duration, round(law.duration * RATE) + 1)
    row = model.row()
    for name, value in law.slots.items():
        row[model.slot("hub", name)] = value
    if law.teeth:
        row[model.slot("hub", "user_scale")] = 1.0
        for k, value in enumerate(law.teeth):
            row[model.slot("hub", f"user_{k + 1}")] = value
    tau = None if law.torque is None else law.torque(time)[:, None]
    found = model.simulate(row, np.array(law.start[:1]), np.array(law.start[1:]), time, tau=tau, hold="zero")[0][
        0, :, 0
    ]
    return _told(
        bench,
        f"{law.name}_{'planar' if planar else 'spatial'}",
        law.name,
        f"the law {law.name.replace('_', ' ')}",
        "hub",
        time,
        np.abs(found - law.truth(time)),
        allowed=law.allowed,
        unit="rad",
        why=law.why,
        source=law.source,
    )


def _told(
    bench: Bench,
    quantity: str,
    term: str,
    law: str,
    joint: str,
    time: Array,
    apart: Array,
    *,
    allowed: float = 1e-8,
    unit: str,
    why: str,
    source: str,
) -> Row:
    """A row of a motion's difference [rad or m], shape (T,), that says when it left the line, in what law and at what joint.

    term, law: the law, for a program and in words.
    """
    worst = int(np.argmax(apart)) if np.isfinite(apart).all() else int(np.argmin(np.isfinite(apart)))
    place: dict[str, object] | None = None
    if not apart.max() <= allowed:
        place = {"time": float(time[int(np.argmax(~(apart <= allowed)))]), "term": term, "joint": joint}
    return bench.row(
        quantity,
        (NATIVE, "analytic"),
        float(apart[worst]),
        allowed,
        note="" if place is None else f"{law} at {joint}",
        first_divergence=place,
        unit=unit,
        why=why,
        source=source,
    )


def planar(bench: Bench) -> Iterable[Row | Series]:
    return _lanes(bench, planar=True)


def spatial(bench: Bench) -> Iterable[Row | Series]:
    return _lanes(bench, planar=False)


def bearing(bench: Bench) -> Iterable[Row | Series]:
    """Friction by the load on a bearing: a balanced wheel on a level axle carries its weight, whatever it turns at."""
    mass, mu_radius, speed = 1.0, 2e-3, 3.0
    axle = Joint("axle", JointType.CONTINUOUS, "base", "wheel", axis=constant([0.0, 1.0, 0.0]))
    wheel = Link("wheel", mass, inertia=constant(np.diag([0.01, INERTIA, 0.01])))
    system = System("wheel on a level axle", (axle,), (wheel,))
    braking = mu_radius * mass * 9.81
    stop = INERTIA * speed / braking
    time = np.linspace(0.0, 1.5 * stop, 201)
    sliding = np.minimum(time, stop)
    true = speed * sliding - 0.5 * braking / INERTIA * sliding**2
    for planar in (True, False):
        model = LaneModel(system, planar=planar)
        row = model.row()
        row[model.slot("axle", "mu_radius")] = mu_radius
        found = model.simulate(row, np.zeros(1), np.array([speed]), time)[0][0, :, 0]
        yield _told(
            bench,
            f"load_friction_{'planar' if planar else 'spatial'}",
            "load_friction",
            "friction by load",
            "axle",
            time,
            np.abs(found - true),
            unit="rad",
            why="1e-11 a step; the stop is located in time",
            source="J ω' = −μ r m g until rest, then stuck",
        )


def shaken(bench: Bench) -> Iterable[Row | Series]:
    """A free slider on a shaken base stays where it is in space, so that it mirrors the base's motion."""
    rail = Joint("rail", JointType.PRISMATIC, "base", "slider", axis=constant([1.0, 0.0, 0.0]))
    system = System("slider", (rail,), (Link("slider", 2.0, inertia=constant(0.01 * np.eye(3))),))
    amplitude, frequency, phase = 0.7, 1.3, 0.4
    time = np.linspace(0.0, 2.0, 201)
    turn = 2.0 * np.pi * frequency
    true = amplitude / turn**2 * (np.sin(turn * time + phase) - np.sin(phase) - turn * time * np.cos(phase))
    for planar in (True, False):
        model = LaneModel(system, planar=planar)
        row = model.row()
        for name, value in (("amplitude", amplitude), ("frequency", frequency), ("phase", phase)):
            row[model.slot("base", f"excitation_{name}")] = value
        found = model.simulate(row, np.zeros(1), np.zeros(1), time)[0][0, :, 0]
        yield _told(
            bench,
            f"base_excitation_{'planar' if planar else 'spatial'}",
            "base_excitation",
            "shaking of the base",
            "rail",
            time,
            np.abs(found - true),
            unit="m",
            why="1e-11 a step",
            source="x'' = −a sin(2π f t + φ) in the base's frame",
        )


def breaking_loose(bench: Bench) -> Iterable[Row | Series]:
    """Dry friction that holds until it is pushed too hard, in the native run of a single mechanism."""
    law = next(law for law in LAWS if law.name == "break_loose")
    assert law.torque is not None
    time = np.linspace(0.0, law.duration, round(law.duration * RATE) + 1)
    friction = law.slots["coulomb_torque"]
    native = Denoc(bench.system.replace_joint(replace(bench.system.joint("hub"), friction=friction)))
    run = native.simulate([law.start[0]], [0.0], time, tau=law.torque(time)[:, None])
    yield _told(
        bench,
        "break_loose",
        "dry_friction",
        "dry friction that holds",
        "hub",
        time,
        np.abs(run.position[:, 0] - law.truth(time)),
        unit="rad",
        why="where it breaks loose and where it stops are located in time",
        source=law.source,
    )


def breaking_loose_between(bench: Bench) -> Iterable[Row | Series]:
    """The same where the push rises between two samples, and the step has to find where it is too hard."""
    friction, rise = 0.02, 0.05
    native = Denoc(bench.system.replace_joint(replace(bench.system.joint("hub"), friction=friction)))
    time = np.array([0.0, 1.0])
    run = native.simulate([0.0], [0.0], time, tau=rise * time[:, None], hold="linear")
    sliding = np.maximum(time - friction / rise, 0.0)
    yield _told(
        bench,
        "break_loose_between",
        "dry_friction",
        "dry friction that holds",
        "hub",
        time,
        np.abs(run.position[:, 0] - rise / INERTIA * sliding**3 / 6.0),
        unit="rad",
        why="where it breaks loose is located in time",
        source="J ω' = r t − f from t = f / r",
    )


CASE = Case(
    name="joint_laws",
    title="Every law that acts at a joint, one at a time on a wheel",
    source="closed forms, and each law's own equation integrated by SciPy's DOP853 at 1e-12",
    system=system,
    checks=(
        Measured("laws_planar", planar),
        Measured("laws_spatial", spatial),
        Measured("load_friction", bearing),
        Measured("base_excitation", shaken),
        Measured("break_loose", breaking_loose),
        Measured("break_loose_between", breaking_loose_between),
    ),
    group="lanes",
    engines=(NATIVE,),
    cost=4.0,
)
