"""Why a set of effects lost to the one that is told."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from harness.diagnose.claims.constants import WORSE_PREDICTION_RATIO
from harness.diagnose.claims.rivals import as_stated
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.study import Study
from harness.plain_numbers import points


def why_lost(
    study: Study,
    best: Fit,
    other: Fit,
    error: float,
    least: float,
    imitated: Collection[str] = (),
    *,
    beside_force: bool = False,
) -> str:
    """A few words; empty for the best itself.

    error, least: errors on the data held out, of the other and of the best. imitated: keys of what is not claimed although it fits,
    because what nobody has named could have done its work. beside_force: whether sets were weighed beside a force that is left out.
    What fits better than the best, but is not claimed, is told why; what lies between is held against it.
    """
    if other.hypothesis.identity == best.hypothesis.identity:
        return ""
    if study.criterion(other) < study.criterion(best):
        if as_stated(study, other).hypothesis.identity == best.hypothesis.identity:
            return "takes away what the model states, and needs more effects for it"
        leading = min(study.fits.values(), key=study.criterion)
        if not other.hypothesis.members:
            # There is nothing in it that could be borne out: it is held against what is told.
            leading = best
        elif other.hypothesis.identity == leading.hypothesis.identity:
            shared = [key for key in other.hypothesis.keys if key in imitated]
            if shared:
                return f"what nobody has named could have imitated {' and '.join(shared)}"
            if beside_force:
                return "likelier under noise alone, and not beside the force that is left out"
            return "not borne out by data that it was not fitted to"
        if leading is not best:
            best, least = leading, np.inf
    further = other.hypothesis.size - best.hypothesis.size
    price = further * float(np.log(study.samples))
    gained = best.cost - other.cost
    better = f"better (χ² by {points(gained)}), too little for" if gained >= 1.0 else "no better with"
    parts = {
        _bent(study, other): other.prior - best.prior,
        f"fits the recordings worse (χ² by {points(-gained)})": -gained,
        f"fits {better} {further} more parameter{'s' * (further > 1)}": price,
    }
    said = max(parts, key=lambda words: parts[words])
    if parts[said] < 1.0:
        return "as good"
    if error > WORSE_PREDICTION_RATIO * least > 0.0:
        said += f", predicts the data held out {_ratio(error / least)} worse"
    return said


def _ratio(times: float) -> str:
    return f"{100.0 * (times - 1.0):.0f} %" if times < 2.0 else f"{float(f'{times:.2g}'):,.12g} times"


def _bent(study: Study, fitted: Fit) -> str:
    z = fitted.x[: len(study.predictor.nominal)]
    if not len(z):
        return "bends the nominal model"
    worst = int(np.argmax(np.abs(z)))
    quantity = study.predictor.nominal[worst]
    return f"bends the nominal model: {quantity.kind} of {quantity.name} by {z[worst]:+.1f} σ of its tolerance"
