"""A force of one to three simple terms over position and velocity, charged for having been chosen among many."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations
from math import comb

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.criticism.check import Check, Form, Remainder, Test, is_no_motion
from harness.diagnose.criticism.constants import FORCE_TERMS_DEPENDENT, MOST_FORCE_TERMS
from harness.diagnose.criticism.gains import solve_gain
from harness.diagnose.selection.score_tests import Projected

Array = NDArray[np.float64]

FEW = "a force of few terms"
TERMS: tuple[tuple[str, Callable[[Array, Array], Array]], ...] = (
    ("1", lambda q, v: np.ones_like(q)),
    ("q", lambda q, v: q),
    ("q^2", lambda q, v: q**2),
    ("q^3", lambda q, v: q**3),
    ("sin(q)", lambda q, v: np.sin(q)),
    ("cos(q)", lambda q, v: np.cos(q)),
    ("sin(2 q)", lambda q, v: np.sin(2 * q)),
    ("cos(2 q)", lambda q, v: np.cos(2 * q)),
    ("v", lambda q, v: v),
    ("v |v|", lambda q, v: v * np.abs(v)),
    ("v^2", lambda q, v: v**2),
    ("v^3", lambda q, v: v**3),
    ("sign(v)", lambda q, v: np.sign(v)),
    ("q v", lambda q, v: q * v),
    ("q^2 v", lambda q, v: q**2 * v),
    ("|q| v", lambda q, v: np.abs(q) * v),
    ("q sign(v)", lambda q, v: q * np.sign(v)),
    ("q^2 sign(v)", lambda q, v: q**2 * np.sign(v)),
    ("max(q, 0)", lambda q, v: np.maximum(q, 0.0)),
    ("min(q, 0)", lambda q, v: np.minimum(q, 0.0)),
    ("max(v, 0)", lambda q, v: np.maximum(v, 0.0)),
)
"""Library of the sparsest form: forces over position q and velocity v of a joint."""


def _asked(left: Remainder) -> Iterator[Test]:
    """The gain by the sparsest form, all forms of as many terms counted in its chance."""
    form = sparsest(left)
    size = len(form.terms)
    choices = float(comb(len(TERMS), size))
    chance = min(1.0, choices * float(chi2.sf(form.gain / left.noise, size))) if size else 1.0
    name = f"{FEW} at {form.joint}"
    yield Test(name, form.gain, size, chance, (form.joint, str(form)), choices=choices, form=form)


def sparsest(left: Remainder) -> Form:
    """The best of all combinations of few terms of the library, as many terms as the Bayesian criterion pays for.

    All are compared, for two terms may each explain nothing and together everything, as drive and brake of a limit cycle do.
    """
    at = left.at
    seen = left.space.measure(at.probe.changes(at.joint, lambda q, v: np.array([term(q, v) for _, term in TERMS])))
    price = float(np.log(len(left.space.residual))) + 2.0 * float(np.log(len(TERMS)))
    best: tuple[int, ...] = ()
    for size in range(1, MOST_FORCE_TERMS + 1):
        gain, chosen = _best_subset(seen, size)
        if gain > solve_gain(seen, best, 1e-4)[0] + price * (size - len(best)):
            best = chosen
    total, coefficients, _ = solve_gain(seen, best, 1e-4)
    names = tuple(TERMS[j][0] for j in best)
    return Form(at.joint, names, tuple(float(c) * at.probe.torque for c in coefficients), total)


def _best_subset(seen: Projected, size: int) -> tuple[float, tuple[int, ...]]:
    """The greatest gain of so many columns together, those that are nearly dependent left out, and which they are."""
    assert seen.gram is not None
    norms = np.sqrt(np.maximum(seen.squares, 0.0))
    visible = norms > 1e-6 * max(float(norms.max(initial=0.0)), 1e-300)
    usable = np.flatnonzero(visible)
    if len(usable) < size:
        return 0.0, ()
    subsets = usable[np.array(list(combinations(range(len(usable)), size)))]
    units = np.where(visible, norms, np.inf)
    scaled = seen.gram / np.outer(units, units)
    right = (seen.along / units)[subsets]
    values, vectors = np.linalg.eigh(scaled[subsets[:, :, None], subsets[:, None, :]])
    along = np.einsum("kij,ki->kj", vectors, right)
    independent = values[:, 0] > FORCE_TERMS_DEPENDENT * values[:, -1]
    gains = np.where(independent, np.sum(along**2 / np.maximum(values, 1e-300), axis=1), 0.0)
    best = int(np.argmax(gains))
    return float(gains[best]), tuple(int(k) for k in subsets[best])


CHECK = Check(FEW, _asked, every_joint=True, on_both_sides=is_no_motion, of_state=True)
