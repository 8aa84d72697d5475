#!/usr/bin/env bash
# Under RK4 a control that MuJoCo delays by whole steps acts a sixth of a step too early, or half a step if it interpolates.
#
# One would guess: <motor delay="0.05" nsample="10"> at a step of 10 ms is the same run as handing over every control five steps
# later: a control is held over a step, and the delay is a whole number of steps.
# What happens: so it is with Euler, implicit, implicitfast and discrete, to rounding. RK4 looks the delayed control up again at
# each of its four stages, and the last one is already in the next control's step; a held control so counts with 1/6 of the
# next one in every step, with interp="linear" or "cubic" with 1/2. The error falls with the first power of the step.
# Seen with: mujoco-core 4.0.0, numpy 2.4.6; mass on a slide, control sin 6t, delay 50 ms; largest difference of the speed from
# the run with controls handed over later [m/s], at 10 and 5 ms:
#   Euler zoh 0, 0;  RK4 zoh 1.7e-3, 8.3e-4;  RK4 linear 5.0e-3, 2.5e-3
# Why it matters: a drive's latency is identified to a fraction of a step. Latency found with shifted controls differs from the
# one found with the model's own delay by 1/6 or 1/2 step, and only with the integrator one takes for accuracy.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" mujoco-core==4.0.0 numpy==2.4.6
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
import mujoco
import numpy as np

print("MuJoCo", mujoco.__version__)
DELAY, END = 0.05, 1.0


def speeds(integrator, step, held, delayed):
    """Speeds of a unit mass whose control is delayed by the model, or handed over later."""
    options = f'delay="{DELAY}" nsample="20" interp="{held}"' if delayed else ""
    model = mujoco.MjModel.from_xml_string(f"""
        <mujoco><option integrator="{integrator}" timestep="{step}" gravity="0 0 0"/><worldbody><body>
        <joint name="j" type="slide" axis="1 0 0"/><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/></body></worldbody>
        <actuator><motor joint="j" {options}/></actuator></mujoco>""")
    data = mujoco.MjData(model)
    found = []
    for number in range(round(END / step)):
        late = number if delayed else number - round(DELAY / step)
        data.ctrl[0] = np.sin(6.0 * late * step) if late > 0 else 0.0
        mujoco.mj_step(model, data)
        found.append(data.qvel[0])
    return np.array(found)


for integrator in ("Euler", "implicit", "implicitfast", "discrete", "RK4"):
    for held, share in (("zoh", 1 / 6), ("linear", 1 / 2), ("cubic", 1 / 2)):
        early = []
        for step in (0.01, 0.005):
            delayed, later = (speeds(integrator, step, held, which) for which in (True, False))
            early.append(np.abs(delayed - later).max())
            # A share s of the next control in each step is speed s h (u(t) - u(0)), u the control that arrives at t.
            expected = share * step if integrator == "RK4" else 0.0
            if not abs(early[-1] - expected) < max(1e-3 * expected, 1e-12):
                raise SystemExit(f"changed: {integrator} {held} {step}: {early[-1]}, expected {expected}")
        print(f"{integrator:12} interp {held:6} differs by {early[0]:.1e} m/s at 10 ms, {early[1]:.1e} at 5 ms")
PY
