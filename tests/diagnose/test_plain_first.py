"""Laws that a recording does not part are all told, the plain ones first, whichever of them happens to fit best."""

from __future__ import annotations

from typing import Any

import numpy as np
from simulated_recordings import nominal, recording

from harness.diagnose.answer.claims_as_data import plainer_rivals, rivals_as_data
from harness.diagnose.answer.explain import finding_words
from harness.diagnose.claims.conclude import Claim
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.problem.candidates import candidates

TIME = 0.01 * np.arange(400)


def claim(effect: str, *rivals: str, beside: dict[str, tuple[str, ...]] | None = None) -> Claim:
    every: dict[str, Any] = {}
    read = recording("run", TIME, {"pivot.position": np.cos(6.0 * TIME)})
    for candidate in candidates(nominal(), [read]):
        every.setdefault(candidate.effect.name, candidate)
    others = tuple(every[name] for name in rivals)
    return Claim(every[effect], 0, 40.0, 3.0, 33.0, tuple(c.key for c in others), others, beside or {}, 0.9, 0.95)


def test_a_delay_comes_before_what_also_forgets() -> None:
    found = claim("sensor_lowpass", "sensor_gain", "late_release", "sensor_delay")
    assert [c.effect.name for c in plainer_rivals(found)] == ["sensor_gain", "sensor_delay", "late_release"]
    assert rivals_as_data(found)["indistinguishable_from"] == ["sensor_gain", "sensor_delay", "late_release"]


def test_plain_dry_friction_comes_before_its_kin() -> None:
    assert [c.effect.name for c in plainer_rivals(claim("dahl_friction", "coulomb_friction"))] == ["coulomb_friction"]
    assert not plainer_rivals(claim("coulomb_friction", "dahl_friction", "stribeck_friction"))


def test_what_sits_elsewhere_or_needs_something_beside_it_does_not_lead() -> None:
    assert not plainer_rivals(claim("late_release", "base_tilt"))
    held = claim("late_release", "sensor_delay", beside={"sensor_delay@pivot.position": ("base_tilt@base",)})
    assert not plainer_rivals(held)


def test_the_sentence_names_all_of_them() -> None:
    cutoff = {"cutoff": Estimate(29.0, 9.9, 9.6, 48.4)}
    said = finding_words(
        "sensor low-pass", "pivot.position", cutoff, {"cutoff": "Hz"}, (), ["sensor delay", "late release"]
    )
    assert (
        said
        == "sensor delay, late release or sensor low-pass at pivot.position (the last fits best: cutoff 29.0 ± 9.9 Hz)"
    )
    said = finding_words("late release", "pivot.position", {}, {}, (), ["sensor delay"])
    assert said == "sensor delay or late release at pivot.position (the latter fits best)"
