#!/usr/bin/env bash
# A curved ANCF cable of Exudyn straightens by itself: its reference configuration is not where it is free of stress.
#
# One would guess: referenceCoordinates of the nodes describe the undeformed beam, as everywhere in finite elements, so that
# a quarter circle of elements, clamped at one end and not loaded, stays a quarter circle.
# What happens: the static solution is the straight beam. By default curvature and stretch are measured from a straight
# line of the element's length, whatever the reference coordinates; strainIsRelativeToReference=1 makes it what one meant.
# Seen with: exudyn 1.13.6, numpy 2.4.6; quarter circle of radius 1 m, eight ObjectANCFCable2D, no load: the tip moves by
#   (pi/2 - 1, -1) m by default, by 0 with strainIsRelativeToReference=1
# Why it matters: the same drawing of a bent spring in another code is at rest; in a comparison this looks like a wrong
# stiffness or a load that was forgotten.
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
ELEMENTS = 8


def tip_moves(**options):
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    angles = np.linspace(0.0, np.pi / 2, ELEMENTS + 1)
    nodes = [
        system.AddNode(items.NodePoint2DSlope1(referenceCoordinates=[np.sin(a), 1 - np.cos(a), np.cos(a), np.sin(a)]))
        for a in angles
    ]
    for left, right in zip(nodes, nodes[1:]):
        system.AddObject(
            items.ObjectANCFCable2D(
                nodeNumbers=[left, right], length=np.pi / 2 / ELEMENTS, massPerLength=1.0, bendingStiffness=1.0,
                axialStiffness=1e4, **options,
            )
        )
    ground = system.AddMarker(
        items.MarkerNodeCoordinate(nodeNumber=system.AddNode(items.NodePointGround()), coordinate=0)
    )
    for coordinate in range(4):
        held = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=coordinate))
        system.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[ground, held]))
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.staticSolver.numberOfLoadSteps = 20
    settings.staticSolver.verboseMode = 0
    settings.solution.file.write = False
    system.SolveStatic(settings)
    return np.asarray(system.GetNodeOutput(nodes[-1], exudyn.OutputVariableType.Displacement))[:2]


default, relative = tip_moves(), tip_moves(strainIsRelativeToReference=1.0)
print("tip moves without load by", np.round(default, 6), "m; with strainIsRelativeToReference=1 by", np.round(relative, 6) + 0.0)
if np.abs(default - [np.pi / 2 - 1.0, -1.0]).max() > 1e-3:
    raise SystemExit("changed: the curved cable no longer straightens by itself")
if np.abs(relative).max() > 1e-3:
    raise SystemExit("changed: it moves with strainIsRelativeToReference=1, too")
PY
