#!/usr/bin/env bash
# Newton's reader of MJCF puts all the joints of a body where the first one is.
#
# One would guess: each <joint> of a body turns about its own pos, as in MuJoCo; or a body whose joints are apart is refused, or
# read with a warning, as the same reader warns of much that it leaves out.
# What happens: the joints of a body become one joint of several axes with one anchor, that of the first in the file; the pos of
# the others is dropped without a word.
# Seen with: newton 1.8.0, warp-lang 1.19.0, mujoco-core 4.0.0, numpy 2.4.6; hinges x at the origin of a body and y 0.2 m above,
#   the second one at pi/2, origin of the body in MuJoCo / Newton: x first (-0.2, 0, 0.2) / (0, 0, 0) m,
#   y first (0, 0, 0) / (0, 0.2, 0.2) m; the first one at pi/2, or both hinges at one place: alike
# Why it matters: hips, wrists and gimbals with an offset are written that way. The moved axis changes lengths, weight torques and
# inertias, and looks like a wrong dimension of the mechanism.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --no-deps --target "$folder/site" \
    newton==1.8.0 warp-lang==1.19.0 mujoco-core==4.0.0 numpy==2.4.6
cd "$folder"
# Newton's kernels are compiled when they are first used, which takes half a minute.
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" WARP_CACHE_PATH="$folder/kernels" python3 - <<'PY'
import warnings
from importlib.metadata import version

import mujoco
import numpy as np
import warp

warp.config.log_level = warp.LOG_ERROR
import newton

print("Newton", version("newton"), " MuJoCo", mujoco.__version__)
X, Y, X_ABOVE = ('<joint name="x" axis="1 0 0"/>', '<joint name="y" axis="0 1 0" pos="0 0 0.2"/>',
                 '<joint name="x" axis="1 0 0" pos="0 0 0.2"/>')


def origins(joints, angles):
    """Where the body's origin is [m] in MuJoCo and Newton, and what Newton warned of."""
    text = (f'<mujoco><worldbody><body name="b">{joints}<inertial mass="1.5" pos="0.1 0 -0.4" diaginertia="0.02 0.03 0.01"/>'
            "</body></worldbody></mujoco>")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[:] = angles
    mujoco.mj_forward(model, data)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        builder = newton.ModelBuilder()
        builder.add_mjcf(text)
        read = builder.finalize(device="cpu")
    state = read.state()
    newton.eval_fk(read, warp.array(angles, dtype=float, device="cpu"), read.joint_qd, state)
    return data.xpos[1].copy(), state.body_q.numpy()[0, :3], len(told)


QUARTER = float(np.pi / 2)
for label, joints, angles, right, seen in (
    ("x first, y at pi/2", X + Y, [0.0, QUARTER], (-0.2, 0, 0.2), (0, 0, 0)),
    ("y first, x at pi/2", Y + X, [0.0, QUARTER], (0, 0, 0), (0, 0.2, 0.2)),
    ("y first, y at pi/2", Y + X, [QUARTER, 0.0], (-0.2, 0, 0.2), (-0.2, 0, 0.2)),
    ("both above, x at pi/2", Y + X_ABOVE, [0.0, QUARTER], (0, 0.2, 0.2), (0, 0.2, 0.2)),
):
    first, second, told = origins(joints, angles)
    print(f"{label:21}: MuJoCo {first.round(4) + 0.0}, Newton {second.round(4) + 0.0} m, warnings {told}")
    if np.abs(first - right).max() > 1e-9 or np.abs(second - seen).max() > 1e-5 or told:
        raise SystemExit(f"changed: seen before {right} and {seen} m, without a warning")
PY
