"""A hand that lets go late and a sensor that is late add up: one sensor shows their sum, two show which of them was late."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from simulated_recordings import nominal, recording

from harness.diagnose.answer.findings import in_words, rivals_of
from harness.diagnose.claims.conclude import _adding_up
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis

TIME = 0.01 * np.arange(400)
ANGLE = np.cos(6.0 * TIME)


def told(channels: dict[str, Any], *claimed: str) -> set[str]:
    system, read = nominal(), recording("run", TIME, channels)
    every = candidates(system, [read])
    members = tuple(c for name in claimed for c in every if c.effect.name == name and c.site == "pivot.position")
    assert len(members) == len(claimed)
    outcome: Any = SimpleNamespace(
        problem=SimpleNamespace(channels=read.channels), study=SimpleNamespace(candidates=every)
    )
    best: Any = SimpleNamespace(hypothesis=Hypothesis(members))
    return {c.key for c in _adding_up(outcome, best, 0)}


def test_any_part_of_the_waiting_may_be_the_only_sensors() -> None:
    assert told({"pivot.position": ANGLE}, "late_release") == {"sensor_delay@pivot.position"}


def test_two_sensors_show_which_of_them_is_late() -> None:
    assert told({"pivot.position": ANGLE, "pivot.velocity": np.gradient(ANGLE, TIME)}, "late_release") == set()


def test_what_is_told_already_or_does_not_wait_adds_nothing() -> None:
    assert told({"pivot.position": ANGLE}, "late_release", "sensor_delay") == set()
    assert told({"pivot.position": ANGLE}, "sensor_lowpass") == set()


def test_rivals_keep_the_spelling_of_their_sites_in_a_sentence() -> None:
    found = {
        "indistinguishable_from": ["late_release", "sensor_gain@joint_1.position"],
        "only_beside": {"late_release": ["base_tilt@base"]},
    }
    assert rivals_of(found, in_words) == ["late release (beside base tilt at base)", "sensor gain at joint_1.position"]
