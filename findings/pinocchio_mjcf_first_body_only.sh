#!/usr/bin/env bash
# Pinocchio's reader of MJCF reads the first body of the world and leaves out all others, with no word.
#
# One would guess: every body of <worldbody> is read, or a world of several mechanisms is refused.
# What happens: the first body and what hangs on it is the model; siblings of it, with their joints and masses, are gone. Where the
# first one is a fixed base (a table, a pole), nothing that moves is left. Branches further up are read.
# Seen with: pin 4.1.0, mujoco-core 4.0.0, numpy 2.4.6; bodies of 1, 2 and 3 kg on hinges j1, j2, j3:
#   three side by side in the world: MuJoCo j1, j2, j3; Pinocchio j1
#   two side by side on the first:   j1, j2, j3 in both
#   a fixed body before j2:          MuJoCo j2; Pinocchio no joint
# Why it matters: the model loads, and is another mechanism; a robot beside the object that it handles loses the one or the other.
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
def body(k, name="", child=""):
    name = f'name="{name}"' if name else ""
    return (
        f'<body {name} pos="0 {k} 0"><joint name="j{k}" axis="0 1 0"/>'
        f'<geom type="sphere" size=".1" mass="{k}"/>{child}</body>'
    )


def sizes(bodies, what):
    text = f"<mujoco><worldbody>{bodies}</worldbody></mujoco>"
    Path("model.xml").write_text(text)
    theirs = mujoco.MjModel.from_xml_string(text)
    found = pinocchio.buildModelFromMJCF("model.xml")
    rows = (
        [(theirs.joint(k).name, float(theirs.body_mass[theirs.jnt_bodyid[k]])) for k in range(theirs.njnt)],
        [(str(name), float(i.mass)) for name, i in zip(found.names, found.inertias)][1:],
    )
    for whose, row in zip(("MuJoCo", "Pinocchio"), rows):
        print(f"{what:28} {whose:10}", ", ".join(f"{name} {mass:g} kg" for name, mass in row))
    return rows


every = [("j1", 1.0), ("j2", 2.0), ("j3", 3.0)]
theirs, found = sizes(body(1, "a", body(2, "b") + body(3, "c")), "on the first body")
if not theirs == found == every:
    raise SystemExit("changed: branches are no longer read alike")
theirs, found = sizes(body(1, "a") + body(2, "b") + body(3, "c"), "side by side in the world")
if theirs != every or found != every[:1]:
    raise SystemExit("changed: several bodies of the world")
theirs, found = sizes('<body name="pole"><geom size=".1"/></body>' + body(2, "b"), "after a fixed body")
if theirs != every[1:2] or found:
    raise SystemExit("changed: a fixed body first")
PY
