#!/usr/bin/env bash
# Exudyn's eigenvalues of a hanging pendulum are zero where it is a body on a joint, and right where it is a kinematic tree.
#
# One would guess: ComputeODE2Eigenvalues at the hanging equilibrium tells sqrt(m g c / J) of a rigid pendulum, built as
# ObjectRigidBody2D with ObjectJointRevolute2D and gravity as a load, or as ObjectKinematicTree: one mechanism, one frequency.
# What happens: the first gives 0 Hz, though the joint's force (the weight) is known to the system at that moment. The
# linearization takes the forces of the bodies alone; what pulls a pendulum back is the joint's force turning with it.
# Seen with: exudyn 1.13.6, numpy 2.4.6, scipy 1.17.1; 2 kg, 0.3 m, 0.05 kg m2: closed form 0.80513 Hz
#   body on a joint 0.00000 Hz (joint force 19.62 N), kinematic tree 0.80513 Hz
# Why it matters: frequencies of hanging mechanisms are compared between engines first, and a frequency of zero looks like a
# free coordinate or a load that was forgotten, not like a term that is left out.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" exudyn==1.13.6 numpy==2.4.6 scipy==1.17.1
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
import exudyn
import exudyn.itemInterface as items
import exudyn.utilities  # adds the methods of a system
import numpy as np

print("Exudyn", exudyn.__version__)
MASS, CENTRE, INERTIA, GRAVITY = 2.0, 0.3, 0.05, 9.81
TRUTH = np.sqrt(MASS * GRAVITY * CENTRE / (INERTIA + MASS * CENTRE**2)) / (2 * np.pi)


def frequency(system):
    found = system.ComputeODE2Eigenvalues(useSparseSolver=False, convert2Frequencies=True)[0]
    return float(np.asarray(found).ravel()[0])


# A body on a joint; a few short steps at rest give the joint its force.
system = exudyn.SystemContainer().AddSystem()
ground = system.AddMarker(items.MarkerBodyPosition(bodyNumber=system.AddObject(items.ObjectGround())))
node = system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0.0, -CENTRE, 0.0]))
body = system.AddObject(items.ObjectRigidBody2D(nodeNumber=node, mass=MASS, inertia=INERTIA))
hung = system.AddMarker(items.MarkerBodyPosition(bodyNumber=body, localPosition=[0.0, CENTRE, 0.0]))
system.AddObject(items.ObjectJointRevolute2D(markerNumbers=[ground, hung]))
weight = system.AddMarker(items.MarkerBodyMass(bodyNumber=body))
system.AddLoad(items.LoadMassProportional(markerNumber=weight, loadVector=[0.0, -GRAVITY, 0.0]))
system.Assemble()
settings = exudyn.SimulationSettings()
settings.timeIntegration.endTime = 1e-3
settings.timeIntegration.numberOfSteps = 10
settings.timeIntegration.verboseMode = 0
settings.solution.file.write = False
system.SolveDynamic(settings, updateInitialValues=True)
force = float(np.linalg.norm(system.systemData.GetAECoordinates()))
jointed = frequency(system)

# The same as a tree of one link.
system = exudyn.SystemContainer().AddSystem()
node = system.AddNode(
    items.NodeGenericODE2(
        referenceCoordinates=[0.0], initialCoordinates=[0.0], initialCoordinates_t=[0.0], numberOfODE2Coordinates=1
    )
)
system.AddObject(
    items.ObjectKinematicTree(
        nodeNumber=node, jointTypes=[exudyn.JointType.RevoluteZ], linkParents=[-1],
        jointTransformations=exudyn.Matrix3DList([np.eye(3)]), jointOffsets=exudyn.Vector3DList([[0.0, 0.0, 0.0]]),
        linkInertiasCOM=exudyn.Matrix3DList([np.diag([INERTIA, INERTIA, INERTIA])]),
        linkCOMs=exudyn.Vector3DList([[0.0, -CENTRE, 0.0]]), linkMasses=[MASS], gravity=[0.0, -GRAVITY, 0.0],
    )
)
system.Assemble()
tree = frequency(system)
print(f"closed form {TRUTH:.5f} Hz; body on a joint {jointed:.5f} Hz (joint force {force:.2f} N); kinematic tree {tree:.5f} Hz")
if abs(force - MASS * GRAVITY) > 1e-3:
    raise SystemExit("changed: the joint's force is not the weight")
if jointed > 0.01 * TRUTH:
    raise SystemExit("changed: the body on a joint has a frequency")
if abs(tree / TRUTH - 1.0) > 1e-4:
    raise SystemExit("changed: the kinematic tree no longer has the right frequency")
PY
