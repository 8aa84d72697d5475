#!/usr/bin/env bash
# Pinocchio's reader of MJCF drops damping and friction of ball joints, and keeps their armature.
#
# One would guess: what a joint's element states is read for a ball as it is for a hinge and a slide.
# What happens: model.damping and model.friction of a ball's three velocities are 0; model.armature has what is written.
# Seen with: pin 4.1.0, mujoco-core 4.0.0, numpy 2.4.6; <joint damping="0.3" frictionloss="0.2" armature="0.1">:
#   hinge and slide: 0.3, 0.2, 0.1 in both; ball: MuJoCo 0.3, 0.2, 0.1 three times, Pinocchio 0, 0, 0.1 three times
# Why it matters: shoulders and hips of many humanoids are balls; who takes damping from model.damping lets them swing for ever.
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
MODEL = """<mujoco><worldbody><body name="arm"><joint name="joint" type="{kind}" damping="0.3" frictionloss="0.2"
armature="0.1"/><inertial pos="0 0 -0.2" mass="1" diaginertia=".01 .01 .01"/></body></worldbody></mujoco>"""


def numbers(kind):
    text = MODEL.format(kind=kind)
    Path("model.xml").write_text(text)
    own, theirs = pinocchio.buildModelFromMJCF("model.xml"), mujoco.MjModel.from_xml_string(text)
    found = np.array([own.damping, own.friction, own.armature])
    expected = np.array([theirs.dof_damping, theirs.dof_frictionloss, theirs.dof_armature])
    print(f"{kind:6} MuJoCo {expected.tolist()}, Pinocchio {found.tolist()}")
    if not np.allclose(expected.T, [0.3, 0.2, 0.1]):
        raise SystemExit("changed: MuJoCo no longer has the numbers as written")
    return found


for kind in ("hinge", "slide"):
    if not np.allclose(numbers(kind).T, [0.3, 0.2, 0.1]):
        raise SystemExit(f"changed: Pinocchio no longer has the numbers of a {kind} as written")
if not np.allclose(numbers("ball").T, [0.0, 0.0, 0.1]):
    raise SystemExit("changed: Pinocchio has other numbers of a ball than no damping, no friction and its armature")
PY
