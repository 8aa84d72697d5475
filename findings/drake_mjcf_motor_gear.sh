#!/usr/bin/env bash
# Drake's reader of MJCF takes the gear of a motor for the rotor's inertia only: control and its limit do not go through it.
#
# One would guess: gear="10" makes a control of 1 a joint torque of 10 N m, as in MuJoCo, or is named among what is not
# supported, as the same reader names dampratio and frictionloss.
# What happens: without a word the torque at the joint is 1 N m. The gear is read, all the same: the joint's actuator says a
# gear ratio of 10 and a rotor inertia of armature / 100, and its effort limit, a limit of the torque at the joint, is
# forcerange="-1 1" as written, where MuJoCo lets 10 N m through.
# Seen with: drake 1.51.1, mujoco-core 4.0.0, numpy 2.4.6; torque at the joint in N m, MuJoCo / Drake:
#   motor, control 1: 1 / 1;  gear 10, control 1: 10 / 1;  gear 10, forcerange +-1, control 50: 10 / 1
# Why it matters: one model file and one recording of controls give motions that differ by the gear, which looks like a wrong
# motor constant, all the more as the mass matrices of the two agree.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --no-deps --target "$folder/site" \
    drake==1.51.1 mujoco-core==4.0.0 numpy==2.4.6
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
from importlib.metadata import version

import mujoco
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

print("Drake", version("drake"), " MuJoCo", mujoco.__version__)
INERTIA = 0.1 + 0.1  # a wheel and the armature of its joint, kg m^2


def torques(options, control):
    text = f"""<mujoco model="wheel"><worldbody><body name="b"><joint name="j" axis="0 1 0" armature=".1"/>
        <inertial mass="1" pos="0 0 0" diaginertia=".1 .1 .1"/></body></worldbody>
        <actuator><motor name="a" joint="j" {options}/></actuator></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.ctrl[0] = control
    mujoco.mj_forward(model, data)
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(text, "xml")
    plant.Finalize()
    context = plant.CreateDefaultContext()
    plant.get_actuation_input_port().FixValue(context, [control])
    drake = plant.get_generalized_acceleration_output_port().Eval(context)[0]
    actuator = plant.get_joint_actuator(plant.GetJointActuatorIndices()[0])
    return data.qacc[0] * INERTIA, drake * INERTIA, actuator.default_gear_ratio(), actuator.default_rotor_inertia()


for options, control, expected in (
    ("", 1.0, (1.0, 1.0, 1.0, 0.1)),
    ('gear="10"', 1.0, (10.0, 1.0, 10.0, 0.001)),
    ('gear="10" forcerange="-1 1"', 50.0, (10.0, 1.0, 10.0, 0.001)),
):
    found = torques(options, control)
    print(f"<motor {options:27}/> control {control:4g}: MuJoCo {found[0]:.6g} N m, Drake {found[1]:.6g} N m, "
          f"gear ratio {found[2]:g}, rotor {found[3]:g} kg m^2")
    if any(abs(f - e) > 1e-9 for f, e in zip(found, expected)):
        raise SystemExit(f"changed: expected {expected}")
PY
