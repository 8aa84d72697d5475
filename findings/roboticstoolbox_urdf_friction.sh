#!/usr/bin/env bash
# The Robotics Toolbox for Python reads a URDF joint's dry friction as viscous and leaves its damping out.
#
# One would guess: <dynamics damping="0.2" friction="0.3"/> becomes what the toolbox has for each: B = 0.2 N m s/rad of viscous
# and Tc = (0.3, -0.3) N m of Coulomb friction, or nothing of both, as with readers that keep only the geometry.
# What happens: B = 0.3, Tc = 0. The number that says N m is multiplied by the velocity; damping alone changes nothing.
# Seen with: roboticstoolbox-python 1.5.0, numpy 2.4.6; torque that rne asks for at steady 2 rad/s beyond weight and inertia:
#   damping 0.2: 0 N m (0.4 is right); friction 0.3: 0.6 N m (0.3 is right); both: 0.6 N m (0.7 is right)
# Why it matters: free motion decays exponentially where the file says that it stops after a straight decay; a law of friction
# that is identified against such a simulation is another law than the one in the file.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" \
    roboticstoolbox-python==1.5.0 numpy==2.4.6
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" MPLBACKEND=Agg python3 - <<'PY'
import warnings
from importlib.metadata import version
from pathlib import Path

import numpy as np

warnings.simplefilter("ignore")
from roboticstoolbox import Robot
from roboticstoolbox.models.URDF.URDFRobot import URDF_read

print("Robotics Toolbox", version("roboticstoolbox-python"))
SPEED = 2.0  # rad/s


def wheel(dynamics):
    """Viscous and Coulomb friction as read, and the torque that a balanced wheel needs to keep its speed."""
    Path("wheel.urdf").write_text(f"""<robot name="wheel"><link name="base"/><link name="rim"><inertial><mass value="1"/>
        <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="axle" type="continuous"><parent link="base"/><child link="rim"/><axis xyz="0 1 0"/>{dynamics}</joint>
        </robot>""")
    links, name, _ = URDF_read(Path("wheel.urdf").absolute())
    torque = Robot(links, name=name).rne([0.3], [SPEED], [0.0])
    return float(links[-1].B), np.array(links[-1].Tc, dtype=float), float(np.ravel(torque)[0])


for dynamics, right, expected in (
    ("", 0.0, (0.0, 0.0)),
    ('<dynamics damping="0.2"/>', 0.2 * SPEED, (0.0, 0.0)),
    ('<dynamics friction="0.3"/>', 0.3, (0.3, 0.3 * SPEED)),
    ('<dynamics damping="0.2" friction="0.3"/>', 0.2 * SPEED + 0.3, (0.3, 0.3 * SPEED)),
):
    viscous, coulomb, torque = wheel(dynamics)
    print(f"{dynamics:41} B {viscous:g} N m s/rad, Tc {coulomb} N m; torque at {SPEED:g} rad/s {torque:g} N m, right {right:g}")
    if not np.allclose([viscous, torque], expected, rtol=0, atol=1e-9) or coulomb.any():
        raise SystemExit(f"changed: expected B and torque {expected}, Tc 0")
PY
