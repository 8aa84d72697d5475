"""Errors of a known shape that may be what a fit leaves, though no law of the catalogue is."""

from __future__ import annotations

from harness.diagnose.criticism.doubt import LEVEL
from harness.diagnose.criticism.remainder import examine
from harness.diagnose.criticism.vertical_shaking import shaken_up_and_down
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.linear_response import responsive
from harness.diagnose.selection.model_error import KnownError
from harness.diagnose.selection.study import Study
from harness.effects.scale import references


def structures(study: Study, fitted: Fit) -> list[KnownError]:
    """What each test of the remainder that names an error would gain, acting alike in all recordings or in each by itself."""
    system = study.problem.system
    torques = [references(system, joint).torque for joint in system.joint_names]
    tests = examine(study.predictor, study.likelihood, fitted, system.joint_names, torques, study.swing, LEVEL).tests
    # A support that moves up and down has a frequency to be looked for, and channels that answer linearly.
    tests = (*tests, *([shaken_up_and_down(study, fitted)] if responsive(study.predictor) else []))
    named = [t for t in tests if t.places >= 0]
    alike = [KnownError(t.gain, t.size + t.places, t.choices) for t in named]
    return alike + [KnownError(t.together[0], t.together[1] * (1 + t.places)) for t in named if t.together[1]]
