#!/usr/bin/env bash
# Pinocchio's reader of MJCF takes the range of a slide joint for degrees: 0.3 m becomes 5.2 mm.
#
# One would guess: angle="degree" (the default) concerns angles; the range of a slide joint is a length and read as it stands.
# What happens: both ends are multiplied by pi/180, as those of a hinge are. With angle="radian" they are right.
# Seen with: pin 4.1.0, mujoco-core 4.0.0, numpy 2.4.6; <joint type="slide" range="-0.2 0.3"/>:
#   MuJoCo -0.2 to 0.3 m, Pinocchio -0.00349066 to 0.00523599 m; with angle="radian" Pinocchio -0.2 to 0.3 m
# Why it matters: positions drawn within the limits (as for comparing engines, or for identification) then cover a
# hundredth of the travel, where every model of the mechanism agrees with every other.
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
MODEL = """<mujoco>{compiler}<worldbody><body name="cart"><joint name="rail" type="slide" axis="1 0 0" range="-0.2 0.3"/>
<inertial pos="0 0 0" mass="1" diaginertia=".01 .01 .01"/></body></worldbody></mujoco>"""


def ranges(compiler):
    text = MODEL.format(compiler=compiler)
    Path("model.xml").write_text(text)
    model = pinocchio.buildModelFromMJCF("model.xml")
    found = np.array([model.lowerPositionLimit[0], model.upperPositionLimit[0]])
    theirs = mujoco.MjModel.from_xml_string(text).jnt_range[0]
    print(f"{compiler or 'degrees by default':32} MuJoCo {theirs} m, Pinocchio {found} m")
    return theirs, found


degrees, radians = ranges(""), ranges('<compiler angle="radian"/>')
LIMITS = np.array([-0.2, 0.3])
if not all(np.allclose(x, LIMITS, rtol=0, atol=1e-12) for x in (degrees[0], *radians)):
    raise SystemExit("changed: MuJoCo, or radians, no longer give the range as written")
if not np.allclose(degrees[1], np.deg2rad(LIMITS), rtol=1e-9, atol=0):
    raise SystemExit("changed: Pinocchio no longer takes the range of a slide joint for degrees")
PY
