"""Beams that bend in both planes, twist and carry joints off their axis: no finite element here knows them; the textbook does."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Case, Row, Series
from harness.cases.checks import Measured, StateAgreement
from harness.cases.checks.batch import BATCHES, BatchAgreement
from harness.cases.checks.lane_motion import LaneAgreement
from harness.cases.checks.states import random_states
from harness.cases.checks.textbook import TEXTBOOK, AgainstTextbook, Textbook
from harness.cases.lane_mechanisms import FLEXIBLE
from harness.compare import quantities
from harness.compare.single_answer import blame_momentum
from harness.system import Beam, Joint, JointType, Link, System
from harness.system.description import constant
from harness.system.flexible_link import flexible_link
from harness.system.rotation import from_rpy

# Elastic coordinates that turn sections by some tenths of a radian, so that what is of second order is seen.
ELASTIC = 0.02
STATES = 4
WHY = "rounding of double precision, and of the differences that the textbook's velocity forces are taken from"


def _beam(direction: tuple[float, float, float], bending: tuple[float, float, float], **given: Any) -> Beam:
    beam = Beam(
        length=0.5,
        direction=constant(direction),
        bending=constant(bending),
        mass=0.3,
        bending_stiffness=4.0,
        bending2=True,
        bending_stiffness2=7.0,
        modes=2,
        material_damping=1e-3,
    )
    return replace(beam, **given)


def system(stiffening: bool = True, planes: int = 2) -> System:
    """A beam on an oblique hinge with a slider halfway along it and a plate welded to its tip; on the slider a second beam.

    planes: that each beam bends in; in two it twists as well.
    """
    tensor = constant([[3e-4, 5e-5, -4e-5], [5e-5, 4e-4, 3e-5], [-4e-5, 3e-5, 5e-4]])
    first = _beam(
        (0.6, 0.0, 0.8),
        (0.0, 1.0, 0.0),
        bending2=planes == 2,
        torsion_modes=planes - 1,
        torsional_stiffness=3.0,
        polar_inertia=2e-4,
        payload=0.05,
        payload_inertia=tensor,
        geometric_stiffening=stiffening,
    )
    # It twists too: what twist does to a beam that turns about a fixed axis alone no joint feels.
    second = _beam(
        (0.0, 0.28, -0.96),
        (1.0, 0.0, 0.0),
        modes=1,
        length=0.3,
        bending2=planes == 2,
        torsion_modes=planes - 1,
        torsional_stiffness=2.0,
        polar_inertia=3e-4,
        geometric_stiffening=stiffening,
    )
    turned = constant(from_rpy(constant([0.4, -0.3, 0.7])))
    tip = 0.5 * np.array([0.6, 0.0, 0.8])
    joints = (
        Joint("shoulder", JointType.REVOLUTE, "base", "upper", xyz=constant([0.1, -0.2, 0.3]), rotation=turned,
              axis=constant([0.48, 0.6, 0.64]), armature=0.01, damping=0.02),
        Joint("rail", JointType.PRISMATIC, "upper", "carriage", xyz=constant(0.6 * tip + np.array([0.02, -0.03, 0.01])),
              rotation=constant(from_rpy(constant([-0.5, 0.2, 0.3]))), axis=constant([0.0, 0.6, 0.8]), stiffness=30.0,
              rest_position=0.1),
        Joint("weld", JointType.FIXED, "upper", "plate", xyz=constant(tip + np.array([0.0, 0.02, 0.01])), rotation=turned),
        Joint("elbow", JointType.REVOLUTE, "carriage", "lower", xyz=constant([0.05, 0.02, -0.04]),
              rotation=constant(from_rpy(constant([0.2, 0.5, -0.4]))), axis=constant([0.8, 0.0, 0.6]), damping=0.01),
        Joint("wrist", JointType.REVOLUTE, "lower", "hand", xyz=constant([0.01, 0.3 * 0.28, -0.3 * 0.96]),
              axis=constant([0.0, 1.0, 0.0]), armature=1e-3),
    )  # fmt: skip
    block = constant([[2e-3, 1e-4, 2e-4], [1e-4, 3e-3, -1e-4], [2e-4, -1e-4, 2.5e-3]])
    links = (
        flexible_link("upper", first),
        Link("carriage", 0.4, constant([0.03, -0.02, 0.05]), block),
        Link("plate", 0.1, constant([0.01, 0.02, -0.03]), constant(0.2 * block)),
        flexible_link("lower", second),
        Link("hand", 0.2, constant([-0.02, 0.04, 0.03]), constant(0.5 * block)),
    )
    return System("beams bent in space", joints, links, gravity=constant([0.6, -1.2, -9.7]))


def _states(bench: Bench) -> tuple[Textbook, Array, Array]:
    states = random_states(bench, STATES, 1.0, 1.0, ELASTIC)
    return Textbook(bench.system.coordinate_names, bench.system), states.q, states.qd


def coriolis(bench: Bench) -> Iterable[Row | Series]:
    """C + Cᵀ = Ṁ, whatever the matrix."""
    book, q, qd = _states(bench)
    found = [bench.native.coriolis_matrix(*state) for state in zip(q, qd, strict=True)]
    rates = [book.mass_rate(*state) for state in zip(q, qd, strict=True)]
    about = {"term": "coriolis_matrix"}
    yield _row(bench, "coriolis_matrix_bent", np.array([c + c.T for c in found]), np.array(rates), about)


def momentum(bench: Bench) -> Iterable[Row | Series]:
    book, q, qd = _states(bench)
    found = [bench.native.momentum(*state) for state in zip(q, qd, strict=True)]
    true = [book.momentum_matrix(x) @ v for x, v in zip(q, qd, strict=True)]
    apart = float(quantities.relative(np.array(found), np.array(true)).max())
    said: str = ""
    place: dict[str, object] | None = None
    if not apart <= 1e-10:
        ours = np.array([[bench.native.momentum(x, unit) for unit in np.eye(len(book.names))] for x in q]).swapaxes(
            1, 2
        )
        said, place = blame_momentum(book.names, np.array([book.momentum_matrix(x) for x in q]), ours, 1e-10)
    yield bench.row("momentum_bent", (NATIVE, TEXTBOOK), apart, 1e-10, why=WHY, note=said, first_divergence=place)


def places(bench: Bench) -> Iterable[Row | Series]:
    """Where every link's frame stands; how it is turned is told by where those stand that it carries."""
    book, q, _ = _states(bench)
    found = [[bench.native.link_pose(x, link.name)[1] for link in bench.system.links] for x in q]
    true = np.array([book.origins(x) for x in q])
    far = np.abs(np.array(found) - true).max(axis=(0, 2))
    off = [link.name for link, apart in zip(bench.system.links, far, strict=True) if not apart <= 1e-10]
    about = {"term": "link_pose", "link": off[0]} if off else {"term": "link_pose"}
    yield _row(bench, "link_place_bent", np.array(found), true, about)


def accelerometer(bench: Bench) -> Iterable[Row | Series]:
    """What a sensor at the first beam's tip reads in free motion: J q̈ + J̇ q̇ of a mark there less gravity, along its bending."""
    book, q, qd = _states(bench)
    first = bench.system.links[0].beam
    assert first is not None
    tip = first.length * first.direction
    marks = [
        Joint(f"mark {k}", JointType.FIXED, "upper", f"mark {k}", xyz=constant(tip + k * first.bending)) for k in (0, 1)
    ]
    marked = replace(
        bench.system,
        joints=(*bench.system.joints, *marks),
        links=(*bench.system.links, *(Link(mark.child) for mark in marks)),
    )
    placed = Textbook(bench.system.coordinate_names, marked)
    found, true = [], []
    still = np.zeros_like(q[0])
    for x, v in zip(q, qd, strict=True):
        here, along = placed.origins(x)[-2:]
        rate = 1e-4
        turning = (placed.velocities(x + rate * v)[-2] - placed.velocities(x - rate * v)[-2]) / (2.0 * rate)
        moved = placed.velocities(x)[-2] @ book.forward_dynamics(x, v, still) + turning @ v
        true.append([float((along - here) @ (moved - bench.system.gravity))])
        read = bench.native.simulate(x, v, np.array([0.0, 1e-6])).channels["upper.tip_acceleration"]
        found.append([float(read[0])])
    apart = quantities.relative(np.array(found), np.array(true))
    note = "" if apart.max() <= 1e-6 else "the native tip acceleration is not the mark's"
    yield bench.row(
        "tip_acceleration_bent",
        (NATIVE, TEXTBOOK),
        float(apart.max()),
        1e-6,
        why="central differences of J",
        note=note,
        about={"term": "tip_acceleration", "link": "upper"},
    )


def _row(bench: Bench, quantity: str, ours: Array, theirs: Array, about: Mapping[str, object]) -> Row:
    apart = quantities.relative(ours, theirs)
    note = "" if apart.max() <= 1e-10 else f"the native {quantity.replace('_', ' ')} is not the textbook's"
    return bench.row(quantity, (NATIVE, TEXTBOOK), float(apart.max()), 1e-10, why=WHY, note=note, about=about)


def _agrees(of: str) -> AgainstTextbook:
    return AgainstTextbook(StateAgreement(of, 1e-10, WHY, states=STATES, elastic=ELASTIC))


_ANSWERS = ("acceleration", "inverse_dynamics", "mass_matrix", "bias", "gravity", "energy")
_SOURCE = "S. K. Saha, ASME J. Applied Mechanics 66 (1999) 986-996, integrated node by node, and Lagrange's equations"
CASES = (
    Case(
        name="bent_in_space",
        title="Beams bent in both planes and twisted, with joints off their axis",
        source=_SOURCE,
        system=system,
        checks=(
            *(_agrees(of) for of in _ANSWERS),
            *(AgainstTextbook(BatchAgreement(of, 1e-10, WHY, states=11, elastic=ELASTIC)) for of in BATCHES),
            Measured("coriolis_matrix_bent", coriolis),
            Measured("momentum_bent", momentum),
            Measured("link_place_bent", places),
            Measured("tip_acceleration_bent", accelerometer),
        ),
        group="flexible",
        engines=(NATIVE,),
        cost=10.0,
    ),
    Case(
        name="bent_in_space_unstiffened",
        title="The same beams without geometric stiffening",
        source=_SOURCE,
        system=lambda: system(stiffening=False),
        checks=tuple(_agrees(of) for of in ("acceleration", "mass_matrix", "bias")),
        group="flexible",
        engines=(NATIVE,),
        cost=5.0,
    ),
    Case(
        name="lanes_bent_in_space",
        title="Beams bent in one plane each, with joints off their axis, in the lanes",
        source="the native run of one mechanism, which the case bent_in_space holds",
        system=lambda: system(planes=1),
        checks=(
            LaneAgreement(1e-7, FLEXIBLE, duration=0.2, against_single=True),
            LaneAgreement(
                1e-6,
                "exponential method of order four at 0.2 ms",
                method="exponential",
                lane_step=2e-4,
                duration=0.2,
                against_single=True,
            ),
        ),
        group="lanes",
        engines=(NATIVE,),
        cost=10.0,
    ),
)  # fmt: skip
