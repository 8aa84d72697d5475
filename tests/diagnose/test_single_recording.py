"""Of a single recording the last part is held out; sensors and bases have gone on since the first part began.

What goes by the time (a drift, a shaken base), what acts at the beginning alone (a late release), and what a sensor remembers must
be taken as going on in the last part. The pendulum is integrated by SciPy; the sensors are written out below.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import butter, lfilter, lfilter_zi
from simulated_recordings import COM, MASS, Rig, nominal, recording, swing

from harness import diagnose
from harness.diagnose.problem.problem import pose
from harness.recording import Recording

INTERVAL, NOISE, FINE = 0.005, 1e-3, 5
AMPLITUDE, FREQUENCY, PHASE = 0.25, 2.3, 0.7  # of the shaken base [m/s², Hz, rad]
RATE = 0.002  # of the drift [rad/s]


def _shaken(t: float, q: float, v: float) -> float:
    # The base's acceleration along x, on a link that hangs along −z and turns about y.
    return float(-MASS * COM * np.cos(q) * AMPLITUDE * np.sin(2.0 * np.pi * FREQUENCY * t + PHASE))


def _recording(number: int, angle: float, what: str) -> Recording:
    rig = Rig(viscous=0.003, torque=_shaken) if what == "shaken" else Rig(viscous=0.003)
    fine = np.arange(0.0, 16.0, INTERVAL / FINE)
    course = swing(rig, angle, fine)
    if what == "filtered":
        # A low-pass that has settled on the angle of release, and a high-pass that is switched on then (bilinear).
        low, high = butter(1, 4.0, fs=FINE / INTERVAL), butter(1, 0.05, "highpass", fs=FINE / INTERVAL)
        course = lfilter(*low, course, zi=lfilter_zi(*low) * course[0])[0]
        course = lfilter(*high, course)
    if what == "forgotten":
        course = lfilter(*butter(1, 0.1, "highpass", fs=FINE / INTERVAL), course)
    if what == "drifting":
        course = course + RATE * fine
    time = fine[::FINE]
    seen = course[::FINE] + NOISE * np.random.default_rng(number).standard_normal(len(time))
    return recording(f"run{number}", time, {"pivot.position": seen})


@pytest.mark.parametrize(
    ("what", "effect", "values"),
    [
        ("drifting", "sensor_drift", {"rate": RATE}),
        ("shaken", "base_excitation", {"amplitude": AMPLITUDE, "frequency": FREQUENCY, "phase": PHASE}),
        ("forgotten", "sensor_highpass", {"cutoff": 0.1}),
    ],
)
def test_what_goes_by_the_time_goes_on_in_the_part_held_out(what: str, effect: str, values: dict[str, float]) -> None:
    found = diagnose([_recording(1, 1.2, what)], model=nominal())
    assert found.verdict == "explained"
    told = {finding["effect"]: finding["parameters"] for finding in found.findings}
    assert set(told) == {"viscous_damping", effect}
    for name, value in values.items():
        assert abs(told[effect][name]["value"] - value) < max(4.0 * told[effect][name]["std"], 1e-3 * abs(value)), name


def test_two_filters_whose_beginning_was_left_out() -> None:
    # The first moments are taken for carried, since the low-pass has yet to catch up: what both filters then know of the time
    # before is every recording's own, and estimated together.
    found = diagnose([_recording(k, angle, "filtered") for k, angle in enumerate((1.4, -0.9))], model=nominal())
    assert found.verdict == "explained"
    told = {finding["effect"]: finding["parameters"] for finding in found.findings}
    assert set(told) == {"viscous_damping", "sensor_highpass", "sensor_lowpass"}
    # A bilinear filter is off by (π f T)²/3 at most, here less than 1e-4.
    assert told["sensor_lowpass"]["cutoff"]["value"] == pytest.approx(4.0, rel=0.01)
    assert told["sensor_highpass"]["cutoff"]["value"] == pytest.approx(0.05, rel=0.05)


def test_the_last_part_is_dated_from_the_beginning() -> None:
    whole = _recording(1, 1.2, "plain")
    problem = pose(nominal(), [whole])
    (first,), (last,) = problem.train, problem.heldout
    assert first.date(0) == 0.0
    assert last.date(0) == pytest.approx(last.time[0] - first.time[0])
    assert last.date(-1) == pytest.approx(whole.time[-1], abs=last.interval * last.averaged)
