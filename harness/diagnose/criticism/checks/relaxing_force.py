"""A force that relaxes, put to what a fit leaves: springs in series with dashpots (Maxwell elements) at one joint.

Rubber, grease and air in a bush answer a motion by a force that dies away, so that they know where the joint has been; no law
over position and velocity says that. Their relaxation times may be spread widely: a spectrum of them, each element pulling
back, is fitted by non-negative least squares, of which only a few are not zero.

Source: Wiechert's model, N. W. Tschoegl, The Phenomenological Theory of Linear Viscoelastic Behavior (1989), chapter 3.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.signal import lfilter
from scipy.stats import chi2

from harness.diagnose.criticism.check import Check, Remainder, Test, is_no_motion
from harness.diagnose.criticism.constants import (
    LONGEST_RELAXATION,
    RELAXATION_TIMES,
    RELAXATIONS_DEPENDENT,
    SHORTEST_RELAXATION,
)
from harness.diagnose.criticism.members import tuned_to_relax
from harness.diagnose.selection.score_tests import Projected
from harness.effects.effect import Effect

Array = NDArray[np.float64]

RELAXES = "a force that relaxes"


def _asked(left: Remainder) -> Iterator[Test]:
    """Gain by elements that relax, as many as it takes, each with a stiffness and a time of its own.

    All are taken to have relaxed before a window begins.
    """
    joint = left.at.joint
    times = left.period / (2.0 * np.pi) * np.geomspace(SHORTEST_RELAXATION, LONGEST_RELAXATION, RELAXATION_TIMES)
    seen = left.space.measure(left.at.probe.in_time(joint, partial(_forces, times=times)))
    gain, stiffness = _spectrum(seen)
    acting = np.flatnonzero(stiffness > 0.0)
    # Neighbours are one element whose time lies between them.
    elements = int(np.count_nonzero(np.diff(acting, prepend=-2) > 1))
    if elements == 0:
        yield Test(f"{RELAXES} at {joint}", 0.0, 0, 1.0, (joint,))
        return
    chance = min(1.0, RELAXATION_TIMES**elements * float(chi2.sf(gain / left.noise, 2 * elements)))
    groups = np.split(acting, np.flatnonzero(np.diff(acting) > 1) + 1)
    means = [float(np.exp(np.average(np.log(times[g]), weights=stiffness[g]))) for g in groups]
    # At either end of the times that are tried an element is a damper or a spring.
    told = [
        f"{mean:.2g} s" for mean, g in zip(means, groups, strict=True) if 0 not in g and RELAXATION_TIMES - 1 not in g
    ]
    where = "within " + ", ".join(told) if told else "like a damper" if 0 in acting else "like a spring"
    yield Test(f"{RELAXES} at {joint}", gain, elements, chance, (joint, where), elements)


def _forces(time: Array, q: Array, v: Array, times: Array) -> Array:
    """Forces (k, G) of elements of unit stiffness: −r with ṙ = q̇ − r/τ, exactly for a velocity that is even in a step."""
    step = float(time[1] - time[0])
    kept = np.exp(-step / times)
    driven = times / step * (1.0 - kept)
    moved = np.diff(q, prepend=q[0])
    return np.array([-lfilter([b], [1.0, -a], moved) for a, b in zip(kept, driven, strict=True)])


def _spectrum(seen: Projected) -> tuple[float, Array]:
    """Gain in cost and the stiffnesses (k,), none below zero, that bring it."""
    assert seen.gram is not None
    norms = np.sqrt(np.maximum(seen.squares, 0.0))
    visible = norms > 1e-6 * max(float(norms.max(initial=0.0)), 1e-300)
    stiffness = np.zeros(len(norms))
    if not visible.any():
        return 0.0, stiffness
    size = norms[visible]
    values, vectors = np.linalg.eigh(seen.gram[np.ix_(visible, visible)] / np.outer(size, size))
    strong = values > RELAXATIONS_DEPENDENT * values[-1]
    root = np.sqrt(values[strong])
    matrix = root[:, None] * vectors[:, strong].T
    right = -(vectors[:, strong].T @ (seen.along[visible] / size)) / root
    found, left = nnls(matrix, right)
    stiffness[visible] = found / size
    return float(right @ right - left**2), stiffness


def _some_tuned(effects: Sequence[Effect]) -> bool:
    return any(map(tuned_to_relax, effects))


def _may_hide(effect: Effect) -> bool:
    return is_no_motion(effect) or tuned_to_relax(effect)


CHECK = Check(RELAXES, _asked, every_joint=True, may_stand_for=_some_tuned, on_both_sides=_may_hide)
