"""How far an experiment would part two hypotheses: what initial states and open parameters make up for does not count."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.experiment.design import propose
from harness.diagnose.experiment.separation import separation
from harness.diagnose.experiment.trials import Trial, trials
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.study import Study

NOISE = 1e-3
SIZES: dict[str, float | tuple[float, ...]] = {
    "base_tilt": 0.02,
    "sensor_offset": 0.02,
    "coulomb_friction": 2e-3,
    "quadratic_drag": 1e-3,
}
SIZES |= {"stribeck_friction": (2e-3, 2.2e-3, 1.0)}
PERIOD = 2.0 * np.pi * np.sqrt(Rig().about_joint / Rig().moment)


def bench(rig: Rig, *names: str) -> tuple[Study, list[Fit]]:
    """A study of two releases, and fits of single effects."""
    system, runs = nominal(), releases(rig, (1.2, 0.8), NOISE, seed=21)
    posed = pose(system, runs)
    known = tuple(candidates(system, runs, only=list(names)))
    study = Study(
        posed,
        Predictor(posed),
        Likelihood(posed, crude_colours(posed)),
        known,
        whole(posed.runs, range(2)),
        swing=PERIOD,
    )
    by_name = {c.effect.name: c for c in known}
    fits = []
    for name in names:
        hypothesis = Hypothesis((by_name[name],))
        own = to_internal(by_name[name], np.atleast_1d(SIZES[name]))
        start = np.concatenate([np.zeros(len(study.predictor.nominal)), own])
        fits.append(study.fit(hypothesis, [start], None, most_steps=30))
    return study, fits


def releases_of(study: Study) -> list[Trial]:
    return [t for t in trials(study.problem.system, "pivot", 12.0, PERIOD, 1.0, 5.0) if t.effort is None and not t.link]


def test_no_release_parts_a_tilted_base_from_a_sensor_s_offset() -> None:
    # On a base that is turned by −α a joint swings about +α (θ̈ = −ω² sin(θ − α)), as a sensor would say that reads α too much.
    study, (tilt, offset) = bench(Rig(), "base_tilt", "sensor_offset")
    # Fitted to a mechanism that has neither, both have to be given a size, one against the other.
    k = len(study.predictor.nominal)
    scale = tilt.hypothesis.members[0].scales[0], offset.hypothesis.members[0].scales[0]
    tilt = replace(tilt, x=np.append(tilt.x[:k], -0.02 / scale[0]))
    offset = replace(offset, x=np.append(offset.x[:k], 0.02 / scale[1]))
    assert max(separation(study, tilt, offset, trial) for trial in releases_of(study)) < 1.0
    told = propose(study, [(tilt, offset, ("base_tilt", "sensor_offset"))])
    assert told is not None
    assert "the base's inclination" in told.what and "the sensor against a reference" in told.what


def test_a_long_release_parts_two_kinds_of_dissipation() -> None:
    # Energy a swing loses goes with its amplitude for dry friction and with its cube for quadratic drag.
    study, (dry, drag) = bench(Rig(dry=2e-3), "coulomb_friction", "quadratic_drag")
    told = propose(study, [(dry, drag, ("coulomb_friction", "quadratic_drag"))])
    assert told is not None and told.separation > 50.0
    assert told.what.startswith("release from")


def test_nothing_parts_a_law_from_one_that_can_be_it() -> None:
    # Stribeck friction whose static torque is the Coulomb torque is Coulomb friction, in any experiment.
    study, (dry, stribeck) = bench(Rig(dry=2e-3), "coulomb_friction", "stribeck_friction")
    cost = np.sqrt(max(dry.score - stribeck.score, 0.0))
    # As long optimisations from trial to trial find, too, as near as they come.
    assert max(separation(study, dry, stribeck, trial) for trial in releases_of(study)[:3]) < 5.0
    names = ("coulomb_friction", "stribeck_friction")
    told = propose(study, [(dry, stribeck, names)])
    assert told is not None and told.separates == names
    assert told.separation == pytest.approx(cost)
    assert "would part them" in told.what and "just sets the joint moving" in told.what
    # The other way round there is something to be told: a stiction that is there cannot be made by Coulomb friction.
    k = len(study.predictor.nominal)
    scale = stribeck.hypothesis.members[0].scales
    sticking = replace(stribeck, x=np.append(stribeck.x[:k], np.array([2e-3, 8e-3, 1.0]) / scale))
    told = propose(study, [(sticking, dry, names[::-1])])
    assert told is not None and told.separation > 5.0


def test_least_only_spares_work() -> None:
    study, (dry, drag) = bench(Rig(dry=2e-3), "coulomb_friction", "quadratic_drag")
    trial = releases_of(study)[4]
    exact = separation(study, dry, drag, trial)
    assert separation(study, dry, drag, trial, least=0.5 * exact) == pytest.approx(exact, rel=1e-6)
    assert separation(study, dry, drag, trial, least=1e6) <= 1e6


def test_a_hypothesis_is_not_parted_from_itself() -> None:
    study, (dry,) = bench(Rig(dry=2e-3), "coulomb_friction")
    assert max(separation(study, dry, dry, trial) for trial in releases_of(study)) < 0.1
