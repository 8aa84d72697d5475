#!/usr/bin/env bash
# Pinocchio's reader of URDF lets a planar joint move in its own x-y plane, whatever its <axis> says.
#
# One would guess: a planar joint moves in the plane perpendicular to its <axis>, as the format says, and turns about it.
# What happens: the axis is passed over, with no word: slides along x and y and a turn about z of the joint's frame.
# Seen with: pin 4.1.0, mujoco-core 4.0.0, numpy 2.4.6; axes of the two slides and the turn for <axis xyz="1 0 0"/>:
#   MuJoCo (0 0 -1), (0 1 0), (1 0 0); Pinocchio (1 0 0), (0 1 0), (0 0 1); for <axis xyz="0 0 1"/> the same in both
# Why it matters: <axis xyz="1 0 0"/> is also what a file means that leaves the element out; such a base then flies upwards.
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
MODEL = """<robot name="table"><link name="base"/><link name="plate"><inertial><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="glide" type="planar"><parent link="base"/><child link="plate"/><axis xyz="{axis}"/></joint></robot>"""


def axes(axis):
    text = MODEL.format(axis=axis)
    Path("model.urdf").write_text(text)
    model = pinocchio.buildModelFromUrdf("model.urdf")
    data = model.createData()
    found = []
    for velocity in np.eye(3):
        pinocchio.forwardKinematics(model, data, pinocchio.neutral(model), velocity)
        found.append(data.v[1].linear + data.v[1].angular)
    theirs = mujoco.MjModel.from_xml_string(text).jnt_axis + 0.0
    print(f"axis {axis}: MuJoCo {theirs.round(3).tolist()}, Pinocchio {np.round(found, 3).tolist()}")
    return theirs, np.array(found)


for axis in ("0 0 1", "1 0 0", "0 1 0"):
    theirs, found = axes(axis)
    if not np.allclose(theirs[2], [float(x) for x in axis.split()], atol=1e-9):
        raise SystemExit("changed: MuJoCo no longer turns about the axis of a planar joint")
    if not np.allclose(found, np.eye(3), atol=1e-9):
        raise SystemExit("changed: Pinocchio no longer passes over the axis of a planar joint")
PY
