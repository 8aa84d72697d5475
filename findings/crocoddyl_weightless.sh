#!/usr/bin/env bash
# Crocoddyl as pip installs it with the newest Pinocchio computes free motion without gravity.
#
# One would guess: what pip resolves works together, or fails to load: forward dynamics that Crocoddyl asks Pinocchio for are
# those that Pinocchio's own aba gives for the same model.
# What happens: crocoddyl 3.2.1 accepts any libpinocchio, and pip takes 4.1.0, the newest. With it the action model of free
# forward dynamics returns the acceleration of the weightless arm, digit for digit; torque and velocity count as they should.
# With libpinocchio 4.0.0 gravity is there. So it is with 4.1.0 once the action model's own armature is set, even to zero.
# Seen with: crocoddyl 3.2.1, numpy 2.4.6; pendulum of 0.26 kg m^2, 1 kg at 0.5 m, 0.3 rad from hanging, at rest under 1 N m:
#   pin 4.1.0: Crocoddyl 3.84615, with armature = 0 -1.72895, Pinocchio's aba -1.72895 rad/s^2
#   pin 4.0.0: -1.72895 all three
# Why it matters: no test of masses, torques or velocities shows it; trajectories that were optimised this way lack the torque
# that holds the arm, and the model looks like one of wrong masses.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat >"$folder/compare.py" <<'PY'
import os
import site
import sys

site.addsitedir(os.environ["FOLDER"])
import crocoddyl
import numpy as np
import pinocchio as pin

print("Crocoddyl", crocoddyl.__version__, " Pinocchio", pin.__version__)
model = pin.Model()
joint = model.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), "joint")
model.appendBodyToJoint(joint, pin.Inertia(1.0, np.array([0.0, 0.0, -0.5]), 0.01 * np.eye(3)), pin.SE3.Identity())
state = crocoddyl.StateMultibody(model)
actuation, costs = crocoddyl.ActuationModelFull(state), crocoddyl.CostModelSum(state)


def crocoddyls(angle, speed, torque, own_armature):
    action = crocoddyl.DifferentialActionModelFreeFwdDynamics(state, actuation, costs)
    if own_armature:
        action.armature = np.zeros(1)
    data = action.createData()
    action.calc(data, np.array([angle, speed]), np.array([torque]))
    return float(data.xout[0])


weightless = sys.argv[1] == "weightless"
for angle, speed, torque in ((0.3, 0.0, 1.0), (-1.2, 0.5, 0.3), (0.0, 2.0, 1.0)):
    right = (torque - 9.81 * 0.5 * np.sin(angle)) / 0.26
    aba = float(pin.aba(model, model.createData(), np.array([angle]), np.array([speed]), np.array([torque]))[0])
    plain, other = (crocoddyls(angle, speed, torque, own) for own in (False, True))
    print(f"{angle} rad, {speed:g} rad/s, {torque:g} N m: Crocoddyl {plain:9.5f}, armature = 0 {other:9.5f}, aba {aba:9.5f}, "
          f"exact {right:9.5f}, weightless {torque / 0.26:8.5f} rad/s^2")
    if not np.allclose([plain, other, aba], [torque / 0.26 if weightless else right, right, right], rtol=0, atol=1e-9):
        raise SystemExit("changed: expected the acceleration " + ("without" if weightless else "with") + " weight from Crocoddyl")
PY
run() {
    python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/$1" \
        crocoddyl==3.2.1 libcrocoddyl==3.2.1 "pin==$1" "libpinocchio==$1" eigenpy==3.13.0 numpy==2.4.6
    (cd "$folder" && FOLDER="$folder/$1" PYTHONNOUSERSITE=1 python3 compare.py "$2")
}
run 4.1.0 weightless
run 4.0.0 heavy
