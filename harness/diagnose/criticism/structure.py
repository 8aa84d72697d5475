"""Whether one error of a known shape explains what a fit leaves, though no law of the catalogue does."""

from __future__ import annotations

from harness.diagnose.criticism.doubt import LEVEL
from harness.diagnose.criticism.remainder import examine
from harness.diagnose.criticism.vertical_shaking import shaken_up_and_down
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.linear_response import responsive
from harness.diagnose.selection.study import Study
from harness.effects.scale import references


def worth_of_structure(study: Study, fitted: Fit) -> float:
    """What the likeliest such error gains in the criterion beyond its price; nothing where none does.

    A linear gain cannot take away more than what is above the noise.
    """
    system = study.problem.system
    torques = [references(system, joint).torque for joint in system.joint_names]
    tests = examine(study.predictor, study.likelihood, fitted, system.joint_names, torques, study.swing, LEVEL).tests
    # A support that moves up and down has a frequency to be looked for, and channels that answer linearly.
    tests = (*tests, *([shaken_up_and_down(study, fitted)] if responsive(study.predictor) else []))
    there = max(fitted.score - study.samples, 0.0)
    worths = [min(t.gain, there) - t.price(study.samples) for t in tests if t.places >= 0]
    worths += [min(t.together[0], there) - t.price_together(study.samples) for t in tests if t.places >= 0]
    return max([0.0, *worths])
