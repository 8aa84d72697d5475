#!/usr/bin/env bash
# Pinocchio's appendModel joins two models and leaves the armature of both behind.
#
# One would guess: the joints of the result are the joints of the two with all that belongs to them, as buildReducedModel
# keeps it, so that an arm with a gripper appended moves as the two did, and joining a model to an empty one changes nothing.
# What happens: limits, damping, dry friction, rotor inertia and gear ratio are taken over; armature is zero at every joint,
# also at those of the first model, which merely got a neighbour, and nothing is said of it. Of these vectors armature is the
# one that aba, rnea and crba count.
# Seen with: pin 4.1.0, numpy 2.4.6; pendulum of 0.26 kg m^2 with armature 0.1 kg m^2, another with 0.2 kg m^2 at its end:
#   armature [0 0], damping [0.3 0.4], friction [0.5 0.6]; acceleration of the upper one under 1 N m when both hang:
#   built joint by joint 0.73295, joined 3.35052 rad/s^2
# Why it matters: arm and hand are modelled and identified apart and joined for the comparison. Rotors are most of the inertia
# of a geared arm; without them the joined model is light, which looks like a wrong mass of the hand.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" \
    pin==4.1.0 libpinocchio==4.1.0 coal==3.0.3 libcoal==3.0.3 eigenpy==3.13.0 numpy==2.4.6
cd "$folder"
FOLDER="$folder/site" PYTHONNOUSERSITE=1 python3 - <<'PY'
import os
import site

site.addsitedir(os.environ["FOLDER"])
import numpy as np
import pinocchio as pin

print("Pinocchio", pin.__version__)
BAR = pin.Inertia(1.0, np.array([0.0, 0.0, -0.5]), 0.01 * np.eye(3))
END = pin.SE3(np.eye(3), np.array([0.0, 0.0, -1.0]))
LOSSES = {"armature": (0.1, 0.2), "damping": (0.3, 0.4), "friction": (0.5, 0.6), "rotorInertia": (0.7, 0.8)}


def chain(joints):
    """A chain of bars with the losses of these joints."""
    model, parent = pin.Model(), 0
    for joint in joints:
        place = END if parent else pin.SE3.Identity()
        parent = model.addJoint(parent, pin.JointModelRY(), place, f"joint {joint}")
        model.addJointFrame(parent)
        model.appendBodyToJoint(parent, BAR, pin.SE3.Identity())
    for name, values in LOSSES.items():
        setattr(model, name, np.array([values[joint] for joint in joints]))
    return model


def accelerations(model):
    return pin.aba(model, model.createData(), np.zeros(2), np.zeros(2), np.array([1.0, 0.0]))


upper, lower, whole = chain([0]), chain([1]), chain([0, 1])
joined = pin.appendModel(upper, lower, upper.getFrameId("joint 0"), END)
kept = {name: np.array(getattr(joined, name)) for name in LOSSES}
print("joined:", ", ".join(f"{name} {values}" for name, values in kept.items()))
# Of the two hanging bars by hand, kg m^2: centres of mass at 0.5 and 1.5 m of the upper joint, 0.5 m of the lower.
bars = np.array([[0.26 + 0.01 + 1.5**2, 0.01 + 0.5 * 1.5], [0.01 + 0.5 * 1.5, 0.26]])
right, light = (np.linalg.solve(inertia, [1.0, 0.0]) for inertia in (bars + np.diag(LOSSES["armature"]), bars))
built, found = accelerations(whole), accelerations(joined)
for what, which in (("by hand", right), ("built joint by joint", built), ("by hand, no armature", light), ("joined", found)):
    print(f"{what:20} {which} rad/s^2")
if not np.allclose(built, right, rtol=0, atol=1e-12):
    raise SystemExit("changed: the chain that was built joint by joint does not have the inertia of its rotors")
if np.any(kept.pop("armature") != 0.0) or not np.allclose(found, light, rtol=0, atol=1e-12):
    raise SystemExit("changed: appendModel no longer leaves armature behind")
if any(not np.array_equal(values, LOSSES[name]) for name, values in kept.items()):
    raise SystemExit("changed: appendModel leaves more than armature behind")
PY
