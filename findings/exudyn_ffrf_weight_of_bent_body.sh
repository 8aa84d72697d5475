#!/usr/bin/env bash
# Exudyn's weight of a floating frame (gravity= of AddObjectFFRFreducedOrder, LoadMassProportional) forgets that the body is bent.
#
# One would guess: weight acts on every mass where it is, so that a bent body is turned by the weight of what has moved aside,
# as it is with the same weight put on the nodes of the mesh.
# What happens: the torque on the frame is that of the undeformed body. What the deflection adds to it is left out, while the
# deflection itself feels weight; the two are no gradients of one potential, and energy is not kept.
# Seen with: exudyn 1.13.6, numpy 2.4.6, scipy 1.17.1; two masses of 1 kg at 0.5 and 1 m on a hinge, hanging, the outer one on a
# spring of 40 N/m that lets it slide across, let go 0.1 m aside; turn [rad] and deflection [m] after 1 s:
#   exact (scipy)              -0.14674    0.08521
#   weight on mesh nodes       -0.14674    0.08521
#   gravity=                   -0.06496   -0.02094
# Why it matters: flexible pendulums under their weight are what floating frames are tried on; the fault is as large as the swing,
# and vanishes in every test with a stiff body.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" exudyn==1.13.6 numpy==2.4.6 scipy==1.17.1
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
import numpy as np
from scipy.integrate import solve_ivp
from scipy.sparse import csr_matrix
import exudyn
import exudyn.itemInterface as items
from exudyn import FEM

print("Exudyn", exudyn.__version__)
exudyn.config.printToConsole = False
G, K, BENT, END = 9.81, 40.0, 0.1, 1.0
NODES = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]])


def exact(_, s):
    """Two unit masses at 0.5 and 1 m on a massless bar on a hinge; the outer one slides across on a spring."""
    a, z, w, v = s
    # Lagrange: T = ½ (0.25 + 1 + z²) w² + w v + ½ v², V = -G (0.5 cos a + cos a - z sin a) + ½ K z².
    mass = np.array([[1.25 + z * z, 1.0], [1.0, 1.0]])
    force = np.array([-2.0 * z * v * w - G * (1.5 * np.sin(a) + z * np.cos(a)), z * w * w - G * np.sin(a) - K * z])
    return [w, v, *np.linalg.solve(mass, force)]


def frame(nodal):
    fem = FEM.FEMinterface()
    fem.nodes, fem.elements = {"Position": NODES}, []
    stiffness = np.zeros((9, 9))
    stiffness[7, 7] = K
    mode = np.zeros((9, 1))
    mode[7] = 1.0
    fem.massMatrix, fem.stiffnessMatrix = csr_matrix(np.eye(9)), csr_matrix(stiffness)
    fem.modeBasis = {"matrix": mode, "type": "NormalModes"}
    mbs = exudyn.SystemContainer().AddSystem()
    body = FEM.ObjectFFRFreducedOrderInterface(fem).AddObjectFFRFreducedOrder(
        mbs, rotationMatrixRef=np.eye(3), gravity=[0.0, 0.0, 0.0] if nodal else [G, 0.0, 0.0]
    )
    mbs.SetNodeParameter(body["nGenericODE2"], "initialCoordinates", [BENT])
    if nodal:
        for node in range(3):
            marker = mbs.AddMarker(items.MarkerSuperElementPosition(
                bodyNumber=body["oFFRFreducedOrder"], meshNodeNumbers=[node], weightingFactors=[1.0]))
            mbs.AddLoad(items.LoadForceVector(markerNumber=marker, loadVector=[G, 0.0, 0.0]))
    ground = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=mbs.AddObject(items.ObjectGround())))
    root = mbs.AddMarker(items.MarkerNodeRigid(nodeNumber=body["nRigidBody"]))
    mbs.AddObject(items.GenericJoint(markerNumbers=[ground, root], constrainedAxes=[1, 1, 1, 1, 1, 0]))
    mbs.Assemble()
    settings = exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.timeIntegration.endTime, settings.timeIntegration.numberOfSteps = END, 4000
    settings.timeIntegration.newton.useModifiedNewton = True
    mbs.SolveDynamic(settings)
    turn = mbs.GetNodeOutput(body["nRigidBody"], exudyn.OutputVariableType.Rotation)[2]
    return float(turn), float(np.asarray(mbs.GetNodeOutput(body["nGenericODE2"], exudyn.OutputVariableType.Coordinates)).ravel()[0])

truth = solve_ivp(exact, (0.0, END), [0.0, BENT, 0.0, 0.0], rtol=1e-11, atol=1e-13).y[:2, -1]
nodal, whole = frame(nodal=True), frame(nodal=False)
for what, found in (("exact", truth), ("weight on mesh nodes", nodal), ("gravity=", whole)):
    print(f"{what:24} turn {found[0]:9.5f} rad   deflection {found[1]:9.5f} m")
if not np.allclose(nodal, truth, rtol=0, atol=1e-5):
    raise SystemExit("changed: weight on the nodes of the mesh no longer moves the body as it should")
if not np.allclose(whole, [-0.06496, -0.02094], rtol=0, atol=1e-4):
    raise SystemExit("changed: gravity= no longer forgets the deflection in the torque on the frame")
PY
