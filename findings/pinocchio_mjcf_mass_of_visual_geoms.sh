#!/usr/bin/env bash
# Pinocchio's reader of MJCF gives a body no mass for a geom that cannot collide, though its mass is written beside it.
#
# One would guess: contype and conaffinity concern contacts alone; a geom's mass or density is its body's, as in MuJoCo.
# What happens: where both are 0 (how models switch contacts off, or mark shapes that are only looked at) the geom is left out
# of the inertia, with no word. One of the two alone being 0 changes nothing, nor does another group.
# Seen with: pin 4.1.0, mujoco-core 4.0.0, numpy 2.4.6; a box with mass="3":
#   contype="0" conaffinity="0": MuJoCo 3 kg, Pinocchio 0 kg; as it is, contype="0", conaffinity="0", group="2": 3 kg in both
# Why it matters: the model loads, and its dynamics lack whole bodies; where every geom is such, the mass matrix is singular.
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
MODEL = """<mujoco><worldbody><body name="box"><freejoint name="flight"/>
<geom type="box" size=".1 .1 .1" mass="3" {more}/></body></worldbody></mujoco>"""


def masses(more):
    text = MODEL.format(more=more)
    Path("model.xml").write_text(text)
    found = pinocchio.buildModelFromMJCF("model.xml").inertias[1].mass
    theirs = mujoco.MjModel.from_xml_string(text).body_mass[1]
    print(f"{more or 'as it is':32} MuJoCo {theirs:g} kg, Pinocchio {found:g} kg")
    return theirs, found


for more in ("", 'contype="0"', 'conaffinity="0"', 'group="2"'):
    if not np.allclose(masses(more), 3.0):
        raise SystemExit("changed: a mass as written is no longer read")
theirs, found = masses('contype="0" conaffinity="0"')
if not np.isclose(theirs, 3.0):
    raise SystemExit("changed: MuJoCo no longer counts the mass of a geom that cannot collide")
if found != 0.0:
    raise SystemExit("changed: Pinocchio now counts the mass of a geom that cannot collide")
PY
