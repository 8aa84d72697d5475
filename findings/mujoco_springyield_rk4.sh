#!/usr/bin/env bash
# A joint spring that yields is five hundred times more accurate under MuJoCo's Euler than under its RK4.
#
# One would guess: springyield caps the force of the spring at stiffness times yield, in whatever state it is asked; and
# the run converges faster with RK4 than with Euler, or at worst as fast, because of the kinks.
# What happens: the force is not capped by the state. Slip is settled once a step, after it, so that mj_forward beyond
# the yield tells the whole elastic force. Within a step of RK4 the trial stages then push back with more than the
# spring can hold, and the error falls with the first power of the step; Euler, which asks for the force at the step's
# start alone, is close to exact.
# Seen with: mujoco-core 4.0.0, numpy 2.4.6; 0.26 kg m2, 10 N m/rad, yield 0.2 rad, 3 rad/s; position after 0.5 s against
# the closed form (elastic, yielding, elastic back), 0.66309959 rad:
#   Euler  1 ms +5e-06
#   RK4    1 ms -2.9e-03   0.5 ms -1.4e-03   0.25 ms -7.2e-04
#   spring 1 rad from rest: force -10 N m, not -2
# Why it matters: a comparison of engines on a mechanism with plastic joints asks for RK4 by habit and then finds the
# other engine wrong in the third digit.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" mujoco-core==4.0.0 numpy==2.4.6
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
import mujoco
import numpy as np

print("MuJoCo", mujoco.__version__)
INERTIA, STIFFNESS, YIELD, SPEED, END = 0.26, 10.0, 0.2, 3.0, 0.5
# Closed form: a harmonic motion up to the yield, constant deceleration to rest, a harmonic motion about the new rest.
rate = np.sqrt(STIFFNESS / INERTIA)
reached = np.arcsin(YIELD * rate / SPEED) / rate
left = np.sqrt(SPEED**2 - (rate * YIELD) ** 2)
slowing = STIFFNESS * YIELD / INERTIA
slip, still = left**2 / (2 * slowing), reached + left / slowing
TRUTH = slip + YIELD * np.cos(rate * (END - still))


def model_of(integrator, step):
    return mujoco.MjModel.from_xml_string(f"""
        <mujoco><option integrator="{integrator}" timestep="{step}" gravity="0 0 0"/><compiler angle="radian"/>
        <worldbody><body><joint axis="0 1 0" stiffness="{STIFFNESS}" springyield="{YIELD}"/>
        <inertial mass="1" pos="0 0 -.5" diaginertia=".01 .01 .01"/></body></worldbody></mujoco>""")


def error(integrator, step):
    model = model_of(integrator, step)
    data = mujoco.MjData(model)
    data.qvel[0] = SPEED
    for _ in range(round(END / step)):
        mujoco.mj_step(model, data)
    print(f"{integrator:6} step {1e3 * step:4.2f} ms: {data.qpos[0]:.8f} rad, off by {data.qpos[0] - TRUTH:+.1e}")
    return abs(data.qpos[0] - TRUTH)


print(f"closed form {TRUTH:.8f} rad")
euler = error("Euler", 0.001)
rk4 = [error("RK4", step) for step in (0.001, 0.0005, 0.00025)]
model = model_of("Euler", 0.001)
data = mujoco.MjData(model)
data.qpos[0] = 1.0
mujoco.mj_forward(model, data)
print(f"spring at 1 rad: {data.qfrc_passive[0]:.6f} N m, yield at {STIFFNESS * YIELD:g} N m")
if euler > 2e-5:
    raise SystemExit("changed: Euler is no longer close to the closed form")
if rk4[0] < 100 * euler or not 1.7 < rk4[0] / rk4[1] < 2.3 or not 1.7 < rk4[1] / rk4[2] < 2.3:
    raise SystemExit("changed: RK4 is no longer of first order and far behind Euler")
if abs(data.qfrc_passive[0] + STIFFNESS) > 1e-9:
    raise SystemExit("changed: mj_forward beyond the yield no longer tells the whole elastic force")
PY
