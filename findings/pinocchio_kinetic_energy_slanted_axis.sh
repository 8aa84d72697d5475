#!/usr/bin/env bash
# Pinocchio's kinetic energy counts a joint's armature where the axis is x, y or z, and not where a hinge's axis is slanted.
#
# One would guess: computeKineticEnergy and computeMechanicalEnergy count armature everywhere or nowhere; how a frame is turned
# when the model is written down changes no energy.
# What happens: for hinges and screws about a slanted axis (RevoluteUnaligned, HelicalUnaligned) it is left out, for all others,
# slanted slides among them, it is counted. crba, rnea and aba count it for all.
# Seen with: pin 4.1.0, numpy 2.4.6; one hinge of armature 0.5 kg m^2 at 2 rad/s, its axis written as y, and as (0, 0.6, 0.8) in a
#   frame that is turned back: same mass matrix 0.7925 kg m^2, energy 1.585 and 0.585 J;
#   in free motion of the second without losses from 1.2 rad, the mechanical energy falls by up to 1.3 J and comes back
# Why it matters: exported robots have slanted axes at some joints. The balance of energy of such a model has a gap that goes with
# the velocity squared, as a rotor that is not modelled or a drag would make, while its motion is right.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" \
    pin==4.1.0 libpinocchio==4.1.0 coal==3.0.3 libcoal==3.0.3 eigenpy==3.13.0 numpy==2.4.6
cd "$folder"
FOLDER="$folder/site" PYTHONNOUSERSITE=1 python3 - <<'PY'
import os
import site

site.addsitedir(os.environ.get("FOLDER", "."))
import numpy as np
import pinocchio

print("Pinocchio", pinocchio.__version__)
SLANTED, ARMATURE = np.array([0.0, 0.6, 0.8]), 0.5
TURN = pinocchio.Quaternion.FromTwoVectors(SLANTED, np.array([0.0, 1.0, 0.0])).toRotationMatrix()


def pendulum(joint, turn):
    """A body of 1.5 kg, 0.4 m below a hinge about the world's y axis: the joint's frame is turned, the body turned back."""
    model = pinocchio.Model()
    place = pinocchio.SE3(turn, np.zeros(3))
    index = model.addJoint(0, joint, place, "j")
    body = pinocchio.Inertia(1.5, np.array([0.15, 0.0, -0.4]), np.diag([0.02, 0.01875, 0.01]))
    model.appendBodyToJoint(index, body, place.inverse())
    model.armature = np.full(model.nv, ARMATURE)
    return model


def energies(model, velocity):
    data, zero = model.createData(), np.zeros(1)
    inertia = pinocchio.crba(model, data, zero)[0, 0]
    return inertia, 0.5 * inertia * velocity**2, pinocchio.computeKineticEnergy(model, data, zero, np.array([velocity]))


plain = pendulum(pinocchio.JointModelRY(), np.eye(3))
slanted = pendulum(pinocchio.JointModelRevoluteUnaligned(SLANTED), TURN)
for label, model, gap in (
    ("hinge about y", plain, 0.0),
    ("the same, slanted", slanted, 1.0),
    ("slanted slide", pendulum(pinocchio.JointModelPrismaticUnaligned(SLANTED), TURN), 0.0),
    ("slanted screw", pendulum(pinocchio.JointModelHelicalUnaligned(SLANTED, 0.1), TURN), 1.0),
):
    inertia, right, found = energies(model, 2.0)
    print(f"{label:18}: crba {inertia:.4f}, half of it times v^2 {right:.4f} J, computeKineticEnergy {found:.4f} J")
    if abs(right - found - gap * 0.5 * ARMATURE * 2.0**2) > 1e-9:
        raise SystemExit("changed: the gap is not what the armature has where the axis is slanted, and nothing elsewhere")
if abs(energies(plain, 2.0)[0] - energies(slanted, 2.0)[0]) > 1e-9:
    raise SystemExit("changed: the two hinges are not one and the same")


def span(model):
    """How far [J] the mechanical energy moves in 2 s of free motion by RK4, and the last angle [rad]."""
    data, state, step, told = model.createData(), np.array([1.2, 0.0]), 1e-3, []

    def rate(s):
        return np.array([s[1], pinocchio.aba(model, data, s[:1], s[1:], np.zeros(1))[0]])

    for _ in range(2000):
        told.append(pinocchio.computeMechanicalEnergy(model, data, state[:1], state[1:]))
        a = rate(state)
        b = rate(state + step / 2 * a)
        c = rate(state + step / 2 * b)
        state = state + step / 6 * (a + 2 * b + 2 * c + rate(state + step * c))
    return np.ptp(told), state[0]


found = span(plain), span(slanted)
print(f"free motion: energy over {found[0][0]:.1e} J about y, {found[1][0]:.4f} J slanted; "
      f"last angles {found[0][1]:.6f}, {found[1][1]:.6f} rad")
if abs(found[0][1] - found[1][1]) > 1e-6 or found[0][0] > 1e-6 or found[1][0] < 1.0:
    raise SystemExit("changed: the motions differ, or the energies do not")
PY
