#!/usr/bin/env bash
# Pinocchio's reader of MJCF counts a joint's limits from its "ref", and its positions not.
#
# One would guess: the range of a joint is in the coordinate that the model is moved by, whatever "ref" says is the drawn pose.
# What happens: the coordinate is MuJoCo's (the drawn pose is q = ref in both), but both limits are lower by ref, so that a pose
# within the range may be out of it, or the drawn pose itself.
# Seen with: pin 4.1.0, mujoco-core 4.0.0, numpy 2.4.6; ref="50" range="-40 90" (degrees):
#   turn of the body at q = 1: 0.127335 rad in both (1 rad less 50 degrees); limits in degrees: MuJoCo -40 … 90, Pinocchio -90 … 40
# Why it matters: planners and solvers that keep to the limits refuse poses of the real range, and take others for allowed.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" \
    pin==4.1.0 libpinocchio==4.1.0 coal==3.0.3 libcoal==3.0.3 eigenpy==3.13.0 numpy==2.4.6 mujoco-core==4.0.0
cd "$folder"
FOLDER="$folder/site" PYTHONNOUSERSITE=1 python3 - <<'PY'
import os
import site
from pathlib import Path

site.addsitedir(os.environ.get("FOLDER", "."))
import mujoco
import numpy as np
import pinocchio

print("Pinocchio", pinocchio.__version__, " MuJoCo", mujoco.__version__)
REF = np.radians(50.0)
MODEL = """<mujoco><worldbody><body name="arm"><joint name="pivot" axis="0 0 1" ref="50" range="-40 90"/>
<geom type="sphere" size=".1" mass="3"/></body></worldbody></mujoco>"""

Path("model.xml").write_text(MODEL)
theirs, found = mujoco.MjModel.from_xml_string(MODEL), pinocchio.buildModelFromMJCF("model.xml")
state, data, q = mujoco.MjData(theirs), found.createData(), np.array([1.0])
state.qpos[:] = q
mujoco.mj_kinematics(theirs, state)
pinocchio.forwardKinematics(found, data, q)
turns = [float(np.arctan2(r[1, 0], r[0, 0])) for r in (state.xmat[1].reshape(3, 3), data.oMi[1].rotation)]
limits = np.degrees([theirs.jnt_range[0], [found.lowerPositionLimit[0], found.upperPositionLimit[0]]])
print(f"turn at q = 1: MuJoCo {turns[0]:.6f}, Pinocchio {turns[1]:.6f} rad")
print(f"limits in degrees: MuJoCo {limits[0]}, Pinocchio {limits[1]}")
if not np.allclose(turns, 1.0 - REF):
    raise SystemExit("changed: the coordinate is no longer counted alike")
if not np.allclose(limits[0], [-40.0, 90.0]):
    raise SystemExit("changed: MuJoCo's range")
if not np.allclose(limits[1], [-90.0, 40.0]):
    raise SystemExit("changed: Pinocchio's limits are no longer lower by ref")
PY
