#!/usr/bin/env bash
# MuJoCo's exactly integrated filter is exact under Euler and of first order under RK4, where the plain filter is better.
#
# One would guess: dyntype="filterexact" (also that of <position timeconst="...">) integrates a first-order lag without
# any error at a held command, so that it is exact under every integrator; with RK4 the motor's motion converges with the
# fourth power of the step, and "filterexact" is never worse than "filter".
# What happens: under RK4 the activation itself is wrong by 7 % at a step of 0.4 time constants, an error that falls with
# the first power of the step, and so does the motion. "filter" under RK4 is a thousand times closer, of fourth order.
# Seen with: mujoco-core 4.0.0, numpy 2.4.6, time constant 50 ms, command 1, after 100 ms; error of the activation:
#   filterexact Euler  step 20 ms  0        10 ms  0
#   filterexact RK4    step 20 ms -7.0e-02  10 ms -3.1e-02   5 ms -1.4e-02
#   filter      RK4    step 20 ms -8.1e-05  10 ms -4.3e-06   5 ms -2.5e-07
# Why it matters: who turns to RK4 to compare engines at high accuracy gets a lagging drive whose lag is off by a share of
# the step, and finds a delay in the other engine.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" mujoco-core==4.0.0 numpy==2.4.6
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
import mujoco
import numpy as np

print("MuJoCo", mujoco.__version__)
LAG, END, INERTIA = 0.05, 0.1, 0.26
# Closed form of a' = (1 − a) / LAG, INERTIA v' = a, from rest.
ACTIVATION = 1.0 - np.exp(-END / LAG)
SPEED = (END - LAG * ACTIVATION) / INERTIA


def errors(kind, integrator, step):
    model = mujoco.MjModel.from_xml_string(f"""
        <mujoco><option integrator="{integrator}" timestep="{step}" gravity="0 0 0"/>
        <worldbody><body><joint name="j" axis="0 1 0"/><inertial mass="1" pos="0 0 -.5" diaginertia=".01 .01 .01"/></body>
        </worldbody><actuator><general joint="j" dyntype="{kind}" dynprm="{LAG}" gainprm="1"/></actuator></mujoco>""")
    data = mujoco.MjData(model)
    data.ctrl[0] = 1.0
    for _ in range(round(END / step)):
        mujoco.mj_step(model, data)
    found = data.act[0] - ACTIVATION, data.qvel[0] - SPEED
    print(f"{kind:12} {integrator:6} step {1e3 * step:3.0f} ms  activation off by {found[0]:+.1e}  speed by {found[1]:+.1e}")
    return np.abs(found)


STEPS = (0.02, 0.01, 0.005)
if max(errors("filterexact", "Euler", step)[0] for step in STEPS) > 1e-12:
    raise SystemExit("changed: filterexact is not exact under Euler")
exact = np.array([errors("filterexact", "RK4", step) for step in STEPS])
plain = np.array([errors("filter", "RK4", step) for step in STEPS])
order = np.log2(exact[1] / exact[2])
print("order of filterexact under RK4 (activation, speed)", np.round(order, 2), " of filter", np.round(np.log2(plain[1] / plain[2]), 2))
if not exact[0, 0] > 0.05 or np.any(order > 1.3):
    raise SystemExit("changed: filterexact under RK4 is no longer of first order")
if np.any(plain * 500 > exact) or np.any(np.log2(plain[1] / plain[2]) < 3.5):
    raise SystemExit("changed: the plain filter under RK4 is no longer of fourth order and far better")
PY
