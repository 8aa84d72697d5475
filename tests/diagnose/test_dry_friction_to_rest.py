"""Swings with dry friction that come to rest while recorded: motion has kinks there, and a window may end on the wrong side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, releases

import harness
from harness.diagnose.estimation.least_squares import fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.estimation.objective import Objective
from harness.diagnose.estimation.window_states import measured_state
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import cut

NOISE = 1e-3
VISCOUS, DRY = 1.2e-3, 9e-3  # N·m·s/rad, N·m; the pendulum's gravity moment is 0.74 N·m


def test_damping_and_dry_friction_are_both_named_and_measured() -> None:
    # Coulomb friction contains no speed at which it falls; a law that has one fits as well and must not be named for it.
    runs = releases(Rig(viscous=VISCOUS, dry=DRY), (1.4, 0.8, 1.1), NOISE, 20, duration=14.0)
    document = harness.diagnose(runs, model=nominal()).to_json()
    assert document["verdict"] == "explained", document["summary"]
    found = {f["effect"]: f["parameters"] for f in document["findings"]}
    assert set(found) == {"viscous_damping", "coulomb_friction"}
    for effect, parameter, true in (
        ("viscous_damping", "coefficient", VISCOUS),
        ("coulomb_friction", "torque", DRY),
    ):
        value = found[effect][parameter]
        assert abs(value["value"] - true) < 4.0 * value["std"]
        assert value["std"] < 0.05 * true


@pytest.mark.parametrize("rescued", [False, True])
def test_a_window_that_begins_at_rest_in_vain_is_brought_back(rescued: bool) -> None:
    runs = releases(Rig(viscous=VISCOUS, dry=DRY), (1.4, 0.8), NOISE, 21, duration=10.0)
    system = replace(nominal(), tolerance=0.01)
    known = candidates(system, runs, only=("viscous_damping", "coulomb_friction"))
    problem = pose(system, runs)
    predictor = Predictor(problem)
    likelihood = Likelihood(problem, (Colour(NOISE, interval=problem.train[0].interval),))
    windows = cut(problem.runs, range(len(problem.runs)), 1.3)
    hypothesis = Hypothesis(tuple(sorted(known, key=lambda c: c.effect.name)))
    true = {"viscous_damping": VISCOUS, "coulomb_friction": DRY}
    x = np.concatenate(
        [
            np.zeros(len(predictor.nominal)),
            *(to_internal(c, np.array([true[c.effect.name]])) for c in hypothesis.members),
        ]
    )
    read = {w: measured_state(problem, predictor, w) for w in windows}
    # One window in the middle of a swing is begun at rest where dry friction holds the pendulum: nothing that it then predicts
    # depends on how it was begun.
    astray = dict(read)
    astray[windows[2]] = np.array([1e-3, 0.0])
    found = fit(
        Objective(predictor, likelihood, hypothesis, windows),
        x,
        astray,
        others=[read] if rescued else (),
        most_steps=20,
    )
    # Sum of squares of unit normal numbers, within five standard deviations; without help the one window costs more than all.
    count = likelihood.samples(windows)
    assert (found.cost < count + 5.0 * np.sqrt(2.0 * count)) == rescued
