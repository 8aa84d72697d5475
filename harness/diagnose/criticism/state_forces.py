"""Forces over a joint's position and velocity, of any smooth shape and with bumps in position, for the checks that ask for them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.criticism.check import AtJoint, Map, Remainder, Test
from harness.diagnose.criticism.constants import STATE_CUT, STATE_FORCE_PLACES, TURNING_STEEPNESS
from harness.diagnose.criticism.gains import solve_gain

Array = NDArray[np.float64]

STATE = "forces over the state"


def state_shapes(q: Array, qd: Array, low: float, high: float, fast: float) -> tuple[list[str], Array]:
    """Forces over one joint's position and velocity: smooth polynomials, then bumps in position, going and coming.

    low, high: range of position that the bumps divide; fast: velocity scale. Returns names and values (k, G).
    """
    u = np.clip((q - 0.5 * (low + high)) / (0.5 * (high - low)), -STATE_CUT, STATE_CUT)
    w = np.clip(qd / fast, -STATE_CUT, STATE_CUT)
    names, values = [], []
    for a in range(4):
        for b in range(4):
            if a + b <= 4:
                names.append(f"u^{a} w^{b}")
                values.append(u**a * w**b)
    for label, sign in (("sign(w)", np.tanh(TURNING_STEEPNESS * w)), ("u sign(w)", u * np.tanh(TURNING_STEEPNESS * w))):
        names.append(label)
        values.append(sign)
    centres = np.linspace(-1.0, 1.0, STATE_FORCE_PLACES)
    width = centres[1] - centres[0]
    for c in centres:
        bump = np.exp(-(((u - c) / width) ** 2))
        names += [f"bump({c:.2f})", f"bump({c:.2f}) sign(w)"]
        values += [bump, bump * np.tanh(TURNING_STEEPNESS * w)]
    return names, np.array(values)


def shape_names(at: AtJoint) -> list[str]:
    """Names of those forces."""
    return state_shapes(np.zeros(2), np.zeros(2), at.low, at.high, at.fast)[0]


def force_over_state(left: Remainder, label: str, index: Sequence[int]) -> Test:
    """Gain by a combination of some of those forces at a joint, with the map of what was found."""
    at = left.at
    if STATE not in at.measured:
        at.measured[STATE] = left.space.measure(at.probe.changes(at.joint, partial(_values, at)))
    gain, found, size = solve_gain(at.measured[STATE], index, 1e-3)
    full = np.zeros(len(shape_names(at)))
    full[index] = found * at.probe.torque
    chance = float(chi2.sf(gain / left.noise, max(size, 1.0)))
    return Test(f"{label} at {at.joint}", gain, int(size), chance, (at.joint,), force_map=partial(_map, at, full))


def beyond_its_size(test: Test) -> float:
    """What many shapes together gain beyond what they gain of noise alone."""
    return test.gain - test.size


def _values(at: AtJoint, q: Array, qd: Array) -> Array:
    return state_shapes(q, qd, at.low, at.high, at.fast)[1]


def _map(at: AtJoint, coefficients: Array) -> Map:
    """The fitted force on a grid over position and velocity, where the motion has been."""
    low, high, fast = at.low, at.high, at.fast
    position, velocity = np.linspace(low, high, 21), np.linspace(-fast, fast, 21)
    q, v = np.meshgrid(position, velocity, indexing="ij")
    force = (coefficients @ _values(at, q.ravel(), v.ravel())).reshape(q.shape)
    k = at.place
    seen = np.zeros_like(force, dtype=bool)
    for m in at.probe.motions.values():
        i = np.clip(np.round((m.q[:, k] - low) / (high - low) * 20).astype(int), 0, 20)
        j = np.clip(np.round((m.qd[:, k] + fast) / (2 * fast) * 20).astype(int), 0, 20)
        seen[i, j] = True
    return Map(at.joint, position, velocity, np.where(seen, force, np.nan))
