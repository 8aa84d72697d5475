#!/usr/bin/env bash
# Scikit-robot's inverse dynamics counts a link behind a fixed joint in the weight and not in the inertia.
#
# One would guess: torque_vector(calc_statics_p=False, ...) asks for the torque that moves all the links whose weight
# torque_vector() holds up, also those that are fixed to a moving one (tools, sensors, covers).
# What happens: the masses behind fixed joints are in the weight; to accelerate them costs nothing. And the inertia of a moving
# link is taken along the link's axes whatever the rpy of its <inertial> says. Neither is told.
# Seen with: scikit-robot 0.4.7, pin 4.1.0, numpy 2.4.6; arm of 1 kg at 0.25 m with 0.02 kg m^2, tool of 0.5 kg at 0.5 m behind a
#   fixed joint: weight when level 4.903 N m (right); torque for 1 rad/s^2 without weight 0.0825 N m, right is 0.2075 N m;
#   an arm with inertias 0.02, 0.08, 0.08 kg m^2 turned by 90 degrees in its <inertial>: 0.08 N m, right is 0.02 N m
# Why it matters: weight checks of a robot with a tool pass, its dynamic torques lack the tool. Calibrated against them a motor
# constant comes out wrong by what the tool adds to the inertia.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" \
    scikit-robot==0.4.7 pin==4.1.0 libpinocchio==4.1.0 coal==3.0.3 libcoal==3.0.3 eigenpy==3.13.0 numpy==2.4.6
cd "$folder"
FOLDER="$folder/site" PYTHONNOUSERSITE=1 python3 - <<'PY'
import os
import site
from importlib.metadata import version

site.addsitedir(os.environ.get("FOLDER", "."))
import numpy as np
import pinocchio
from skrobot.models.urdf import RobotModelFromURDF

print("scikit-robot", version("scikit-robot"), " Pinocchio", pinocchio.__version__)
WEIGHT = np.array([0.0, 0.0, -9.80665])


def link(name, mass, at, inertia, turn="0 0 0"):
    ixx, iyy, izz = inertia
    return (f'<link name="{name}"><inertial><origin xyz="{at}" rpy="{turn}"/><mass value="{mass}"/><inertia ixx="{ixx}" '
            f'iyy="{iyy}" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial></link>')


def torques(links, behind=""):
    """Torque that lifts the arm [N m], at rest and for 1 rad/s^2 without weight, in scikit-robot and Pinocchio."""
    limit = '<limit lower="-3" upper="3" effort="99" velocity="9"/>'
    text = (f'<robot name="rig"><link name="base"/>{link("column", 1.0, "0 0 0", (0.01, 0.01, 0.01))}{links}'
            f'<joint name="turn" type="revolute"><parent link="base"/><child link="column"/><axis xyz="0 0 1"/>{limit}</joint>'
            f'<joint name="lift" type="revolute"><parent link="column"/><child link="arm"/><axis xyz="0 1 0"/>{limit}</joint>'
            f'{behind}</robot>')
    with open("arm.urdf", "w") as file:
        file.write(text)
    robot, step, nothing = RobotModelFromURDF(urdf_file="arm.urdf"), 1e-3, np.zeros(3)
    still = robot.torque_vector(av=np.zeros(2), gravity=WEIGHT)[1]
    aside = np.array([0.0, 0.5 * step**2])  # the angle one step before and after rest at 1 rad/s^2
    moved = robot.torque_vector(calc_statics_p=False, dt=step, av_prev=aside, av=np.zeros(2), av_next=aside, gravity=nothing)[1]
    model = pinocchio.buildModelFromXML(text)
    model.gravity.linear = WEIGHT
    zero = np.zeros(2)
    held = pinocchio.rnea(model, model.createData(), zero, zero, zero)[1]
    model.gravity.linear = nothing
    return (still, moved), (held, pinocchio.rnea(model, model.createData(), zero, zero, np.array([0.0, 1.0]))[1])


TOOL = '<joint name="mount" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="0.5 0 0"/></joint>'
ARM = link("arm", 1.0, "0.25 0 0", (0.02, 0.02, 0.02))
for label, links, behind, inertia, seen in (
    ("arm", ARM, "", 0.0825, 0.0825),
    ("arm and tool behind a fixed joint", ARM + link("tool", 0.5, "0 0 0", (0, 0, 0)), TOOL, 0.2075, 0.0825),
    ("inertia along the link's axes", link("arm", 1.0, "0 0 0", (0.08, 0.02, 0.08)), "", 0.02, 0.02),
    ("the same, turned in <inertial>", link("arm", 1.0, "0 0 0", (0.02, 0.08, 0.08), f"0 0 {np.pi / 2}"), "", 0.02, 0.08),
):
    found, right = torques(links, behind)
    print(f"{label:34}: held level {found[0]:.4f} (Pinocchio {right[0]:.4f}), for 1 rad/s^2 {found[1]:.4f} ({right[1]:.4f}) N m")
    if abs(found[0] - right[0]) > 1e-4 or abs(right[1] - inertia) > 1e-9 or abs(found[1] - seen) > 1e-4:
        raise SystemExit(f"changed: seen before the same weight, {inertia} and {seen} N m")
PY
