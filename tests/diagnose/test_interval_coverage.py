"""Intervals of 95 % hold the truth as often as they say: with a model off within its tolerance, at a bound, beside misjudged noise.

Truths are drawn anew for every recording; what the counts and squares are held against is the binomial and the chi-squared
distribution at one in a thousand either way.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binom, chi2
from simulated_recordings import COM, INERTIA, MASS, Rig, nominal, recording, swing

from harness.diagnose.estimation.intervals import Estimate, estimates
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.profile_likelihood import profiled
from harness.diagnose.selection.study import Study

TOLERANCE, NOISE, DRAWS, RARE = 0.01, 2e-3, 40, 1e-3
TIME = np.arange(0.0, 6.0, 0.02)


def fitted(dry: float, viscous: float, seed: int, *, stated_noise: float = NOISE) -> dict[str, dict[str, Estimate]]:
    """Estimates of damping and dry friction from two swings of a rig that is off its data sheet as its tolerance says."""
    rng = np.random.default_rng([seed, 4021])
    heavy, long, wide = np.exp(TOLERANCE * rng.standard_normal(3))
    rig = Rig(mass=MASS * heavy, com=COM * long, inertia=INERTIA * heavy * wide, viscous=viscous, dry=dry)
    runs = [
        recording(f"run{k}", TIME, {"pivot.position": swing(rig, a, TIME) + NOISE * rng.standard_normal(len(TIME))})
        for k, a in enumerate((0.9, -0.6))
    ]
    system = nominal(TOLERANCE)
    posed = pose(system, runs)
    known = tuple(candidates(system, runs, only=["viscous_damping", "coulomb_friction"]))
    colours = (Colour(white=stated_noise, interval=float(TIME[1])),)
    study = Study(posed, Predictor(posed), Likelihood(posed, colours), known, whole(posed.runs, range(2)))
    hypothesis = Hypothesis(known)
    own = [to_internal(c, 0.1 * c.scales) for c in known]
    best = study.fit(hypothesis, [np.concatenate([np.zeros(len(study.predictor.nominal)), *own])], None, most_steps=40)
    return {c.effect.name: profiled(study, best, k, estimates(study.predictor, best, k)) for k, c in enumerate(known)}


def held(found: list[Estimate], truth: float) -> int:
    """How many intervals hold the truth."""
    return sum(e.low <= truth <= e.high for e in found)


def fewest() -> int:
    """Intervals that hold the truth at least, but for one test in a thousand."""
    return int(binom.ppf(RARE, DRAWS, 0.95))


@pytest.mark.parametrize(("stated_noise", "seed"), [(NOISE, 0), (0.5 * NOISE, 1000)], ids=["as stated", "misjudged"])
def test_of_two_laws_at_once(stated_noise: float, seed: int) -> None:
    dry, viscous = 0.002, 0.0008
    found = [fitted(dry, viscous, seed + k, stated_noise=stated_noise) for k in range(DRAWS)]
    for name, parameter, truth in (("coulomb_friction", "torque", dry), ("viscous_damping", "coefficient", viscous)):
        own = [f[name][parameter] for f in found]
        assert held(own, truth) >= fewest()
        squares = sum(((e.value - truth) / (e.std or np.nan)) ** 2 for e in own)
        # Neither too narrow nor too wide.
        assert chi2.ppf(RARE, DRAWS) < squares < chi2.ppf(1.0 - RARE, DRAWS)


def test_where_the_truth_lies_at_a_bound() -> None:
    viscous = 0.0008
    found = [fitted(0.0, viscous, 2000 + k) for k in range(DRAWS)]
    dry = [f["coulomb_friction"]["torque"] for f in found]
    assert held(dry, 0.0) >= fewest()
    # Estimates end at the bound about every other time; the interval is then one-sided.
    assert 0 < sum(e.std is None for e in dry) < DRAWS
    assert all(e.high > 0.0 for e in dry)
    assert held([f["viscous_damping"]["coefficient"] for f in found], viscous) >= fewest()
