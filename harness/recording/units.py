"""Units of columns: whatever a header says in brackets, to SI by the ``pint`` package."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.errors import InputError
from harness.recording.recording import LINEAR_UNITS, POSITIONS, SPATIAL_UNITS, UNITS

if TYPE_CHECKING:
    import pint

# The table's "mil" is a tenth of the angular one, of which 6400 make a turn.
DEFINITIONS = (
    "mil = 2 * pi / 6400 * radian = _ = mils",
    "strain = 1",
    "microstrain = 1e-6",
    "rev = 2 * pi * radian = _ = revs",
    "dps = degree / second",
    "RPM = 2 * pi * radian / minute",
)
# Lengths of typesetting: a camera's pixels are none of 1/96 inch.
PRINTED = ("css_pixel", "pixel", "dot", "point", "pica", "scaled_point", "didot", "cicero")

# Words that mean something else to a measuring engineer than to a table of units.
GRAVITY = {
    **dict.fromkeys(("g", "G", "gn", "g0", "g_n", "gs", "g's", "gee", "gees"), "standard_gravity"),
    **dict.fromkeys(("mg", "mG"), "0.001 standard_gravity"),
    **dict.fromkeys(("ug", "µg", "uG"), "0.000001 standard_gravity"),
}
MICROSTRAIN = dict.fromkeys(("µε", "ue", "uε", "ustrain", "uE", "µE", "ustr", "µstrain"), "microstrain")
SPELLINGS = {
    "tip_acceleration": GRAVITY,
    "root_strain": {**MICROSTRAIN, "ε": "strain", "‰": "0.001 strain"},
    "velocity": dict.fromkeys(("r/min", "U/min"), "RPM"),
    "tip_deflection": {"mil": "thou", "mils": "thou"},
}
# Torques as data sheets write them; a mass stands for its weight there.
TORQUES = (
    (re.compile(r"(?<![A-Za-z])([kmuµcM]?)N[ .*-]?([cmuµ]?m)(?![A-Za-z0-9])"), r"\1N*\2"),
    (re.compile(r"(?<![A-Za-z])(k?)gf?[ .*-]?([cm]?m)(?![A-Za-z0-9])"), r"\1gf*\2"),
    (re.compile(r"(?<![A-Za-z])ozf?[ .*-]?in(ch)?(?![A-Za-z0-9])"), "force_ounce*inch"),
    (re.compile(r"(?<![A-Za-z])(in|ft)[ .*-]?lb[fs]?(?![A-Za-z0-9])"), r"\1*force_pound"),
    (re.compile(r"(?<![A-Za-z])lbf?[ .*-]?(in|ft)(?![A-Za-z0-9])"), r"\1*force_pound"),
)
COUNTED = re.compile(r"(?i)\b(counts?|cts|ticks?|pulses?|steps?|lsbs?|incs?|increments?|samples?|frames?|digits?)\b")
SIGNS = str.maketrans({"·": "*", "⋅": "*", "×": "*", "•": "*", "²": "**2", "³": "**3", "^": "**", "μ": "µ", "º": "°"})
POWER = re.compile(r"(?<=[A-Za-z°])(?<!\d[eE])(-?[23])(?![A-Za-z0-9.])")  # m/s2
VOLTS = re.compile(r"(?<![A-Za-zµ])[mµu]?(V|volts?)(?![A-Za-z])")
# A unit is evaluated, and a tower of powers would be for ever.
LONGEST, MOST_POWERS, MOST_DIGITS = 80, 6, 20
DIGITS = re.compile(r"\d+")
EXPONENT = re.compile(r"\*\*\s*(?:[+-]?\d{1,2}(?:\.\d+)?|\(\s*[+-]?\d{1,2}(?:\.\d+)?\s*\))(?![\w.])(?!\s*\*\*)")
POWER_OF_BRACKET = re.compile(r"\)\s*\*\*")
PURE_STRAIN = ("percent", "ppm", "strain", "microstrain")


@cache
def _registry() -> pint.UnitRegistry:
    # A third of a second, and most recordings are in SI.
    import pint

    registry: pint.UnitRegistry = pint.UnitRegistry(cache_folder=None, on_redefinition="ignore")
    for definition in DEFINITIONS:
        registry.define(definition)
    return registry


def factor_to_si(
    unit: str, quantity: str, *, prismatic: bool | None, source: str | Path | None = None, column: str | None = None
) -> tuple[float, str]:
    """The number to multiply a column by, and the SI unit it then has.

    unit: as in the header, "" for SI; may carry a number (``2*pi/4096 rad`` for counts of an encoder).
    quantity: "time" or one of ``QUANTITIES``. prismatic: kind of joint, None if not known.
    Raises InputError for words that are no unit, units of another kind, plain numbers and counts, and those that could mean two
    things.
    """
    if quantity == "command":
        return _of_command(unit, prismatic, source, column)
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
    given = _parsed(text, quantity, prismatic)
    if given is None:
        raise InputError(
            f"{text!r} is not a unit", mend=_mend(text, None, quantity, prismatic), source=source, column=column
        )
    registry = _registry()
    # Root units keep radians, counts and bits, which are plain numbers to a table of units: as such, counts would pass for radians
    # and hertz for rad/s.
    roots = _roots(given)
    if (
        quantity == "velocity"
        and not prismatic
        and (text in ("rps", "cps") or roots in ({"second": -1}, {"count": 1, "second": -1}))
    ):
        raise InputError(
            f"unit {text!r} of a velocity could mean turns or radians, or counts",
            mend="write rad/s, deg/s, rpm or turn/s; counts need their number a turn, as 2*pi/4096 rad/s",
            source=source,
            column=column,
        )
    for target in candidates:
        goal = registry.Quantity(1.0, "dimensionless" if target == "1" else target)
        if roots != _roots(goal) or _is_printed(given) or (target == "1" and not _is_strain(text, given)):
            continue
        size = float(given.to(goal.units).magnitude)
        if not np.isfinite(size) or size == 0.0:
            break
        return size, target
    what = f"{'an' if quantity == 'effort' else 'a'} {quantity.replace('_', ' ')}"
    raise InputError(
        f"unit {text!r} does not fit {what}, which is in {' or '.join(candidates)}",
        mend=_mend(text, given, quantity, prismatic),
        source=source,
        column=column,
    )


def _of_command(unit: str, prismatic: bool | None, source: str | Path | None, column: str | None) -> tuple[float, str]:
    """A command is a position, a velocity, a force or a plain number, by what its actuator does with it."""
    if not unit.strip():
        return 1.0, UNITS["command"]
    faults = []
    for quantity in ("position", "velocity", "effort"):
        try:
            return factor_to_si(unit, quantity, prismatic=prismatic, source=source, column=column)
        except InputError as fault:
            faults.append(fault)
    raise InputError(
        f"unit {unit.strip()!r} does not fit a command",
        mend="rad, rad/s or N*m by what the actuator is asked for, or no unit",
        source=source,
        column=column,
    ) from faults[0]


def _is_sane(text: str) -> bool:
    """Whether a text can be evaluated at once: powers are small numbers, of what is no power itself, and few.

    Commas would be passed over: 0,5 mm would be 5 mm, and of 9**9,999,999 a small power is all that is seen here.
    """
    powers = text.count("**")
    return (
        "," not in text
        and len(text) <= LONGEST
        and max((len(digits) for digits in DIGITS.findall(text)), default=0) <= MOST_DIGITS
        and powers <= MOST_POWERS
        and len(EXPONENT.findall(text)) == powers
        and len(POWER_OF_BRACKET.findall(text)) <= 1
    )


def _parsed(text: str, quantity: str, prismatic: bool | None) -> Any:
    """A ``pint`` quantity, or None if the text is none."""
    spelt = text.translate(SIGNS)
    spelt = SPELLINGS.get(quantity, {}).get(spelt, spelt)
    if quantity in POSITIONS and prismatic and spelt in ("mil", "mils"):
        spelt = "thou"
    if quantity == "effort":
        for pattern, replacement in TORQUES:
            spelt = pattern.sub(replacement, spelt)
    spelt = POWER.sub(r"**(\1)", spelt).replace("%", "percent")
    if not _is_sane(spelt):
        return None
    registry = _registry()
    # "Seconds", "DEG": capitals are tried as such first, for they part milli from mega.
    for attempt in (spelt, spelt.lower()):
        try:
            found = registry.Quantity(1.0) * registry.parse_expression(attempt)
            found.to_root_units()  # overflows where powers add up
            return found
        except Exception:  # pint raises its own, tokenizer and attribute errors alike
            continue
    return None


def _roots(given: Any) -> dict[str, float]:
    """Root units of a quantity with their powers."""
    return {name: float(power) for name, power in given.to_root_units().unit_items() if power}


def _words(given: Any) -> list[str]:
    """The units that a quantity is written in, without prefixes."""
    registry = _registry()
    names = [name for name, _ in given.unit_items()]
    return [next((root for _, root, _ in registry.parse_unit_name(name)), name) for name in names]


def _is_printed(given: Any) -> bool:
    return any(word in PRINTED for word in _words(given))


def _is_strain(text: str, given: Any) -> bool:
    """Whether a plain number is a strain: a ratio of lengths or a share, not of volts or any other two alike."""
    lengths = [word for word in _words(given) if word not in PURE_STRAIN]
    return not VOLTS.search(text) and all(_registry().get_dimensionality(word) == {"[length]": 1} for word in lengths)


def _mend(text: str, given: Any, quantity: str, prismatic: bool | None) -> str:
    counted = COUNTED.search(text) is not None if given is None else set(_roots(given)) <= {"count", "bit", "second"}
    if quantity in (*POSITIONS, "velocity") and counted:
        per = "/s" if quantity == "velocity" else ""
        if prismatic:
            return f"a plain number needs what it stands for, as 0.005 mm{per} for a count of 5 µm"
        return f"a plain number needs what it stands for, as 2*pi/4096 rad{per} for a count of 4096 a turn"
    if quantity == "time" and (COUNTED.search(text) or (given is not None and _roots(given) == {"count": 1})):
        return "counts need their length, as 0.001 s for a thousand a second"
    if quantity == "root_strain" and VOLTS.search(text):
        return (
            "write the strain that one of it stands for, by gauge factor and bridge, as 2000 microstrain for a mV/V of a quarter "
            "bridge of gauge factor 2"
        )
    if quantity == "effort" and given is not None and set(_roots(given)) >= {"ampere"}:
        return f"write what one {text} stands for, as 0.07 N*m by a motor's torque constant"
    if given is not None and _is_printed(given):
        return "write what one pixel is, as 0.05 mm"
    return f"use for example {_examples(quantity)}"


def _examples(quantity: str) -> str:
    if quantity in SPATIAL_UNITS:
        return {"m": "m, mm, um", "m/s": "m/s, mm/s", "rad/s": "rad/s, deg/s, rpm", "1": "1, as quaternions have it"}[
            SPATIAL_UNITS[quantity]
        ]
    return {
        "time": "s, ms, us",
        "position": "rad, deg, turn (or m, mm of a prismatic joint)",
        "link_position": "rad, deg, turn (or m, mm of a prismatic joint)",
        "velocity": "rad/s, deg/s, rpm (or m/s of a prismatic joint)",
        "effort": "N*m, mN*m (or N of a prismatic joint)",
        "tip_deflection": "m, mm, um",
        "root_strain": "1, microstrain, percent",
        "tip_acceleration": "m/s**2, g",
        "command": "rad, rad/s, N*m",
    }[quantity]


def is_unit(text: str) -> bool:
    """Whether a word is a unit of anything."""
    return _parsed(text, "", None) is not None


def written(unit: str) -> str:
    """A unit as people write it: ``N*m*s**2/rad**2`` as ``N·m·s²/rad²``; empty for a bare 1."""
    if unit == "1":
        return ""
    return unit.replace("**2", "²").replace("**3", "³").replace("*", "·")
