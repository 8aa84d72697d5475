#!/usr/bin/env bash
# The Robotics Toolbox for Python moves a joint about -y the right way and gives its torque the sign of one about y.
#
# One would guess: a joint about a negative axis is turned round in all that belongs to it: fkine, gravload, inertia and rne use
# one and the same angle, so that gravload is the derivative of the weight's potential along fkine.
# What happens: fkine turns round, the dynamics do not: the torque of such a joint has the wrong sign, as has its coupling in the
# inertia matrix with a joint about a positive axis. The diagonal of the inertia matrix is right.
# Seen with: roboticstoolbox-python 1.5.0, pin 4.1.0, numpy 2.4.6; two links, hinges about -y and x, at 0.3 and 0.4 rad, weight
#   torque in the toolbox / along its own fkine / in Pinocchio: first -8.958 / 8.958 / 8.958 N m, second 5.643 N m in all;
#   inertia between the two -0.0602 / - / 0.0602 kg m^2; with both axes positive all agree
# Why it matters: negative axes are common in URDFs. Gravity compensation by such a model pushes the joint down; a motor's sign or
# the recording's direction is then blamed, since the motion on the screen is right.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" \
    roboticstoolbox-python==1.5.0 pin==4.1.0 libpinocchio==4.1.0 coal==3.0.3 libcoal==3.0.3 eigenpy==3.13.0 numpy==2.4.6
cd "$folder"
FOLDER="$folder/site" PYTHONNOUSERSITE=1 MPLBACKEND=Agg python3 - <<'PY'
import os
import site
import warnings
from importlib.metadata import version

site.addsitedir(os.environ.get("FOLDER", "."))
warnings.simplefilter("ignore")
import numpy as np
import pinocchio
import roboticstoolbox

print("Robotics Toolbox", version("roboticstoolbox-python"), " Pinocchio", pinocchio.__version__)
MASS, CENTRE, GRAVITY = 2.0, [0.1, 0.2, -0.3], 9.81


def robot_text(first, second):
    inside = (f'<inertial><origin xyz="0.1 0.2 -0.3"/><mass value="{MASS}"/><inertia ixx="0.05" iyy="0.04" izz="0.03" ixy="0" '
              'ixz="0" iyz="0"/></inertial>')
    limit = '<limit lower="-3" upper="3" effort="99" velocity="9"/>'
    return (f'<robot name="rig"><link name="base"/><link name="upper">{inside}</link><link name="lower">{inside}</link>'
            f'<joint name="a" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="{first}"/>{limit}</joint>'
            f'<joint name="b" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.4"/>'
            f'<axis xyz="{second}"/>{limit}</joint></robot>')


q = np.array([0.3, 0.4])
for first, second, signs in (("0 1 0", "1 0 0", (1, 1)), ("0 -1 0", "1 0 0", (-1, 1)), ("0 1 0", "-1 0 0", (1, -1))):
    text = robot_text(first, second)
    with open("rig.urdf", "w") as file:
        file.write(text)
    robot = roboticstoolbox.Robot.URDF(os.path.abspath("rig.urdf"))
    robot.gravity = [0, 0, -GRAVITY]

    def potential(at):
        return sum(MASS * GRAVITY * (robot.fkine(at, end=link).A @ [*CENTRE, 1.0])[2] for link in ("upper", "lower"))

    along = np.array([(potential(q + step) - potential(q - step)) / 2e-6 for step in 1e-6 * np.eye(2)])
    model = pinocchio.buildModelFromXML(text)
    right = pinocchio.computeGeneralizedGravity(model, model.createData(), q)
    coupling = pinocchio.crba(model, model.createData(), q)[0, 1]
    found, between = robot.gravload(q), robot.inertia(q)[0, 1]
    print(f"axes {first:6} and {second:6}: weight {found.round(4)}, along fkine {along.round(4)}, Pinocchio {right.round(4)} N m; "
          f"coupling {between:.4f} ({coupling:.4f}) kg m^2")
    if np.abs(along - right).max() > 1e-5:
        raise SystemExit("changed: fkine does not move as Pinocchio does")
    if np.abs(found - right * signs).max() > 1e-6 or abs(between - coupling * signs[0] * signs[1]) > 1e-9:
        raise SystemExit("changed: the signs at a negative axis are other than before")
PY
