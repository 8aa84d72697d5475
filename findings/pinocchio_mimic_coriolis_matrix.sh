#!/usr/bin/env bash
# Pinocchio's computeCoriolisMatrix takes a model with a mimic joint, and its matrix times the velocity is no Coriolis force.
#
# One would guess: what a model with mimic joints cannot do is refused (aba, the kinetic energy and the derivatives are), and
#   what is not refused is right: C(q, v) v is what nle leaves without gravity, here Ṁ v / 2.
# What happens: rnea, nle and crba are right; computeCoriolisMatrix returns another matrix with no word. At a multiplier of −1, where
#   the mass matrix of this arm is the same at every angle, it is not nothing; at −2 it has the wrong sign.
# Seen with: pin 4.1.0, numpy 2.4.6; C v and what is right [N·m] at multipliers −2, −1, 0.5, 2:
#   −0.0324 for 0.0324, −0.0034 for 0, −0.0081 for −0.0122, −0.0602 for −0.1807
# Why it matters: controllers and observers of momentum use this matrix for grippers, whose fingers mimic one another.
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
MODEL = """<robot name="arm"><link name="base"/>
<link name="upper"><inertial><origin xyz="0 0 -0.2"/><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0 -0.1"/><mass value="0.5"/>
<inertia ixx="0.002" iyy="0.002" izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="9" velocity="9"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.4"/><axis xyz="0 1 0"/>
<limit lower="-7" upper="7" effort="9" velocity="9"/><mimic joint="shoulder" multiplier="{}" offset="0.3"/></joint></robot>"""
q, v, step = np.array([0.4]), np.array([1.3]), 1e-6
wrong = []
for multiplier in (-2.0, -1.0, 0.5, 2.0):
    model = pinocchio.buildModelFromXML(MODEL.format(multiplier), mimic=True)
    about = [pinocchio.crba(model, model.createData(), q + s)[0, 0] for s in (-step, step)]
    right = 0.5 * (about[1] - about[0]) / (2.0 * step) * v[0] ** 2
    left = pinocchio.nle(model, model.createData(), q, v) - pinocchio.computeGeneralizedGravity(model, model.createData(), q)
    found = pinocchio.computeCoriolisMatrix(model, model.createData(), q, v) @ v
    print(f"multiplier {multiplier:4}: C v {found[0]:8.4f}, nle without gravity {left[0]:8.4f}, half the mass matrix's rate {right:8.4f}")
    if abs(left[0] - right) > 1e-6:
        raise SystemExit("changed: nle of a model with a mimic joint is no longer what the mass matrix asks for")
    wrong.append(abs(found[0] - right))
if min(wrong) < 1e-3:
    raise SystemExit("changed: the Coriolis matrix of a model with a mimic joint is right now")
try:
    pinocchio.aba(model, model.createData(), q, v, np.zeros(1))
except RuntimeError:
    print("aba refuses a mimic joint")
else:
    raise SystemExit("changed: aba takes a mimic joint")
PY
