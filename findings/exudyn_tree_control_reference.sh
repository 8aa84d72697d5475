#!/usr/bin/env bash
# A joint spring of Exudyn's kinematic tree counts the angle from zero, a spring on the same coordinate from the reference.
#
# One would guess: jointPControlVector and jointPositionOffsetVector of ObjectKinematicTree are a CoordinateSpringDamper's
# stiffness and offset on the tree's coordinate, which the node's sensor of Coordinates reads.
# What happens: they are where the node's reference coordinates are zero. Else the connector and the sensor count from the
# reference, the tree's spring counts reference and motion together: a tree at rest in its reference starts to swing.
# Seen with: exudyn 1.13.6, numpy 2.4.6; one link of 0.27 kg m^2, spring of 27 N m/rad (10 rad/s), no gravity, least and
#   greatest angle from the reference in 1 s, reference 0.5 rad, offset 0.3 rad: connector 0 and 0.6, tree -0.4 and 0 rad;
#   with offset 0: connector 0 and 0, tree -1.0 and 0 rad; with reference 0 both are alike
# Why it matters: the reference is where the robot is drawn. Moving a drive's stiffness from connectors into the tree,
# or drawing the robot in another pose, turns the rest position by the reference angle, at the right frequency.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" exudyn==1.13.6 numpy==2.4.6
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
import exudyn
import exudyn.itemInterface as items
import numpy as np

print("Exudyn", exudyn.__version__)


def extremes(reference, offset, in_tree):
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    node = system.AddNode(
        items.NodeGenericODE2(
            referenceCoordinates=[reference], initialCoordinates=[0.0], initialCoordinates_t=[0.0], numberOfODE2Coordinates=1
        )
    )
    spring = dict(
        jointPControlVector=[27.0], jointDControlVector=[0.0],
        jointPositionOffsetVector=[offset], jointVelocityOffsetVector=[0.0],
    )
    system.AddObject(
        items.ObjectKinematicTree(
            nodeNumber=node, jointTypes=[exudyn.JointType.RevoluteZ], linkParents=[-1], linkMasses=[1.0],
            jointTransformations=exudyn.Matrix3DList([np.eye(3)]), jointOffsets=exudyn.Vector3DList([[0, 0, 0]]),
            linkInertiasCOM=exudyn.Matrix3DList([np.diag([0.01, 0.01, 0.02])]),
            linkCOMs=exudyn.Vector3DList([[0.5, 0, 0]]), **(spring if in_tree else {}),
        )
    )
    if not in_tree:
        ground = system.AddMarker(
            items.MarkerNodeCoordinate(nodeNumber=system.AddNode(items.NodePointGround()), coordinate=0)
        )
        joint = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=0))
        system.AddObject(items.CoordinateSpringDamper(markerNumbers=[ground, joint], stiffness=27.0, offset=offset))
    kind = exudyn.OutputVariableType.Coordinates
    sensor = system.AddSensor(
        items.SensorNode(nodeNumber=node, storeInternal=True, writeToFile=False, outputVariableType=kind)
    )
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = 1000, 1.0
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write, settings.solution.sensors.writePeriod = False, 1e-3
    system.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.RK44)
    angle = system.GetSensorStoredData(sensor)[:, 1]
    return np.array([angle.min(), angle.max()])


for reference, offset, connector, tree in (
    (0.0, 0.3, (0.0, 0.6), (0.0, 0.6)), (0.5, 0.0, (0.0, 0.0), (-1.0, 0.0)), (0.5, 0.3, (0.0, 0.6), (-0.4, 0.0)),
):
    found = extremes(reference, offset, False), extremes(reference, offset, True)
    print(f"reference {reference}, offset {offset}: connector {found[0].round(4) + 0.0}, tree {found[1].round(4) + 0.0} rad")
    if np.abs(found[0] - connector).max() > 1e-3 or np.abs(found[1] - tree).max() > 1e-3:
        raise SystemExit(f"changed: seen before {connector}, {tree}")
PY
