#!/usr/bin/env bash
# PyBullet reads a URDF of one name once: written anew and loaded again it is the old robot, even after resetSimulation.
#
# One would guess: loadURDF reads the file it is given; what is kept for speed are meshes ("such as .obj"), and at the latest
# resetSimulation, which removes all, forgets it.
# What happens: as long as the connection lasts the text of the first reading is used, after a change of the file, after
# removeBody, after resetSimulation, and after the file is deleted. setPhysicsEngineParameter(enableFileCaching=0) ends it.
# Seen with: pybullet 3.2.7; a link of 2, 3, 4 kg written to one file and loaded in turn: 2, 2, 2 kg; after resetSimulation
#   with 5 kg and after the file is deleted still 2 kg; with a new connection 6 kg as written, without caching 7 and 8 kg
# Why it matters: a fit or a sweep that writes masses into a URDF and runs it simulates its first candidate over and over: the
# cost does not change with the parameter, which reads as a parameter that cannot be identified.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --no-deps --target "$folder/site" pybullet==3.2.7
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
from importlib.metadata import version
from pathlib import Path

import pybullet

print("PyBullet", version("pybullet"))
FILE = Path("arm.urdf")


def link(name, mass):
    return f"""<link name="{name}"><inertial><mass value="{mass}"/>
        <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


def told(mass):
    """What mass the engine has for a link that was just written with this mass."""
    if mass:
        FILE.write_text(f"""<robot name="arm">{link("base", 1)}{link("l", mass)}
            <joint name="j" type="continuous"><parent link="base"/><child link="l"/><axis xyz="0 1 0"/></joint></robot>""")
    body = pybullet.loadURDF(FILE.name, useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
    found = pybullet.getDynamicsInfo(body, 0)[0]
    pybullet.removeBody(body)
    return found


def seen(what, found, expected):
    print(f"{what}: {found} kg")
    if found != expected:
        raise SystemExit(f"changed: {what}, seen before {expected}")


pybullet.connect(pybullet.DIRECT)
seen("written with 2, 3, 4 kg", [told(2), told(3), told(4)], [2.0, 2.0, 2.0])
pybullet.resetSimulation()
seen("after resetSimulation with 5 kg", told(5), 2.0)
FILE.unlink()
seen("after the file is deleted", told(None), 2.0)
pybullet.disconnect()
pybullet.connect(pybullet.DIRECT)
seen("new connection, 6 kg", told(6), 6.0)
pybullet.setPhysicsEngineParameter(enableFileCaching=0)
seen("without caching, 7 and 8 kg", [told(7), told(8)], [7.0, 8.0])
PY
