#!/usr/bin/env bash
# MJX takes models with forces that it does not compute, and computes the motion without them.
#
# One would guess: what MJX cannot do it refuses, as its documentation says of unsupported features and as it does for a DC
# motor; for all else it is MuJoCo on another device.
# What happens: of damping="a b c" and stiffness="a b c" only a is used, armature and damping of an actuator and its delay
# are left out, a sensor with a delay reads what is now. There is no exception and no warning.
# Seen with: mujoco 3.17.0, mujoco-mjx 3.17.0, jax 0.10.2 in double precision; pendulum, -0.7 rad, 2 rad/s, control 1,
#   acceleration in MuJoCo / MJX, rad/s^2: plain 12.153 / 12.153; damping ".1 .2 .3" -0.924 / 11.384; stiffness "1 2 3"
#   15.034 / 14.846; motor with gear 10: armature .003 23.500 / 50.615, damping .03 27.538 / 50.615; delay 12.153 / 16.000
# Why it matters: MJX is where gradients and many runs at once come from. A friction law or a rotor inertia that was found
# with MuJoCo is dropped there, and the two differ by what looks like a wrong parameter.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --no-deps --target "$folder/site" \
    mujoco==3.17.0 mujoco-mjx==3.17.0 jax==0.10.2 jaxlib==0.10.2 ml_dtypes==0.6.0 opt_einsum==3.4.0 scipy==1.17.1 numpy==2.4.6 \
    etils==1.15.0 trimesh==5.2.0 absl-py==2.5.1 typing_extensions==4.16.0 glfw==2.11.0 PyOpenGL==3.1.10
cd "$folder"
JAX_PLATFORMS=cpu PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 -W ignore - <<'PY'
import jax
import mujoco

jax.config.update("jax_enable_x64", True)
from mujoco import mjx

print("MuJoCo", mujoco.__version__, " JAX", jax.__version__)


def both(joint="", actuator="", sensor=""):
    model = mujoco.MjModel.from_xml_string(f"""
        <mujoco><worldbody><body><joint name="j" axis="0 1 0" {joint}/>
        <inertial mass="1" pos="0 0 -.5" diaginertia=".01 .01 .01"/></body></worldbody>
        <actuator>{actuator}</actuator><sensor>{sensor}</sensor></mujoco>""")
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[0] = -0.7, 2.0
    data.ctrl[:] = 1.0
    other = mjx.forward(mjx.put_model(model), mjx.put_data(model, data))
    mujoco.mj_forward(model, data)
    if sensor:
        return float(data.sensordata[0]), float(other.sensordata[0])
    return float(data.qacc[0]), float(other.qacc[0])


cases = {  # what it is: how to ask, what was seen
    "plain": ({}, (12.153, 12.153)),
    "damping a": ({"joint": 'damping=".1"'}, (11.384, 11.384)),
    "damping a b c": ({"joint": 'damping=".1 .2 .3"'}, (-0.924, 11.384)),
    "stiffness a b c": ({"joint": 'stiffness="1 2 3"'}, (15.034, 14.846)),
    "motor, gear": ({"actuator": '<motor joint="j" gear="10"/>'}, (50.615, 50.615)),
    "motor, gear, armature": ({"actuator": '<motor joint="j" gear="10" armature=".003"/>'}, (23.500, 50.615)),
    "motor, gear, damping": ({"actuator": '<motor joint="j" gear="10" damping=".03"/>'}, (27.538, 50.615)),
    "motor, delay": ({"actuator": '<motor joint="j" delay=".01" nsample="20"/>'}, (12.153, 16.000)),
    "sensor, delay": ({"sensor": '<jointpos joint="j" delay=".01" nsample="20"/>'}, (0.0, -0.7)),
}
for name, (how, seen) in cases.items():
    found = both(**how)
    print(f"{name:22} MuJoCo {found[0]:8.3f}   MJX {found[1]:8.3f}")
    if abs(found[0] - seen[0]) > 2e-3 or abs(found[1] - seen[1]) > 2e-3:
        raise SystemExit(f"changed: {name}, seen before {seen}")
try:
    both(actuator='<dcmotor joint="j" motorconst=".1" resistance="2"/>')
except NotImplementedError as why:
    print("DC motor: refused,", why)
else:
    raise SystemExit("changed: a DC motor is no longer refused")
PY
