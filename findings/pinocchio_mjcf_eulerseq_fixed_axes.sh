#!/usr/bin/env bash
# Pinocchio's reader of MJCF turns about moving axes for eulerseq="XYZ" as it does for "xyz".
#
# One would guess: capital letters in eulerseq stand for axes that stay, small ones for axes that move along, as MuJoCo
# documents; a reader that knows the attribute knows both.
# What happens: the order of the letters counts and their case does not, so that "XYZ" is read as "xyz" (MuJoCo: as "zyx" of
# the angles in reverse). Small letters are right.
# Seen with: pin 4.1.0, mujoco-core 4.0.0, numpy 2.4.6; euler="10 20 30":
#   "xyz" and "zyx" alike in both; "XYZ", "ZYX", "YXZ" 0.209 rad apart
# Why it matters: eulerseq="XYZ" is what files have that were converted from URDF, whose rpy is about axes that stay.
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
TURNS = {
    "x": lambda c, s: np.array([[1, 0, 0], [0, c, -s], [0, s, c]]),
    "y": lambda c, s: np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]),
    "z": lambda c, s: np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
}
ANGLES = np.radians([10.0, 20.0, 30.0])


def moving(sequence):
    first, second, third = (TURNS[a](np.cos(t), np.sin(t)) for a, t in zip(sequence.lower(), ANGLES))
    return first @ second @ third


def staying(sequence):
    first, second, third = (TURNS[a](np.cos(t), np.sin(t)) for a, t in zip(sequence.lower(), ANGLES))
    return third @ second @ first


for sequence in ("xyz", "zyx", "XYZ", "ZYX", "YXZ"):
    text = f"""<mujoco><compiler angle="degree" eulerseq="{sequence}"/><worldbody><body name="arm" euler="10 20 30">
<joint name="turn"/><inertial pos="0.2 0 0" mass="1" diaginertia=".01 .01 .01"/></body></worldbody></mujoco>"""
    Path("model.xml").write_text(text)
    found = pinocchio.buildModelFromMJCF("model.xml").jointPlacements[1].rotation
    theirs = np.zeros(9)
    mujoco.mju_quat2Mat(theirs, mujoco.MjModel.from_xml_string(text).body_quat[1])
    theirs = theirs.reshape(3, 3)
    apart = np.linalg.norm(pinocchio.log3(theirs.T @ found))
    print(f"{sequence}: {apart:.3g} rad apart")
    expected = staying(sequence) if sequence.isupper() else moving(sequence)
    if not np.allclose(theirs, expected, atol=1e-12):
        raise SystemExit("changed: MuJoCo no longer takes capital letters for axes that stay")
    if not np.allclose(found, moving(sequence), atol=1e-12):
        raise SystemExit("changed: Pinocchio no longer takes every letter for an axis that moves along")
PY
