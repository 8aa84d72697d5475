#!/usr/bin/env bash
# Pinocchio's derivatives of the dynamics are wrong for a joint of Euler angles, even at rest; the dynamics are right.
#
# One would guess: JointModelSphericalZYX is three hinges Z, Y, X without mass between them, and all that can be asked of a
# model with one of the two is the same for the other.
# What happens: rnea, aba, crba are the same. computeRNEADerivatives, computeABADerivatives, computeStaticTorqueDerivatives and
# computeCoriolisMatrix leave out that the joint's axes turn with its angles. Without motion d(tau)/dq is the second derivative
# of the potential energy and symmetric; the one of ZYX is not. JointModelUniversal and JointModelEllipsoid are alike.
# Seen with: pin 4.1.0, numpy 2.4.6; 1.5 kg at (0.1, 0.2, 0.3) m, angles 0.3, 0.5, 0.7 rad:
#   at rest d(tau_z)/d(q_x) of the hinges 0, of ZYX 3.35 N m/rad; d(a)/dq from aba up to 61 1/s^2 off, C v + g up to 0.33 N m
# Why it matters: linearisation, eigenfrequencies and gradients of a fit of a model with such a joint (hips, gimbals, a base
# without quaternions) are wrong by as much as they are large, with no word, while every simulation looks right.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" \
    pin==4.1.0 libpinocchio==4.1.0 coal==3.0.3 libcoal==3.0.3 eigenpy==3.13.0 numpy==2.4.6
cd "$folder"
FOLDER="$folder/site" PYTHONNOUSERSITE=1 python3 - <<'PY'
import os
import site

site.addsitedir(os.environ["FOLDER"])
import numpy as np
import pinocchio

print("Pinocchio", pinocchio.__version__)
np.set_printoptions(precision=3, suppress=True)
HERE = pinocchio.SE3.Identity()
Q, V, A, STEP = np.array([0.3, 0.5, 0.7]), np.array([1.0, -2.0, 0.5]), np.array([0.1, 0.2, 0.3]), 1e-6


def built(*joints):
    model, last = pinocchio.Model(), 0
    for k, joint in enumerate(joints):
        last = model.addJoint(last, joint, HERE, f"j{k}")
    model.appendBodyToJoint(last, pinocchio.Inertia(1.5, np.array([0.1, 0.2, 0.3]), np.diag([0.05, 0.06, 0.07])), HERE)
    return model


def asked(model):
    data = pinocchio.Data(model)
    tau = pinocchio.rnea(model, data, Q, V, A).copy()
    forward = pinocchio.aba(model, data, Q, V, tau).copy()
    numerical = np.array(
        [
            (pinocchio.aba(model, data, Q + e, V, tau).copy() - pinocchio.aba(model, data, Q - e, V, tau)) / (2 * STEP)
            for e in STEP * np.eye(3)
        ]
    ).T
    pinocchio.computeABADerivatives(model, data, Q, V, tau)
    error = np.abs(data.ddq_dq - numerical).max()
    bias = pinocchio.nle(model, data, Q, V).copy()
    bias -= pinocchio.computeCoriolisMatrix(model, data, Q, V) @ V + pinocchio.computeGeneralizedGravity(model, data, Q)
    pinocchio.computeRNEADerivatives(model, data, Q, 0 * V, 0 * A)
    return tau, forward, numerical, data.dtau_dq.copy(), error, np.abs(bias).max()


hinges = asked(built(pinocchio.JointModelRZ(), pinocchio.JointModelRY(), pinocchio.JointModelRX()))
euler = asked(built(pinocchio.JointModelSphericalZYX()))
print(f"rnea, aba: the same to {max(np.abs(h - e).max() for h, e in zip(hinges[:2], euler[:2])):.0e}")
for name, (_, _, _, stiffness, error, bias) in (("three hinges", hinges), ("SphericalZYX", euler)):
    print(f"{name}: d(tau)/dq at rest", *stiffness, f"; d(aba)/dq off by {error:.3g} 1/s^2; Cv+g by {bias:.2g} N m")
if any(np.abs(h - e).max() > 1e-4 for h, e in zip(hinges[:3], euler[:3])):
    raise SystemExit("changed: the dynamics of the two differ")
if np.abs(hinges[3] - hinges[3].T).max() > 1e-12 or hinges[4] > 1e-4 or hinges[5] > 1e-12:
    raise SystemExit("changed: the hinges' derivatives are no longer right")
if not (abs(euler[3][0, 2] - 3.35) < 0.01 and euler[4] > 10 and euler[5] > 0.1):
    raise SystemExit("changed: the derivatives for SphericalZYX")
PY
