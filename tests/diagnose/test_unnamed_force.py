"""A force that the catalogue has no law for must not be told as an effect that happens to imitate it."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import COM, GRAVITY, INERTIA, MASS, Rig, nominal, releases

import harness
from harness.diagnose.criticism.check import Test as Question

SWING = float(np.sqrt(MASS * GRAVITY * COM / (INERTIA + MASS * COM**2)))  # rad/s
FED = 3e-4 * (INERTIA + MASS * COM**2) * SWING
TURNS_AT = 0.27  # rad, where feeding turns to braking


def test_an_unnamed_force_is_charged_for_its_terms_and_for_having_been_chosen() -> None:
    # Bayesian criterion: two amplitudes, one of 210 pairs of 21 terms.
    question = Question("a force of few terms", 100.0, 2, 0.0, choices=210.0)
    assert question.price(1000.0) == pytest.approx(2.0 * np.log(1000.0) + 2.0 * np.log(210.0))


def test_negative_damping_is_not_told_as_a_shaken_base() -> None:
    # Van der Pol: small swings are fed, large ones braked.
    rig = Rig(torque=lambda t, q, v: FED * (1.0 - (q / TURNS_AT) ** 2) * v)
    runs = releases(rig, (0.6, -0.5), 1e-3, 5, duration=13.0, rate=125.0)
    found = harness.diagnose(runs, model=nominal(tolerance=0.01))
    assert [finding["effect"] for finding in found.findings] == []
    assert found.verdict == "unexplained"
    rivals = {" + ".join(row["effects"]): row["lost"] for row in found.ranking}
    assert any("imitated" in lost for effects, lost in rivals.items() if "base_excitation@base" in effects), rivals
