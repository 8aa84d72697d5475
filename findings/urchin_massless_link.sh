#!/usr/bin/env bash
# urchin makes every link of a URDF that has no <inertial> a body of 1 kg and 1 kg m^2, and saves it so.
#
# One would guess: a link without <inertial>, such as the frame of a tool or a sensor, has no mass, as in Pinocchio, MuJoCo and
# Drake; what urchin loads and saves again is the same robot.
# What happens: link.inertial is 1 kg with a unit inertia at the link's origin, not None, and the saved file has it written out.
# Seen with: urchin 0.0.30, mujoco-core 4.0.0, numpy 2.4.6; arm of 1 kg, centre of mass at 0.5 m, with the frame of a tool at 1 m;
#   in MuJoCo mass / inertia about the joint / torque that holds it level:
#   the file 1 kg / 0.26 kg m^2 / 4.905 N m;  loaded and saved 2 kg / 2.26 kg m^2 / 14.715 N m
# Why it matters: paths of meshes and names are often changed that way before a file goes to an engine. The more frames a robot
# has, the heavier it gets, at the hand most of all, and every model made from that file agrees on it.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" \
    urchin==0.0.30 mujoco-core==4.0.0 numpy==2.4.6
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
from importlib.metadata import version
from pathlib import Path

import mujoco
import numpy as np
import urchin

print("urchin", version("urchin"), " MuJoCo", mujoco.__version__)
Path("arm.urdf").write_text("""<robot name="arm"><link name="base"/>
<link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tool"/>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
<joint name="mount" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="1 0 0"/></joint></robot>""")
robot = urchin.URDF.load("arm.urdf")
robot.save("saved.urdf")
inertial = robot.link_map["tool"].inertial
print("the tool as loaded:", None if inertial is None else f"{inertial.mass:g} kg, {np.diag(inertial.inertia)} kg m^2")


def arm(file):
    """Mass [kg], inertia about the joint [kg m²] and torque [N m] that holds the arm level."""
    model = mujoco.MjModel.from_xml_path(file)
    data = mujoco.MjData(model)
    torques = []
    for acceleration in (0.0, 1.0):
        data.qacc[0] = acceleration
        mujoco.mj_inverse(model, data)
        torques.append(float(data.qfrc_inverse[0]))
    return float(model.body_mass.sum()), torques[1] - torques[0], abs(torques[0])


for file, expected in (("arm.urdf", (1.0, 0.26, 4.905)), ("saved.urdf", (2.0, 0.26 + 1.0 + 1.0, 4.905 + 9.81))):
    found = arm(file)
    print(f"{file:10} mass {found[0]:g} kg, inertia {found[1]:.6g} kg m^2, torque {found[2]:.6g} N m")
    if not np.allclose(found, expected, rtol=0, atol=1e-9):
        raise SystemExit(f"changed: expected {expected}")
PY
