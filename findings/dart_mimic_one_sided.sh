#!/usr/bin/env bash
# A mimic joint that DART reads from a URDF follows its leader, and the leader does not feel it.
#
# One would guess: <mimic joint="a" multiplier="2"/> is a gear: to a torque at joint a the inertia is that of a and four times
# that of b, as in Pinocchio (and in Drake's and MuJoCo's constraints).
# What happens: b is driven by a servo of its own that pushes against nothing: the leader moves as if alone, and a torque at the
# follower does not move the leader at all. With setUseCouplerConstraint(True) both are coupled: the angles are right then, the
# velocities are not.
# Seen with: dartpy 6.20.0, pin 4.1.0, numpy 2.4.6; wheels of 0.1 and 0.05 kg m^2, multiplier 2, no gravity, 1 N m at the leader
#   for 0.2 s: leader 2 rad/s in DART, 0.667 rad/s by Pinocchio and the closed form 0.2 / (0.1 + 4 0.05), at 1 ms and 0.1 ms steps;
#   work done by the motor 0.2 J, energy of the two wheels 0.6 J; 1 N m at the follower: leader 0 rad/s (1.333 is right);
#   coupled both ways, 1 ms steps: leader at 0.068 rad (0.067 is right), 1.46 rad/s (0.667 is right)
# Why it matters: fingers and parallel linkages are written with mimic. Their drive looks three times too light here, and a grasp
# of the follower is not felt by the motor.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" \
    dartpy==6.20.0 pin==4.1.0 libpinocchio==4.1.0 coal==3.0.3 libcoal==3.0.3 eigenpy==3.13.0 numpy==2.4.6
cd "$folder"
FOLDER="$folder/site" PYTHONNOUSERSITE=1 python3 - <<'PY'
import os
import site
from importlib.metadata import version

site.addsitedir(os.environ.get("FOLDER", "."))
import dartpy
import numpy as np
import pinocchio

print("DART", version("dartpy"), " Pinocchio", pinocchio.__version__)
LEADER, FOLLOWER, RATIO, END = 0.1, 0.05, 2.0, 0.2


def link(name, inertia):
    return (f'<link name="{name}"><inertial><mass value="1"/><inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" '
            'ixz="0" iyz="0"/></inertial></link>')


def joint(name, child, inside=""):
    return (f'<joint name="{name}" type="revolute"><parent link="base"/><child link="{child}"/><axis xyz="0 1 0"/>'
            f'<limit lower="-99" upper="99" effort="99" velocity="99"/>{inside}</joint>')


TEXT = ('<robot name="pair">' + link("base", 1) + link("a", LEADER) + link("b", FOLLOWER) + joint("ja", "a")
        + joint("jb", "b", f'<mimic joint="ja" multiplier="{RATIO}" offset="0"/>') + "</robot>")
with open("pair.urdf", "w") as file:
    file.write(TEXT)


def dart_motion(torques, step, coupled=False):
    """Angles [rad] and velocities [rad/s] of leader and follower after END [s] of constant torques [N m], from rest."""
    loader, options = dartpy.utils.DartLoader(), dartpy.utils.DartLoaderOptions()
    options.mDefaultRootJointType = dartpy.utils.DartLoaderRootJointType.FIXED
    loader.setOptions(options)
    skeleton = loader.parseSkeleton(os.path.abspath("pair.urdf"))
    if coupled:
        skeleton.getJoint("jb").setUseCouplerConstraint(True)
    world = dartpy.simulation.World("world")
    world.addSkeleton(skeleton)
    world.setGravity(np.zeros(3))
    world.setTimeStep(step)
    for _ in range(round(END / step)):
        for index, torque in enumerate(torques):
            skeleton.setForce(index, torque)
        world.step()
    return skeleton.getPositions(), skeleton.getVelocities()


model = pinocchio.buildModelFromXML(TEXT, mimic=True)
model.gravity.setZero()
zero = np.zeros(1)
inertia = pinocchio.crba(model, model.createData(), zero)[0, 0]
right = END / (LEADER + RATIO**2 * FOLLOWER)
print(f"leader after 1 N m for {END} s: closed form {right:.4f}, Pinocchio {END / inertia:.4f} rad/s")
if abs(END / inertia - right) > 1e-9:
    raise SystemExit("changed: Pinocchio's inertia is not that of the two wheels")
for step in (1e-3, 1e-4):
    _, found = dart_motion((1.0, 0.0), step)
    energy = 0.5 * (LEADER * found[0] ** 2 + FOLLOWER * found[1] ** 2)
    work = 0.5 * found[0] * END
    print(f"DART, step {step:g} s: leader {found[0]:.4f}, follower {found[1]:.4f} rad/s; work {work:.3f} J, energy {energy:.3f} J")
    if abs(found[0] - END / LEADER) > 1e-6 or abs(found[1] - RATIO * found[0]) > 0.06:
        raise SystemExit("changed: the leader does not move as if alone, or the follower does not follow")
_, found = dart_motion((0.0, 1.0), 1e-3)
print(f"DART, 1 N m at the follower: leader {found[0]:.4f}, follower {found[1]:.4f} rad/s; right: leader {right * RATIO:.4f}")
if abs(found[0]) > 1e-9:
    raise SystemExit("changed: the leader feels a torque at the follower")
angles, found = dart_motion((1.0, 0.0), 1e-3, coupled=True)
print(f"DART, coupled both ways: leader at {angles[0]:.4f} rad (right {0.5 * right * END:.4f}), {found[0]:.4f} rad/s")
if abs(angles[0] - 0.5 * right * END) > 2e-3 or abs(found[0] - right) < 0.1:
    raise SystemExit("changed: coupled both ways the angle is not right, or the velocity is")
PY
