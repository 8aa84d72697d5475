"""What is left when the best hypothesis has been fitted: is it more than noise, and what does it look like as a force?

A force that nobody has a law for still shows: the response of the channels to small generalized forces that depend on
position and velocity (the same in every recording), or that act for a short time only (different in each), is linear. Such
responses are projected off everything the hypothesis may adjust and held against the residual. What is asked is a file each
(``checks/``), at a chance of 1e-5 each. A loud stretch counts only if its samples follow one another, and only beyond what rounding
could make: noise of real sensors has tails, grows with speed, and a motor is switched on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.diagnose.criticism.check import Asked, Check, Form, Map, Remainder, Test
from harness.diagnose.criticism.checks.catalogue import checks
from harness.diagnose.criticism.constants import COMPLETE_RESIDUAL_RATIO, SLOW_NOISE_RATIO, TEST_CHANCE
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.selection.study import Study
from harness.parallel import meanwhile


def above_floor(level: float, likelihood: Likelihood) -> bool:
    """Whether what is left of data held out, over the noise, is more than a complete model leaves of readings so rounded."""
    return bool(level > COMPLETE_RESIDUAL_RATIO * np.sqrt(likelihood.rounded))


def slower_than_scatter(likelihood: Likelihood) -> bool:
    """Whether what passes for noise of a channel is far more than its readings scatter: it may be a force that is left out."""
    own = crude_colours(likelihood.problem)
    return any(c.std > SLOW_NOISE_RATIO * o.std for c, o in zip(likelihood.colours, own, strict=True))


@dataclass(frozen=True, eq=False)
class Remains:
    """Answer of the tests: significant or not, the tests, the cost still to be had, form and map of the force."""

    significant: bool
    tests: tuple[Test, ...]
    excess: float
    form: Form | None = None
    force_map: Map | None = None


def asked_of(*asked: Asked) -> list[Check]:
    """The checks that are asked of that."""
    return [check for check in checks().values() if check.asked in asked]


def examine(left: Remainder, *asked: Asked) -> Remains:
    """The checks of what a fit leaves: whether any speaks against noise alone, and as what force it shows at one joint."""
    found = answers(left, asked_of(*(asked or (Asked.OF_EVERY_FIT,))))
    tests = tuple(test for _, test in found)
    counting = [(check, test) for check, test in found if test.chance < TEST_CHANCE]
    excess = max([0.0, *(check.leaves(test) for check, test in counting)])
    form, force_map = _force([test for _, test in counting], tests)
    return Remains(bool(counting), tests, excess, form, force_map)


def answers(left: Remainder, asked: Sequence[Check]) -> list[tuple[Check, Test]]:
    """Every test with the check that it is of: those of every joint by itself, joint by joint, and then the others."""
    at_joints = [check for check in asked if check.every_joint]
    joints = left.study.problem.system.joint_names if at_joints else ()
    found = [pair for joint in joints for pair in _answers(left.at_joint(joint), at_joints)]
    return found + _answers(left, [check for check in asked if not check.every_joint])


def _answers(left: Remainder | None, asked: Sequence[Check]) -> list[tuple[Check, Test]]:
    if left is None:
        return []
    begun = {check.name: meanwhile(left.predictor.threads, _tests, check, left) for check in asked if check.aside}
    made = {check.name: _tests(check, left) for check in asked if not check.aside}
    # Made before the other thread's are waited for.
    return [(c, test) for c in asked for test in (made[c.name] if c.name in made else begun[c.name]())]


def _tests(check: Check, left: Remainder) -> list[Test]:
    return list(check.ask(left))


def _force(counting: Sequence[Test], tests: Sequence[Test]) -> tuple[Form | None, Map | None]:
    """Form and map of a force over the state, at the joint where one of that kind counts for most."""
    mapped = [test for test in counting if test.force_map is not None]
    if not mapped:
        return None, None
    joint = min(reversed(mapped), key=lambda test: test.chance).where[0]
    form = next((test.form for test in tests if test.form is not None and test.where[0] == joint), None)
    drawn = [test.force_map for test in mapped if test.where[0] == joint][-1]
    return form, drawn() if drawn is not None else None


def excess(study: Study, best: Fit, remains: Remains) -> float:
    """What a set leaves above the noise, by the tests of the remainder or by all of its cost."""
    everywhere = float(np.sqrt(best.linear.cost / max(study.samples, 1.0)))
    return max(remains.excess, (everywhere**2 - COMPLETE_RESIDUAL_RATIO**2) * study.samples)
