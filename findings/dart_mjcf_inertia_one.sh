#!/usr/bin/env bash
# DART's reader of MJCF gives every body an inertia of 1 kg m^2, whatever the file says or the geoms are.
#
# One would guess: mass, centre of mass and inertia of a body are all read from <inertial>, or all computed from the geoms.
# What happens: mass and centre of mass are right, both ways; the inertia about the centre of mass is 1 kg m^2 about each axis,
# with no word. An <inertial> in a body without geoms is not read at all: 1 kg, 1 kg m^2, at the body's origin.
# Seen with: dartpy 6.20.0, mujoco-core 4.0.0, numpy 2.4.6; inertia about the hinge in kg m^2, MuJoCo / DART:
#   <inertial> of 1.5 kg and 0.03 kg m^2 at 0.4 m, with a geom: 0.27 / 1.24; without a geom: 0.27 / 1;
#   a sphere of 2 kg, radius 0.1 m, at 0.4 m: 0.328 / 1.32; period of the first, small swing: 1.346 / 2.884 s
# Why it matters: an arm of ordinary size swings at half its frequency or less at the right weight, which looks like a rotor or a
# load that the model lacks.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --no-deps --target "$folder/site" \
    dartpy==6.20.0 mujoco-core==4.0.0 numpy==2.4.6
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
import os
from importlib.metadata import version

import dartpy
import mujoco
import numpy as np

print("DART", version("dartpy"), " MuJoCo", mujoco.__version__)
INERTIAL = '<inertial mass="1.5" pos="0 0 -0.4" diaginertia="0.02 0.03 0.01"/>'
SMALL, SPHERE = '<geom type="sphere" size="0.01"/>', '<geom type="sphere" size="0.1" pos="0 0 -0.4" mass="2"/>'


def dart_of(text):
    with open("body.xml", "w") as file:
        file.write(text)
    world = dartpy.utils.MjcfParser.readWorld(os.path.abspath("body.xml"))
    skeleton = world.getSkeleton(0)
    return world, skeleton, skeleton.getBodyNode(0)


def half_period(step, angle):
    """Time [s] from rest at 0.05 rad to the next crossing of the middle, times two."""
    before, count = angle(), 0
    while before > 0:
        step()
        before, count = angle(), count + 1
    return 2.0 * count * 1e-3


for label, inside, hinge, one, mass in (
    ("<inertial> and a geom", INERTIAL + SMALL, 0.03 + 1.5 * 0.16, 1.0 + 1.5 * 0.16, 1.5),
    ("<inertial>, no geom", INERTIAL, 0.03 + 1.5 * 0.16, 1.0, 1.0),
    ("geom of 2 kg", SPHERE, 0.4 * 2 * 0.01 + 2 * 0.16, 1.0 + 2 * 0.16, 2.0),
):
    text = (f'<mujoco model="body"><option timestep="0.001"/><worldbody><body name="b"><joint name="j" axis="0 1 0"/>{inside}'
            "</body></worldbody></mujoco>")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    right = np.zeros(1)
    mujoco.mj_mulM(model, data, right, np.ones(1))
    world, skeleton, body = dart_of(text)
    found = skeleton.getMassMatrix()[0, 0]
    masses = f"{model.body_mass[1]:.3g} / {body.getMass():.3g} kg"
    print(f"{label:22}: mass {masses}, about the hinge {right[0]:.4f} / {found:.4f} kg m^2")
    if abs(right[0] - hinge) > 1e-9 or abs(body.getMass() - mass) > 1e-9 or abs(found - one) > 1e-9:
        raise SystemExit(f"changed: seen before {hinge} and {one} kg m^2, {mass} kg in DART")
    if label == "<inertial> and a geom":
        data.qpos[0] = 0.05
        skeleton.setPosition(0, 0.05)
        times = (half_period(lambda: mujoco.mj_step(model, data), lambda: data.qpos[0]),
                 half_period(world.step, lambda: skeleton.getPosition(0)))
        closed = [np.pi * np.sqrt(inertia / (1.5 * 9.81 * 0.4)) for inertia in (hinge, one)]
        print(f"  half a period {times[0]:.3f} / {times[1]:.3f} s; by the closed form {closed[0]:.3f} and {closed[1]:.3f} s")
        if np.abs(np.subtract(times, closed)).max() > 5e-3:
            raise SystemExit("changed: the periods are not those of these inertias")
PY
