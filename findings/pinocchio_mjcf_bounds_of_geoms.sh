#!/usr/bin/env bash
# Pinocchio's reader of MJCF keeps boundmass and boundinertia for stated inertias, and not for those that it makes of geoms.
#
# One would guess: a bound in <compiler> holds for every body, or for none where it is not supported.
# What happens: a body with <inertial> has at least the bounds, as in MuJoCo; a body whose mass comes from its geoms has what these
# make, with no word.
# Seen with: pin 4.1.0, mujoco-core 4.0.0, numpy 2.4.6; a ball of 1 kg with moments of 0.004 kg·m², boundmass="5" boundinertia=".5":
#   by <inertial>: 5 kg, 0.5 kg·m² in both; by a geom: MuJoCo 5 kg, 0.5 kg·m²; Pinocchio 1 kg, 0.004 kg·m²
# Why it matters: bounds are written where geoms leave light bodies that make simulations stiff, and that is where they are missed.
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
STATED = '<inertial pos="0 0 0" mass="1" diaginertia=".004 .004 .004"/>'
BALL = '<geom type="sphere" size=".1" mass="1"/>'
MODEL = """<mujoco><compiler {bounds}/><worldbody><body name="b"><joint name="j" axis="0 1 0"/>{of}</body></worldbody></mujoco>"""


def read(bounds, of, what):
    text = MODEL.format(bounds=bounds, of=of)
    Path("model.xml").write_text(text)
    theirs, found = mujoco.MjModel.from_xml_string(text), pinocchio.buildModelFromMJCF("model.xml").inertias[1]
    rows = np.array([[theirs.body_mass[1], theirs.body_inertia[1][1]], [found.mass, found.inertia[1, 1]]])
    print(f"{what:24} MuJoCo {rows[0]}, Pinocchio {rows[1]} [kg, kg·m²]")
    return rows


bare, bound = [1.0, 0.004], [5.0, 0.5]
for of, what in ((STATED, "stated, no bounds"), (BALL, "geom, no bounds")):
    if not np.allclose(read("", of, what), [bare, bare]):
        raise SystemExit("changed: bodies without bounds are no longer read alike")
if not np.allclose(read('boundmass="5" boundinertia=".5"', STATED, "stated"), [bound, bound]):
    raise SystemExit("changed: bounds of a stated inertia")
if not np.allclose(read('boundmass="5" boundinertia=".5"', BALL, "geom"), [bound, bare]):
    raise SystemExit("changed: bounds of what a geom makes")
PY
