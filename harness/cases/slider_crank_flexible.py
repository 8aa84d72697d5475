"""A slider-crank whose connecting rod is a thin steel strip that bends, against Exudyn's absolute nodal coordinates."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import Any

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Case, Row, Series, thin
from harness.cases.checks import Measured
from harness.cases.checks.loop_motion import LoopsKept
from harness.cases.checks.trajectory import initial_state
from harness.compare.four_bars import flat, hinge, pin, rod
from harness.engines.exudyn_run import exudyn_package, grid, item, quiet, settings, solve_dynamic, stored
from harness.errors import EngineUnavailableError
from harness.system import Beam, Joint, JointType, System
from harness.system.description import constant
from harness.system.flexible_link import flexible_link

CRANK, LENGTH, ANGLE, TORQUE, DURATION = 0.1, 0.3, 0.5, 0.03, 0.3
# 25 × 1 mm of steel: pinned at both ends it vibrates at 25 Hz.
MASS, STIFFNESS, AXIAL = 0.025e-3 * LENGTH * 7850.0, 2.0e11 * 0.025 * 1e-9 / 12.0, 2.0e11 * 0.025e-3
CRANK_MASS, SLIDER = 0.2, 0.1
ELEMENTS, STEP = 12, 1e-4


def system() -> System:
    """Crank, strip and slider; the strip has four modes in the plane."""
    beam = Beam(
        length=LENGTH,
        direction=constant([1.0, 0.0, 0.0]),
        bending=constant([0.0, 1.0, 0.0]),
        mass=MASS,
        bending_stiffness=STIFFNESS,
        modes=4,
    )
    joints = (
        hinge("crank", "base", "crank_rod"),
        hinge("pin", "crank_rod", "strip", (CRANK, 0.0, 0.0)),
        Joint("slider", JointType.PRISMATIC, "base", "piston", axis=constant([1, 0, 0])),
    )
    links = (
        rod("crank_rod", CRANK_MASS, (CRANK, 0.0, 0.0)),
        flexible_link("strip", beam),
        flat("piston", SLIDER, (0, 0), 1e-4),
    )
    loops = (pin("wrist", ("piston", (0.0, 0.0)), ("strip", (LENGTH, 0.0))),)
    return System("slider-crank with a strip", joints, links, gravity=constant([0.0, -9.81, 0.0]), loops=loops)


def exudyn_run(time: Array) -> tuple[Array, Array]:
    """Crank angle [rad] and slider position [m] at ``time``, from rest, in Exudyn: rigid crank, ANCF cables, a mass on a line."""
    exudyn = exudyn_package()
    import exudyn.itemInterface as made

    mbs = exudyn.SystemContainer().AddSystem()
    kinds = exudyn.OutputVariableType
    tip = CRANK * np.array([np.cos(ANGLE), np.sin(ANGLE)])
    tilt = -np.arcsin(tip[1] / LENGTH)
    along = np.array([np.cos(tilt), np.sin(tilt)])
    fall = [0.0, -9.81, 0.0]
    node = mbs.AddNode(made.NodeRigidBody2D(referenceCoordinates=[*(0.5 * tip), ANGLE]))
    crank = mbs.AddObject(
        item(made.ObjectRigidBody2D, mass=CRANK_MASS, inertia=CRANK_MASS * CRANK**2 / 12.0, nodeNumber=node)
    )
    ground = mbs.AddObject(made.ObjectGround())
    hub = [
        mbs.AddMarker(made.MarkerBodyPosition(bodyNumber=body, localPosition=place))
        for body, place in ((ground, [0.0, 0.0, 0.0]), (crank, [-0.5 * CRANK, 0.0, 0.0]))
    ]
    mbs.AddObject(made.ObjectJointRevolute2D(markerNumbers=hub))
    turn = mbs.AddMarker(made.MarkerNodeCoordinate(nodeNumber=node, coordinate=2))
    mbs.AddLoad(made.LoadCoordinate(markerNumber=turn, load=TORQUE))
    mbs.AddLoad(
        made.LoadMassProportional(markerNumber=mbs.AddMarker(made.MarkerBodyMass(bodyNumber=crank)), loadVector=fall)
    )
    nodes = [
        mbs.AddNode(made.NodePoint2DSlope1(referenceCoordinates=[*(tip + LENGTH * k / ELEMENTS * along), *along]))
        for k in range(ELEMENTS + 1)
    ]
    for pair in pairwise(nodes):
        cable = mbs.AddObject(
            item(
                made.ObjectANCFCable2D,
                length=LENGTH / ELEMENTS,
                massPerLength=MASS / LENGTH,
                bendingStiffness=STIFFNESS,
                axialStiffness=AXIAL,
                nodeNumbers=list(pair),
            )
        )
        weight = mbs.AddMarker(made.MarkerBodyMass(bodyNumber=cable))
        mbs.AddLoad(made.LoadMassProportional(markerNumber=weight, loadVector=fall))
    ends = [
        mbs.AddMarker(made.MarkerBodyPosition(bodyNumber=crank, localPosition=[0.5 * CRANK, 0.0, 0.0])),
        mbs.AddMarker(made.MarkerNodePosition(nodeNumber=nodes[0])),
    ]
    mbs.AddObject(made.ObjectJointRevolute2D(markerNumbers=ends))
    mbs.AddObject(made.ObjectGenericODE2(nodeNumbers=[nodes[-1]], massMatrix=np.diag([SLIDER, SLIDER, 0.0, 0.0])))
    still = mbs.AddMarker(made.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(made.NodePointGround()), coordinate=0))
    height = mbs.AddMarker(made.MarkerNodeCoordinate(nodeNumber=nodes[-1], coordinate=1))
    mbs.AddObject(made.ObjectConnectorCoordinate(markerNumbers=[still, height]))
    sensors: list[Any] = [
        mbs.AddSensor(made.SensorNode(nodeNumber=where, storeInternal=True, writeToFile=False, outputVariableType=what))
        for where, what in ((node, kinds.Rotation), (nodes[-1], kinds.Position))
    ]
    mbs.Assemble()
    steps, every = grid(time, STEP)
    chosen = settings(exudyn, float(time[-1]), steps, every, relative=1e-6, absolute=1e-8)
    with quiet(exudyn):
        solve_dynamic(exudyn, mbs, chosen)
    return stored(mbs, sensors[0], time)[:, -1], stored(mbs, sensors[1], time)[:, 0]


def motion(bench: Bench) -> Iterable[Row | Series]:
    """Slider and crank from rest under a constant torque; what bending does to the slider, for scale."""
    model = bench.native
    time = np.linspace(0.0, DURATION, 301)
    start = initial_state(bench.system, {"crank": ANGLE}, {})
    torque = np.zeros(model.n)
    torque[model.names.index("crank")] = TORQUE
    run = model.simulate(*start, time, tau=torque)
    rigid = bench.build(NATIVE, bench.system.rigid())
    stiff_start = initial_state(bench.system.rigid(), {"crank": ANGLE}, {})
    stiff = rigid.simulate(*stiff_start, time, tau=np.tile(torque[: len(stiff_start[1])], (len(time), 1)))
    ours = run.position[:, run.names.index("slider")]
    bending = float(np.abs(ours - stiff.position[:, stiff.names.index("slider")]).max())
    try:
        angle, slider = exudyn_run(time)
    except EngineUnavailableError as error:
        yield bench.skipped("slider", (NATIVE, "exudyn_ancf"), str(error))
        return
    travel = float(np.ptp(slider))
    yield bench.row(
        "slider",
        (NATIVE, "exudyn_ancf"),
        float(np.sqrt(np.mean((ours - slider) ** 2)) / travel),
        2e-5,
        why="four modes of a strip against twelve nonlinear elements: a fiftieth of what bending does to the slider",
        note=f"RMS over a travel of {travel:.3g} m; bending moves the slider by up to {bending:.1e} m from where a rigid rod would",
    )
    turned = run.position[:, run.names.index("crank")]
    yield bench.row(
        "crank",
        (NATIVE, "exudyn_ancf"),
        float(np.sqrt(np.mean((turned - angle) ** 2)) / np.ptp(angle)),
        2e-5,
        why="as for the slider",
        note=f"RMS over {np.ptp(angle):.3g} rad",
    )
    for name, values, style in ((NATIVE, ours, "line"), ("exudyn_ancf", slider, "dashed")):
        yield Series(
            bench.case.name,
            "trajectory",
            name,
            thin(time),
            thin(values),
            "time [s]",
            "slider [m]",
            bench.case.title,
            style,
        )


CASE = Case(
    name="slider_crank_flexible",
    title="Slider-crank whose connecting rod bends",
    source="Exudyn: absolute nodal coordinates, joints by Lagrange multipliers",
    system=system,
    checks=(Measured("slider", motion), LoopsKept(position=(("crank", ANGLE),), duration=2.0)),
    group="loops",
    engines=("denoc",),
    cost=25.0,
)
