#!/usr/bin/env bash
# Pinocchio's reader of MJCF takes axisangle without making the axis a unit vector: the body is sheared, not turned.
#
# One would guess: axisangle="0 2 0 40" turns a body by 40 degrees about y; only the direction of the axis counts, as in
# MuJoCo, and as in Pinocchio's own reader for xyaxes, zaxis, quat and a joint's axis.
# What happens: the axis goes into the formula of the rotation as it stands. The placement of the joint is then no rotation
# (its columns are 1.50, 1.70 and 2.55 long here), and everything beyond the joint is stretched with it. The reader is silent;
# masses and inertias of the links look right one by one.
# Seen with: pin 4.1.0, mujoco-core 4.0.0, numpy 2.4.6; a pendulum's body with axisangle="0 2 0 40", held at 0:
#   gravity torque by MuJoCo 0.751490 N m, by Pinocchio 1.278935 N m; with the axis 0 1 0 both 0.751490 N m
# Why it matters: two engines read one file, and the difference is put down to inertia, since that is what the numbers
# show; unit axes (all that most files have) never show it.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" \
    pin==4.1.0 libpinocchio==4.1.0 coal==3.0.3 libcoal==3.0.3 eigenpy==3.13.0 numpy==2.4.6 mujoco-core==4.0.0
cd "$folder"
FOLDER="$folder/site" PYTHONNOUSERSITE=1 python3 - <<'PY'
import os
import site
from pathlib import Path

site.addsitedir(os.environ.get("FOLDER", "."))
import mujoco
import numpy as np
import pinocchio

print("Pinocchio", pinocchio.__version__, " MuJoCo", mujoco.__version__)
# The centre of mass is off the hinge's axis both ways, and the hinge is inclined to gravity by the turn of its body.
MODEL = """<mujoco><worldbody><body name="rod" axisangle="{axis} 40"><joint name="hinge" axis="1 0 0"/>
<inertial pos="0 0.1 -0.2" mass="1" diaginertia=".01 .011 .001"/></body></worldbody></mujoco>"""


def torques(axis):
    """Gravity's torque at the hinge by MuJoCo and by Pinocchio, and how far Pinocchio's placement is from a rotation."""
    text = MODEL.format(axis=axis)
    Path("model.xml").write_text(text)
    theirs = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(theirs)
    mujoco.mj_forward(theirs, data)
    model = pinocchio.buildModelFromMJCF("model.xml")
    torque = pinocchio.computeGeneralizedGravity(model, pinocchio.Data(model), np.zeros(1))[0]
    turn = model.jointPlacements[1].rotation
    skew = float(np.abs(turn.T @ turn - np.eye(3)).max())
    print(f"axis {axis}: gravity torque MuJoCo {data.qfrc_bias[0]:.6f}, Pinocchio {torque:.6f} N m; "
          f"its columns are {np.round(np.linalg.norm(turn, axis=0), 6)} long")
    return float(data.qfrc_bias[0]), float(torque), skew


unit, double = torques("0 1 0"), torques("0 2 0")
if abs(unit[0] - unit[1]) > 1e-9 or unit[2] > 1e-9:
    raise SystemExit("changed: a unit axis is read otherwise by the two")
if abs(double[0] - unit[0]) > 1e-12:
    raise SystemExit("changed: MuJoCo minds the length of the axis")
if double[2] < 1.0 or abs(double[1] - double[0]) < 0.1:
    raise SystemExit("changed: Pinocchio's reader makes the axis a unit vector")
PY
