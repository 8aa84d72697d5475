#!/usr/bin/env bash
# localPosition=[x, 0, 0] on a beam of Exudyn counts from its first node or from its middle, depending on the kind of beam.
#
# One would guess: a sensor, marker or load at localPosition=[x, 0, 0] of a beam element sits at arc length x from its first
# node, for all planar beam elements of the library, and a place outside of the element is an error.
# What happens: ObjectANCFCable2D counts from the first node, 0 to L; ObjectBeamGeometricallyExact2D counts from the middle,
# -L/2 to L/2. Beyond the ends both extrapolate without a word, so that a sensor taken over from one to the other reads a
# point that is not on the beam.
# Seen with: exudyn 1.13.6, numpy 2.4.6, one straight element from 0 to 2 m along x; x of the place:
#   localPosition   -1   0   1   2
#   ANCFCable2D     -1   0   1   2
#   GeometricallyExact2D  0   1   2   3
# Why it matters: the tip's deflection is compared between two beam theories by swapping the element; half an element's
# worth of slope then passes for a difference of the theories.
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
PLACES = (-1.0, 0.0, 1.0, 2.0)
LENGTH = 2.0


def places(node, references, beam, **properties):
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    ends = [system.AddNode(node(referenceCoordinates=reference)) for reference in references]
    body = system.AddObject(
        beam(nodeNumbers=ends, length=LENGTH, massPerLength=1.0, bendingStiffness=1.0, axialStiffness=1.0, **properties)
    )
    system.Assemble()
    kind, where = exudyn.OutputVariableType.Position, exudyn.ConfigurationType.Reference
    found = [float(system.GetObjectOutputBody(body, kind, [x, 0.0, 0.0], where)[0]) for x in PLACES]
    print(f"{beam.__name__:32} localPosition {PLACES} is at x = {found}")
    return found


cable = places(
    items.NodePoint2DSlope1, ([0.0, 0.0, 1.0, 0.0], [LENGTH, 0.0, 1.0, 0.0]), items.ObjectANCFCable2D
)
exact = places(
    items.NodeRigidBody2D, ([0.0, 0.0, 0.0], [LENGTH, 0.0, 0.0]), items.ObjectBeamGeometricallyExact2D,
    crossSectionInertia=1.0, shearStiffness=1.0,
)
if not np.allclose(cable, PLACES, rtol=0, atol=1e-12):
    raise SystemExit("changed: the ANCF cable no longer counts from its first node")
if not np.allclose(exact, np.array(PLACES) + LENGTH / 2, rtol=0, atol=1e-12):
    raise SystemExit("changed: the geometrically exact beam no longer counts from its middle")
PY
