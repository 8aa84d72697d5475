"""Bricard's mechanism: counted degrees of freedom say that it cannot move, and it does."""

from dataclasses import replace

import numpy as np

from harness.cases.case import NATIVE, Bench, Case, Row
from harness.cases.checks import EnergyKept, Measured
from harness.cases.checks.loop_motion import LoopMotion, LoopsKept
from harness.cases.checks.states import States, difference_of, evaluate, random_states
from harness.cases.loop_mechanisms import bricard
from harness.cases.users import state_checks
from harness.compare.closed_blame import blame_closed
from harness.denoc.loops.closed import Closed
from harness.engines.registry import engine
from harness.system import Frame, Joint, JointType, Link, Loop, Mimic, System
from harness.system.closure import closed_position, usual_rank
from harness.system.description import constant


def independent(bench: Bench) -> list[Row]:
    """Five tree joints, five conditions, of which four are independent: one degree of freedom is left."""
    found = usual_rank(bench.system, closed_position(bench.system))
    return [
        bench.row(
            "independent_conditions",
            ("denoc", "published"),
            abs(found - 4),
            0.0,
            why="a count",
            note=f"{found} of {sum(len(loop.conditions) for loop in bench.system.loops)}",
            source="one degree of freedom: IFToMM library of computational multibody problems, A03",
        )
    ]


def on_a_table() -> System:
    """The mechanism on a table that turns about an oblique axis, so that both frames that close it move."""
    system = bricard()
    axle = Joint("table", JointType.REVOLUTE, system.base, "table", axis=constant([0.48, 0.6, 0.64]))
    table = Link("table", 2.0, inertia=constant(0.3 * np.eye(3)))

    def moved(frame: Frame) -> Frame:
        return replace(frame, link="table") if frame.link == system.base else frame

    joints = (replace(joint, parent="table") if joint.parent == system.base else joint for joint in system.joints)
    loops = (
        replace(loop, first=moved(loop.first), second=moved(loop.second))
        for loop in system.loops
        if isinstance(loop, Loop)
    )
    return replace(system, joints=(axle, *joints), links=(table, *system.links), loops=tuple(loops))


def by_columns(bench: Bench) -> list[Row]:
    """What holds loops beside links that bend, followers and struts without mass, where other engines know the answer.

    A link of no mass that follows the table changes nothing but that the tree's columns are asked one by one.
    """
    system = on_a_table()
    peers = [name for name in ("pinocchio", "mujoco") if name in bench.models]
    if NATIVE not in bench.models or not peers:
        return []
    table = replace(bench, system=system, models={name: engine(name).build(system) for name in (NATIVE, *peers)})
    drawn = random_states(table, 24, 1.0, 1.0, 0.0)
    pointer = Joint("pointer", JointType.REVOLUTE, "table", "pointer", mimic=Mimic("table"))
    model = Closed(replace(system, joints=(*system.joints, pointer), links=(*system.links, Link("pointer"))))
    # Not where the mechanism is singular: there it asks of a table that turns what no motion gives.
    spectra = np.array([np.linalg.svd(model.loop_jacobian(q), compute_uv=False) for q in drawn.q])
    regular = spectra[:, usual_rank(system, closed_position(system)) - 1] > 1e-2 * spectra[:, 0]
    states = States(drawn.q[regular], drawn.qd[regular], drawn.qdd[regular], drawn.tau[regular])
    mass = np.array([model.mass_matrix(q) for q in states.q])
    found = evaluate("acceleration", model, states)
    rows = []
    for name in peers:
        apart = difference_of("acceleration", mass, found, evaluate("acceleration", table.models[name], states))
        note, about = f"on a turning table, {len(states.q)} states", None
        if not apart.max() <= 1e-11:
            blame = blame_closed(table.models[name], model, states.q, states.qd, states.tau, allowed=1e-11)
            note = "the native loops over inverse dynamics, column by column, differ"
            note, about = "; ".join(filter(None, [note, blame.words])), {"term": blame.term or "loops"}
        rows.append(
            bench.row(
                "acceleration_by_columns",
                (NATIVE, name),
                float(apart.max()),
                1e-11,
                why="rounding, and unit accelerations made large in one sum with gravity",
                note=note,
                about=about,
            )
        )
    return rows


CASE = Case(
    name="bricard",
    title="Bricard's over-constrained mechanism, falling from rest",
    source="IFToMM library of computational multibody problems, A03: energy is kept, one condition is redundant",
    system=bricard,
    checks=(
        *state_checks(5),
        Measured("independent_conditions", independent),
        Measured("acceleration_by_columns", by_columns),
        LoopMotion(duration=1.0, mujoco=1e-6),
        LoopsKept(),
        EnergyKept(allowed=1e-8, why="adaptive integration at relative tolerance 1e-10", duration=10.0),
    ),
    group="loops",
    cost=15.0,
)
