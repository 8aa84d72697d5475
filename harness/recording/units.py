"""Units of columns: whatever a header says in brackets, to SI by the ``pint`` package."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.errors import InputError
from harness.recording.recording import LINEAR_UNITS, UNITS

if TYPE_CHECKING:
    import pint

# Words that mean something else to a measuring engineer than to a table of units.
SPELLINGS = {
    "tip_acceleration": {
        "g": "standard_gravity",
        "G": "standard_gravity",
        "gn": "standard_gravity",
        "g0": "standard_gravity",
    },
    "root_strain": {
        "µε": "microstrain",
        "με": "microstrain",
        "ue": "microstrain",
        "uε": "microstrain",
        "ustrain": "microstrain",
    },
}
AMBIGUOUS = {"velocity": ("Hz", "hertz", "1/s", "rps", "cps")}


@cache
def _registry() -> pint.UnitRegistry:
    # A third of a second, and most recordings are in SI.
    import pint

    registry: pint.UnitRegistry = pint.UnitRegistry(cache_folder=None)
    registry.define("strain = 1")
    registry.define("microstrain = 1e-6")
    return registry


def factor_to_si(
    unit: str, quantity: str, *, prismatic: bool | None, source: str | Path | None = None, column: str | None = None
) -> tuple[float, str]:
    """The number to multiply a column by, and the SI unit it then has.

    unit: as in the header, "" for SI; may carry a number (``2*pi/4096 rad`` for counts of an encoder).
    quantity: "time" or one of ``QUANTITIES``. prismatic: kind of joint, None if not known.
    Raises InputError for words that are no unit, units of another kind, and those that could mean two things.
    """
    wanted = "s" if quantity == "time" else UNITS[quantity]
    linear = LINEAR_UNITS.get(quantity, "")
    candidates = [linear] if prismatic and linear else [wanted]
    if prismatic is None and linear:
        candidates.append(linear)
    text = unit.strip()
    if not text:
        return 1.0, candidates[0]
    if text in candidates:
        return 1.0, text
    if text in AMBIGUOUS.get(quantity, ()) and not prismatic:
        raise InputError(
            f"unit {text!r} of a velocity could mean turns or radians",
            mend="write rad/s, deg/s, rpm or turn/s",
            source=source,
            column=column,
        )
    spelt = SPELLINGS.get(quantity, {}).get(text, text).replace("·", "*").replace("²", "**2").replace("³", "**3")
    registry = _registry()
    try:
        given = registry.Quantity(1.0) * registry.parse_expression(spelt)
    except Exception as failure:  # pint raises its own, tokenizer and attribute errors alike
        raise InputError(
            f"{text!r} is not a unit", mend=f"use for example {_examples(quantity)}", source=source, column=column
        ) from failure
    for target in candidates:
        goal = registry.parse_units("dimensionless" if target == "1" else target)
        if not given.is_compatible_with(goal):
            continue
        size = float(given.to(goal).magnitude)
        if not np.isfinite(size) or size == 0.0:
            break
        return size, target
    raise InputError(
        f"unit {text!r} does not fit a {quantity.replace('_', ' ')}, which is in {' or '.join(candidates)}",
        mend=f"use for example {_examples(quantity)}",
        source=source,
        column=column,
    )


def _examples(quantity: str) -> str:
    return {
        "time": "s, ms, us",
        "position": "rad, deg, turn (or m, mm of a prismatic joint)",
        "velocity": "rad/s, deg/s, rpm (or m/s of a prismatic joint)",
        "effort": "N*m, mN*m (or N of a prismatic joint)",
        "tip_deflection": "m, mm, um",
        "root_strain": "1, microstrain, percent",
        "tip_acceleration": "m/s**2, g",
    }[quantity]


def written(unit: str) -> str:
    """A unit as people write it: ``N*m*s**2/rad**2`` as ``N·m·s²/rad²``; empty for a bare 1."""
    if unit == "1":
        return ""
    return unit.replace("**2", "²").replace("**3", "³").replace("*", "·")
