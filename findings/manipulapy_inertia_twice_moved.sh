#!/usr/bin/env bash
# ManipulaPy moves the inertia of a link from its centre of mass to the joint twice.
#
# One would guess: the dynamics that URDFToSerialManipulator makes of a URDF give a pendulum the inertia I + m c^2; the weight
# torque, which is right, says that mass and centre of mass are read well.
# What happens: the mass matrix is I + 2 m c^2. inverse_dynamics and forward_dynamics use it. With the centre of mass at the link's
# origin it is right.
# Seen with: ManipulaPy 1.4.2, pin 4.1.0, numpy 2.4.6; pendulum of 1 kg, 0.08 kg m^2, centre of mass c below the joint:
#   c 0 / 0.25 / 0.5 m: mass matrix 0.08 / 0.205 / 0.58, right is 0.08 / 0.1425 / 0.33 kg m^2, weight torque as in Pinocchio;
#   period of a small swing by its forward_dynamics at c = 0.5 m 2.161 s, right is 1.630 s
# Why it matters: links of robots have their centre of mass well away from the joint: fits of friction or of a load against these
# torques blame the motion's acceleration on something else, while every check at rest passes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" \
    ManipulaPy==1.4.2 pin==4.1.0 libpinocchio==4.1.0 coal==3.0.3 libcoal==3.0.3 eigenpy==3.13.0 numpy==2.4.6
cd "$folder"
FOLDER="$folder/site" PYTHONNOUSERSITE=1 MPLBACKEND=Agg MANIPULAPY_QUIET=1 python3 - <<'PY'
import os
import site
from importlib.metadata import version

site.addsitedir(os.environ.get("FOLDER", "."))
import numpy as np
import pinocchio
from ManipulaPy.urdf_processor import URDFToSerialManipulator

print("ManipulaPy", version("ManipulaPy"), " Pinocchio", pinocchio.__version__)
MASS, ABOUT, DOWN, NO_FORCE = 1.0, 0.08, [0.0, 0.0, -9.81], np.zeros(6)


def pendulum(lever):
    text = (f'<robot name="p"><link name="base"/><link name="rod"><inertial><origin xyz="0 0 {-lever}"/><mass value="{MASS}"/>'
            f'<inertia ixx="{ABOUT}" iyy="{ABOUT}" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            '<joint name="j" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>'
            '<limit lower="-3" upper="3" effort="99" velocity="99"/></joint></robot>')
    with open("pendulum.urdf", "w") as file:
        file.write(text)
    return URDFToSerialManipulator("pendulum.urdf").dynamics, pinocchio.buildModelFromXML(text)


for lever in (0.0, 0.25, 0.5):
    dynamics, model = pendulum(lever)
    data, angle, zero = model.createData(), np.array([0.3]), np.zeros(1)
    found = float(np.asarray(dynamics.mass_matrix([0.3]))[0, 0])
    asked = float(np.asarray(dynamics.inverse_dynamics([0.3], [0.0], [1.0], DOWN, NO_FORCE))[0])
    weight = float(np.asarray(dynamics.gravity_forces([0.3], DOWN))[0])
    right, held = pinocchio.crba(model, data, angle)[0, 0], pinocchio.rnea(model, data, angle, zero, zero)[0]
    print(f"c {lever:4} m: mass matrix {found:.4f} (Pinocchio {right:.4f}) kg m^2, weight {weight:.4f} ({held:.4f}) N m, "
          f"for 1 rad/s^2 beyond the weight {asked - weight:.4f} N m")
    if abs(right - ABOUT - MASS * lever**2) > 1e-9 or abs(weight - held) > 1e-9:
        raise SystemExit("changed: the right inertia or the weight is not what it was")
    if abs(found - ABOUT - 2.0 * MASS * lever**2) > 1e-9 or abs(asked - weight - found) > 1e-9:
        raise SystemExit("changed: the inertia is not moved twice any more")

small = 0.01
pull = float(np.asarray(dynamics.forward_dynamics([small], [0.0], [0.0], DOWN, NO_FORCE))[0])
periods = 2.0 * np.pi * np.sqrt(np.array([-small / pull, right / (MASS * 9.81 * lever)]))
print(f"period of a small swing at c {lever} m: {periods[0]:.3f} s by forward_dynamics, {periods[1]:.3f} s by the closed form")
if abs(periods[0] / periods[1] - np.sqrt(found / right)) > 1e-3:
    raise SystemExit("changed: forward_dynamics is not that of this mass matrix")
PY
