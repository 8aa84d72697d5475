"""How figures, verdicts and quantities read."""

from __future__ import annotations

import math

from harness.cases.case import Row
from harness.recording.units import written

MARKS = {"pass": "✓", "fail": "✗", "skipped": "–"}
GROUP_TITLES = {
    "rigid": "Rigid pendulums and closed forms",
    "chaos": "Chaotic motion",
    "scale": "Random chains and trees",
    "lanes": "Lanes and joint laws",
    "robots": "Real robots",
    "loops": "Closed loops",
    "flexible": "Flexible links",
    "models": "Your models",
}


def figure(value: float | None, *, verdict: str = "") -> str:
    """Two digits; a dash for nothing compared; ``not finite`` for a failed row without a number."""
    if value is None or not math.isfinite(value):
        return "not finite" if verdict == "fail" else "–"
    return "0" if value == 0.0 else f"{value:.1e}"


def share(row: Row) -> str:
    """How much of what is allowed a difference takes: ``12 %``, or ``34 times`` where it is more."""
    ratio = row.ratio
    if not math.isfinite(ratio):
        return figure(ratio, verdict=row.verdict) if row.allowed != 0.0 else "more than none"
    if ratio > 1.0:
        return f"{ratio:.2g} times" if ratio < 10.0 or ratio >= 1e4 else f"{ratio:.0f} times"
    return "0 %" if ratio == 0.0 else f"{100.0 * ratio:.2g} %"


def quantity(name: str) -> str:
    """``mass_matrix`` as ``mass matrix``; what stands behind an ``@`` is the user's own name."""
    kind, at, site = name.partition("@")
    return kind.replace("_", " ") + (f" of {site}" if at else "")


def engines(row: Row) -> str:
    return " · ".join(row.engines)


def unit(row: Row) -> str:
    """``relative`` rather than a bare 1."""
    return "relative" if row.unit == "1" else written(row.unit)


def divergence(row: Row) -> str:
    """``time 3.2 s, joint elbow`` from the row's first divergence, or nothing."""
    if not row.first_divergence:
        return ""
    return ", ".join(_place(key, value) for key, value in row.first_divergence.items())


def _place(key: str, value: object) -> str:
    if key == "value":
        # A number of the description, of the link or joint named before it.
        return _short(value).replace("_", " ")
    return f"{key} {_short(value)}" + {"time": " s", "begins": " s", "growth": " 1/s"}.get(key, "")


def _short(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, list | tuple):
        return " × ".join(_short(item) for item in value)
    return str(value)


def headline(passed: int, failed: int, skipped: int) -> str:
    """One sentence on the whole table."""
    if failed:
        text = f"{failed} of {passed + failed} comparisons failed"
    elif passed:
        text = f"all {passed} comparisons are within what is allowed"
    else:
        text = "nothing could be compared"
    return text + (f"; {skipped} {'was' if skipped == 1 else 'were'} not possible" if skipped else "")
