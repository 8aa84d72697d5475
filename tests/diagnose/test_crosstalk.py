"""A reading into which another channel leaks is no physics of a joint, and none of its own sensor's errors either."""

from __future__ import annotations

from dataclasses import replace

import pytest
from simulated_recordings import double_pendulum

from harness import diagnose
from harness.recording import Channel, Recording
from harness.system.description import constant

SHARE, NOISE = 0.04, 5e-4
LEAKS = "a reading that another channel leaks into"
NEAREST = ["base_excitation", "sensor_gain", "sensor_nonlinearity", "viscous_damping", "payload_mass"]


def _leaking(run: Recording, share: float) -> Recording:
    shoulder, elbow = run.channels
    mixed: Channel = replace(elbow, values=constant(elbow.values + share * shoulder.values))
    return replace(run, channels=(shoulder, mixed))


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2])
def test_it_is_told_as_what_it_is(count: int) -> None:
    system, runs = double_pendulum(0.0, NOISE, 3)
    found = diagnose([_leaking(run, SHARE) for run in runs[:count]], model=system, only=NEAREST)
    assert found.verdict == "unexplained"
    (left,) = (t for t in found.remainder["tests"] if t["what"] == LEAKS)
    assert left["chance"] < 1e-5
    into, what = left["where"]
    share, _, of = what.split()
    assert (into, of) == ("elbow.position", "shoulder.position")
    # To first order, about a model that has been bent to make up for some of it.
    assert float(share) == pytest.approx(SHARE, rel=0.1)
    assert {(place["side"], place["site"]) for place in found.mismatch} == {("sensor", "elbow.position")}


def test_it_is_not_seen_in_white_noise() -> None:
    system, runs = double_pendulum(0.01, NOISE, 4)
    found = diagnose(runs, model=system, only=NEAREST)
    assert [(f["effect"], f["site"]) for f in found.findings] == [("viscous_damping", "elbow")]
    (left,) = (t for t in found.remainder["tests"] if t["what"] == LEAKS)
    assert left["chance"] > 1e-5
