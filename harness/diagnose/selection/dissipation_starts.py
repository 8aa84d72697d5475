"""Seeds of the search that no single effect leads to: the ordinary dissipation of a joint, all of it at once.

Bearings rub, air drags, and what the model states of damping is often a fit to the sum of both. One of these alone explains
little where the stated damping is wrong in sign or size, so a search that adds one effect at a time takes another way.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.prediction.coordinates import start_vector, to_internal
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis, compatible
from harness.diagnose.selection.constants.search import EXTENDING_STEPS
from harness.diagnose.selection.constants.starts import MOST_ORDINARY_JOINTS
from harness.diagnose.selection.multi_start import bent_back
from harness.diagnose.selection.study import Study
from harness.diagnose.selection.wald_test import carried

Array = NDArray[np.float64]

RUBBING = ("viscous_damping", "coulomb_friction")
DISSIPATION = (*RUBBING, "quadratic_drag")
ROTOR = "added_inertia"
PLAIN = (*DISSIPATION, ROTOR)
ZEROS = ("constant_torque", "sensor_offset")
CHANGES = ("payload_mass", "com_offset", "added_inertia", "com_side_offset", "link_inertia")


def ordinary(study: Study, near: Fit) -> list[Fit]:
    """Fits of dry friction with viscous and quadratic drag at each joint that can have them; best first.

    near: a fit whose initial states are begun from.
    """
    found = [_fitted(study, members, near) for names in (RUBBING, DISSIPATION) for members in _by_site(study, names)]
    return sorted(found, key=study.criterion)


def with_one_change(study: Study, near: Fit) -> list[Fit]:
    """Fits of ordinary dissipation at every joint, by itself and beside one thing that is not as drawn; best first.

    A weight, a centre of mass, a rotor: what a bench is changed by first. near: a fit whose initial states are begun from.
    """
    rubbing = _together(study.candidates, RUBBING)
    changes = [c for c in study.candidates if c.effect.name in CHANGES and compatible(rubbing, c)]
    found = [_fitted(study, rubbing.members, near)] if rubbing.members else []
    for change in changes:
        hypothesis = rubbing.with_(change)
        # At each of its usual sizes: one of them is on the right side of a wrong valley.
        sizes = [
            to_internal(change, np.array([v])) for v in change.effect.parameters[0].start_values(change.references)
        ]
        starts = [
            np.concatenate([start[: len(start) - change.size], size])
            for start in _starts(study, hypothesis, near)
            for size in sizes
        ]
        starts += _from(near, hypothesis, starts[0])
        known = study.fits.get(hypothesis.identity)
        fitted = known or study.fit(hypothesis, starts, near, most_steps=EXTENDING_STEPS)
        if rubbing.members and study.stretched(fitted):
            # What was bent for want of the change is still on its way back.
            fitted = bent_back(study, found[0], starts[0], hypothesis, EXTENDING_STEPS)
        found.append(fitted)
    return sorted(found, key=study.criterion)


def everywhere(study: Study, near: Fit) -> Fit | None:
    """The fit of all of that at every joint at once, with a rotor's inertia and a zero: what a plain least-squares fit has.

    None where no joint can have dissipation. near: a fit of those members, or of the nominal model, on windows of the same
    recordings that begin where the study's do.
    """
    near = near.beginning(study.windows)
    if near.hypothesis.members:
        return study.fit(near.hypothesis, [near.x], near)
    found = []
    for zero in ZEROS:
        hypothesis = plain_set(study.candidates, zero)
        if any(m.effect.name in RUBBING for m in hypothesis.members):
            found.append(_fitted(study, hypothesis.members, near))
    return min(found, key=lambda f: f.score, default=None)


def plain_sets(study: Study, further: Sequence[Sequence[str]] = ()) -> list[Hypothesis]:
    """Sets of ordinary laws at every joint, as a plain least-squares fit has them: friction and a zero, and with all that there is
    of dissipation and a rotor's inertia; further: other laws, each with a zero. None where joints are too many for that.

    The zero of an angle shows as what gravity then does, or where there is none as a constant force.
    """
    if len(study.problem.system.movable_joints) > MOST_ORDINARY_JOINTS:
        return []
    found = (plain_set(study.candidates, zero, laws) for zero in ZEROS for laws in (RUBBING, PLAIN, *further))
    return list({hypothesis.identity: hypothesis for hypothesis in found}.values())


def ordinary_everywhere(study: Study, near: Fit) -> list[Fit]:
    """Fits of these sets; near: a fit that states are begun from."""
    return [_fitted(study, hypothesis.members, near) for hypothesis in plain_sets(study) if hypothesis.members]


def plain_set(candidates: Sequence[Candidate], zero: str, laws: Sequence[str] = PLAIN) -> Hypothesis:
    """Ordinary laws at every joint and a zero, as far as they are among candidates and go together; usually all dissipation and a
    rotor's inertia."""
    return _together(candidates, (*laws, zero))


def _together(candidates: Sequence[Candidate], names: Sequence[str]) -> Hypothesis:
    """All candidates of these effects that go together."""
    hypothesis = Hypothesis()
    for candidate in candidates:
        if candidate.effect.name in names and compatible(hypothesis, candidate):
            hypothesis = hypothesis.with_(candidate)
    return hypothesis


def _by_site(study: Study, names: Sequence[str]) -> list[tuple[Candidate, ...]]:
    """Candidates of these effects, for every site that can have them all."""
    by_site: dict[str, dict[str, Candidate]] = {}
    for candidate in study.candidates:
        by_site.setdefault(candidate.site, {})[candidate.effect.name] = candidate
    return [tuple(at[name] for name in names) for at in by_site.values() if all(name in at for name in names)]


def _fitted(study: Study, members: tuple[Candidate, ...], near: Fit) -> Fit:
    hypothesis = Hypothesis(members)
    known = study.fits.get(hypothesis.identity)
    if known is not None:
        return known
    starts = list(_starts(study, hypothesis, near))
    return study.fit(hypothesis, starts + _from(near, hypothesis, starts[0]), near)


def _from(near: Fit, hypothesis: Hypothesis, usual: Array) -> list[Array]:
    """Where a fit stands, what it has not being absent: nothing that leaves more than that has ended in the right valley.

    The nominal quantities are bent there, which is what a further member is to do instead.
    """
    _, absent = carried(near.hypothesis, near.x, hypothesis, usual)
    return [absent] if np.isfinite(absent).all() else []


def _starts(study: Study, hypothesis: Hypothesis, near: Fit) -> Sequence[Array]:
    """The nominal quantities as stated; damping as stated, and with most of the stated taken away."""
    nominal = np.zeros(len(study.predictor.nominal))
    usual = [start_vector(member) for member in hypothesis.members]
    starts = [np.concatenate([nominal, *usual])]
    lowest = [float(member.effect.lower[0]) for member in hypothesis.members]
    if any(-np.inf < low < 0.0 for low in lowest):
        less = [
            to_internal(member, np.array([0.9 * low])) if -np.inf < low < 0.0 else start
            for member, low, start in zip(hypothesis.members, lowest, usual, strict=True)
        ]
        starts.append(np.concatenate([nominal, *less]))
    return starts
