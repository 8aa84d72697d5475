#!/usr/bin/env bash
# Drake's reader of MJCF drops a joint's armature where no actuator drives that joint.
#
# One would guess: armature is an attribute of the joint and is added to its inertia, driven or not, as in MuJoCo; what the
# reader cannot do it says, as it does for frictionloss and stiffness.
# What happens: Drake keeps inertia of rotors at actuators. The armature of a joint with an actuator is in the mass matrix, the
# one of a joint without is not, and nothing is said of it.
# Seen with: drake 1.51.1, mujoco-core 4.0.0, numpy 2.4.6; pendulum of 0.26 kg m^2 with armature 0.1 kg m^2:
#   period of small swings in MuJoCo / Drake with a motor at zero control 1.7022 / 1.7022 s, without 1.7022 / 1.4466 s; the last
#   is what the pendulum has without armature
# Why it matters: recordings of free swings are simulated without motors. The rotor's inertia that was identified with one engine
# has no effect in the other, and comes back when somebody adds a motor with zero control.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --no-deps --target "$folder/site" \
    drake==1.51.1 mujoco-core==4.0.0 numpy==2.4.6
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
from importlib.metadata import version

import mujoco
import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

print("Drake", version("drake"), " MuJoCo", mujoco.__version__)


def periods(armature, actuator):
    """Of small swings in MuJoCo and Drake, from each one's own acceleration 1e-4 rad from rest."""
    text = f"""<mujoco model="pendulum"><worldbody><body name="b"><joint name="j" axis="0 1 0" armature="{armature}"/>
        <inertial mass="1" pos="0 0 -.5" diaginertia=".01 .01 .01"/></body></worldbody>
        <actuator>{actuator}</actuator></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[0] = 1e-4
    mujoco.mj_forward(model, data)
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(text, "xml")
    plant.Finalize()
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, [1e-4])
    plant.get_actuation_input_port().FixValue(context, np.zeros(plant.num_actuators()))
    drake = plant.get_generalized_acceleration_output_port().Eval(context)[0]
    return [2 * np.pi * np.sqrt(1e-4 / -a) for a in (data.qacc[0], drake)]


MOTOR = '<motor name="a" joint="j"/>'
light, heavy = (2 * np.pi * np.sqrt(inertia / (9.81 * 0.5)) for inertia in (0.26, 0.36))
print(f"exact: {light:.4f} s without armature, {heavy:.4f} s with 0.1 kg m^2")
for armature, actuator, expected in (
    (0.0, "", (light, light)), (0.1, MOTOR, (heavy, heavy)), (0.1, "", (heavy, light)),
):
    found = periods(armature, actuator)
    print(f"armature {armature}, {'motor at zero' if actuator else 'no motor':13}: MuJoCo {found[0]:.4f} s, Drake {found[1]:.4f} s")
    if np.abs(np.array(found) - expected).max() > 1e-4:
        raise SystemExit(f"changed: expected {expected}")
PY
