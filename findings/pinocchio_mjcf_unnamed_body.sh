#!/usr/bin/env bash
# Pinocchio's reader of MJCF takes two bodies without a name that hang on the same body for one.
#
# One would guess: names of bodies are optional in MJCF, and a reader makes them up, as it does for a joint without a name.
# What happens: the second of the two is read as the first once more. One joint is there twice under the same name, with the
# masses of both readings on it and none on the other; the second body's joint and mass are gone, with no word.
# Seen with: pin 4.1.0, mujoco-core 4.0.0, numpy 2.4.6; a body of 1 kg (joint j1) that carries bodies of 2 and 3 kg (j2, j3):
#   all named: j1 1 kg, j2 2 kg, j3 3 kg in both; the two without a name: Pinocchio j1 1 kg, j2 4 kg, j2 0 kg
# Why it matters: number of joints and of bodies are as they should be, so that nothing looks amiss; a joint without inertia makes
# the mass matrix singular.
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
theirs, found = sizes(body(1, "a", body(2, "b") + body(3, "c")), "all named")
if not theirs == found == every:
    raise SystemExit("changed: named bodies are no longer read alike")
theirs, found = sizes(body(1, "a", body(2) + body(3)), "two without a name")
if theirs != every or found != [("j1", 1.0), ("j2", 4.0), ("j2", 0.0)]:
    raise SystemExit("changed: two bodies without a name on one body")
PY
