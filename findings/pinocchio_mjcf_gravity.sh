#!/usr/bin/env bash
# Pinocchio's reader of MJCF leaves gravity at 9.81 m/s² downwards, whatever the file's <option gravity> says.
#
# One would guess: <option gravity="0 0 0"> of a satellite, or the tilted gravity of a slope, is the model's.
# What happens: model.gravity is that of a model that was read from URDF, which has no word for it.
# Seen with: pin 4.1.0, mujoco-core 4.0.0, numpy 2.4.6:
#   gravity="0 0 0" and gravity="0.5 0 -9.7": MuJoCo as written, Pinocchio 0 0 -9.81
# Why it matters: inverse dynamics of what floats in space then holds its weight.
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
for written in ((0.0, 0.0, 0.0), (0.5, 0.0, -9.7)):
    text = f"""<mujoco><option gravity="{' '.join(map(str, written))}"/><worldbody><body name="bus"><joint name="turn"/>
<inertial pos="0.2 0 0" mass="1" diaginertia=".01 .01 .01"/></body></worldbody></mujoco>"""
    Path("model.xml").write_text(text)
    found = pinocchio.buildModelFromMJCF("model.xml").gravity.linear
    theirs = mujoco.MjModel.from_xml_string(text).opt.gravity
    print(f"{str(written):18} MuJoCo {theirs}, Pinocchio {found}")
    if not np.allclose(theirs, written):
        raise SystemExit("changed: MuJoCo no longer has gravity as written")
    if not np.allclose(found, [0.0, 0.0, -9.81]):
        raise SystemExit("changed: Pinocchio has another gravity than 9.81 m/s² downwards")
PY
