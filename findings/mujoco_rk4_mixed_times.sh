#!/usr/bin/env bash
# After mj_step, mjData under RK4 holds quantities of three different instants.
#
# One would guess: qpos and qvel are those of the new time, and everything else in mjData (positions of sites, sensors,
# energy, accelerations) is still that of the state before the step, whichever integrator made it, as it is under Euler.
# What happens: with integrator="RK4" the sensors are those of the state before the step; site_xpos and energy are those
# of the fourth stage, a trial state near the new one but not it; qacc is the mean of the four stages. A framepos sensor
# and site_xpos of one site, read side by side, differ by a step. mj_forward before reading puts all of them right.
# Seen with: mujoco-core 4.0.0, numpy 2.4.6, a pendulum at 1 rad and 3 rad/s, step 10 ms (x of the tip):
#   Euler  site_xpos -0.84147098  sensor -0.84147098  before the step -0.84147098  after it -0.85648065
#   RK4    site_xpos -0.85688620  sensor -0.84147098  before the step -0.84147098  after it -0.85688753
# Why it matters: energies and accelerations logged along a run look as if RK4 drifted or lagged, when what was read
# belongs to no state of the run; a comparison with another engine then blames the wrong one.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" mujoco-core==4.0.0 numpy==2.4.6
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
import mujoco
import numpy as np

print("MuJoCo", mujoco.__version__)
STEP = 0.01


def step(integrator):
    """One step: (x of site, x by sensor, energy, qacc) as mj_step leaves them, then the true states before and after."""
    model = mujoco.MjModel.from_xml_string(f"""
        <mujoco><option integrator="{integrator}" timestep="{STEP}"><flag energy="enable"/></option>
        <worldbody><body><joint axis="0 1 0"/><inertial mass="1" pos="0 0 -.5" diaginertia=".01 .01 .01"/>
        <site name="tip" pos="0 0 -1"/></body></worldbody>
        <sensor><framepos objtype="site" objname="tip"/></sensor></mujoco>""")
    data = mujoco.MjData(model)

    def now():
        return np.array([data.site_xpos[0, 0], data.sensordata[0], data.energy.sum(), data.qacc[0]])

    data.qpos[0], data.qvel[0] = 1.0, 3.0
    mujoco.mj_forward(model, data)
    before, speed = now(), data.qvel[0]
    mujoco.mj_step(model, data)
    left, mean = now(), (data.qvel[0] - speed) / STEP
    mujoco.mj_forward(model, data)
    after = now()
    print(f"{integrator:6} site_xpos {left[0]:.8f}  sensor {left[1]:.8f}  before {before[0]:.8f}  after {after[0]:.8f}  "
          f"qacc {left[3]:.6f}  before {before[3]:.6f}  after {after[3]:.6f}  mean of the step {mean:.6f}")
    return before, left, after, mean


before, left, after, mean = step("Euler")
if not np.allclose(left, before, rtol=0, atol=1e-12):
    raise SystemExit("changed: Euler no longer leaves what belongs to the state before the step")
before, left, after, mean = step("RK4")
if abs(left[1] - before[1]) > 1e-12:
    raise SystemExit("changed: the sensor under RK4 is not that of the state before the step")
if not 1e-7 < abs(left[0] - after[0]) < 1e-4 or abs(left[0] - before[0]) < 1e-2:
    raise SystemExit("changed: site_xpos under RK4 is not near the new state without being it")
if not 1e-7 < abs(left[2] - after[2]) < 1e-3:
    raise SystemExit("changed: the energy under RK4 is not near that of the new state without being it")
if abs(left[3] - mean) > 1e-9 or min(abs(left[3] - before[3]), abs(left[3] - after[3])) < 0.05:
    raise SystemExit("changed: qacc under RK4 is not the mean over the step")
PY
