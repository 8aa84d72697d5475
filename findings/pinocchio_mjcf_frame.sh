#!/usr/bin/env bash
# Pinocchio's reader of MJCF drops the bodies that stand in a <frame> of a body, with all that hangs on them, silently.
#
# One would guess: a <frame> only moves what it holds, or a reader that does not know it says so (as this one does for a
# <frame> right in the world, where it ends with "No such node").
# What happens: within a body the frame is passed over together with its bodies. The model has fewer joints and less mass.
# Seen with: pin 4.1.0, mujoco-core 4.0.0, numpy 2.4.6; an arm of two links, the second one in a frame:
#   MuJoCo 2 joints, 3 kg; Pinocchio 1 joint, 1 kg; without the frame Pinocchio 2 joints, 3 kg
# Why it matters: nothing fails until vectors of another length meet; a comparison that goes by the joints both know
# (as one by names does) sees a lighter arm and looks for the missing inertia in the wrong file.
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
import pinocchio

print("Pinocchio", pinocchio.__version__, " MuJoCo", mujoco.__version__)
MODEL = """<mujoco><worldbody><body name="upper"><joint name="shoulder" axis="0 1 0"/>
<inertial pos="0 0 -.2" mass="1" diaginertia=".01 .01 .01"/>{opened}
<body name="lower" pos="0 0 -.4"><joint name="elbow" axis="0 1 0"/>
<inertial pos="0 0 -.2" mass="2" diaginertia=".01 .01 .01"/></body>{closed}</body></worldbody></mujoco>"""


def read(opened, closed):
    text = MODEL.format(opened=opened, closed=closed)
    Path("model.xml").write_text(text)
    theirs = mujoco.MjModel.from_xml_string(text)
    model = pinocchio.buildModelFromMJCF("model.xml")
    found = (theirs.nv, float(theirs.body_mass.sum())), (model.nv, float(pinocchio.computeTotalMass(model)))
    print(f"{opened or 'no frame':28} MuJoCo {found[0][0]} joints, {found[0][1]:g} kg; Pinocchio {found[1][0]} joints, {found[1][1]:g} kg")
    return found


plain, framed = read("", ""), read('<frame euler="0 0 30">', "</frame>")
if plain != ((2, 3.0), (2, 3.0)) or framed[0] != (2, 3.0):
    raise SystemExit("changed: the arm is read otherwise without a frame, or by MuJoCo")
if framed[1] != (1, 1.0):
    raise SystemExit("changed: Pinocchio's reader no longer drops the bodies in a frame")
PY
