#!/usr/bin/env bash
# asammdf's get(raster=...) takes too long a step where the recording is a whole number of steps long.
#
# One would guess: get(name, raster=0.1) gives samples 0.1 s apart, as resample(0.1) and to_dataframe(raster=0.1) do.
# What happens: where the duration is no multiple of the step, it does. Where it is, there is one sample too few: the same span
# is cut into one step fewer, and every step is longer by one part in that number.
# Seen with: asammdf 8.8.28, numpy 2.4.6; sine of 2 Hz, 10 s at 1 kHz, written as MDF 4.10 and read again; step in s:
#   raster        0.1      0.01     0.03
#   get           0.10101  0.01001  0.03
#   resample      0.1      0.01     0.03
# Why it matters: recordings are cut to whole seconds. Who asks for the samples and takes the step for granted finds the
# frequency 1 % too high at a step of 0.1 s, and beside a channel from resample a delay that grows to a whole step.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" asammdf==8.8.28 numpy==2.4.6
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
import asammdf
import numpy as np

print("asammdf", asammdf.__version__)
DURATION, FREQUENCY = 10.0, 2.0
time = np.arange(10_001) / 1000.0
with asammdf.MDF(version="4.10") as written:
    written.append([asammdf.Signal(np.sin(2 * np.pi * FREQUENCY * time), time, name="angle", unit="rad")])
    written.save("run.mf4")
recording = asammdf.MDF("run.mf4")


def heard(samples, step):
    """Frequency [Hz] of the samples, taken to be ``step`` apart: that of the sine that fits them best."""
    count = np.arange(len(samples)) * step
    tried = np.linspace(1.9, 2.1, 2001)
    left = [np.linalg.lstsq(np.c_[np.sin(w * count), np.cos(w * count)], samples)[1][0] for w in 2 * np.pi * tried]
    return tried[np.argmin(left)]


for raster, longer in ((0.1, True), (0.01, True), (0.03, False)):
    got, again = recording.get("angle", raster=raster), recording.resample(raster).get("angle")
    steps = [np.diff(signal.timestamps).mean() for signal in (got, again)]
    tones = [heard(signal.samples, raster) for signal in (got, again)]
    print(f"raster {raster:4}: get {len(got):4} samples {steps[0]:.6f} s apart, sounds like {tones[0]:.4f} Hz; "
          f"resample {len(again):4} samples {steps[1]:.6f} s apart, {tones[1]:.4f} Hz")
    expected = DURATION / (round(DURATION / raster) - 1) if longer else raster
    if not np.allclose(steps, [expected, raster], rtol=0, atol=1e-9):
        raise SystemExit(f"changed: expected {expected} s from get and {raster} s from resample")
    if not np.allclose(tones, [FREQUENCY * expected / raster, FREQUENCY], rtol=0, atol=2e-3):
        raise SystemExit("changed: the frequencies are not those of these steps")
PY
