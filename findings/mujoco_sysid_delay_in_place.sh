#!/usr/bin/env bash
# mujoco.sysid's apply_delay changes the recording that it is given; apply_gain and apply_bias return a changed copy.
#
# One would guess: all three modifiers of a time series take one and return another, so that a residual may call them with
# new parameters at every evaluation.
# What happens: apply_delay writes into the data of its argument. Called twice with 0.1 s on one series, the second result is
# late by 0.2 s, and the recording itself has become the delayed one.
# Seen with: mujoco-core 4.0.0, numpy 2.4.6, scipy 1.17.1; a ramp x = t, delay 0.1 s, value at t = 1:
#   recording 1.0; first call 0.9, recording then 0.9; second call 0.8; apply_gain leaves the recording alone
# Why it matters: a delay fitted to measured data shifts them once more at each evaluation; the estimate then depends on how
# many evaluations went before, and a comparison with another tool on the same arrays is spoilt for both.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" \
    'mujoco-core[sysid]==4.0.0' numpy==2.4.6 scipy==1.17.1
cd "$folder"
MPLBACKEND=agg MPLCONFIGDIR="$folder" PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
import mujoco
import numpy as np
from mujoco import sysid

print("MuJoCo", mujoco.__version__)
time = np.linspace(0.0, 1.0, 11)
series = sysid.TimeSeries.from_custom_map(time, time[:, None].copy(), ["x"])
recording = series.data.copy()
gained = sysid.apply_gain(series, "x", sysid.Parameter("gain", 2.0, 0.0, 3.0))
print("apply_gain: value", gained.data[-1, 0], " recording", series.data[-1, 0])
if not np.array_equal(series.data, recording) or not np.allclose(gained.data, 2.0 * recording):
    raise SystemExit("changed: apply_gain changes its argument")
delay = sysid.Parameter("delay", 0.1, 0.0, 1.0)
seen = []
for call in ("first", "second"):
    late = sysid.apply_delay(series, "x", delay)
    seen.append((float(late.data[-1, 0]), float(series.data[-1, 0])))
    print(f"apply_delay, {call} call: value {seen[-1][0]:.3f}, recording {seen[-1][1]:.3f}")
if not np.allclose(seen, [(0.9, 0.9), (0.8, 0.8)], rtol=0, atol=1e-9):
    raise SystemExit("changed: apply_delay no longer changes the recording that it is given")
PY
