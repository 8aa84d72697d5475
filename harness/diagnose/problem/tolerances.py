"""Tolerances as who asks gives them: of all nominal quantities, or of single ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from harness.diagnose.problem.hypothesis import nominal_quantities
from harness.errors import InputError
from harness.system import System
from harness.system.suggest import did_you_mean

OTHERS = "*"  # stands for every quantity that has no tolerance of its own
Tolerance = float | Mapping[str, float]
"""Relative 1σ of every nominal quantity, or of single ones by ``name.kind`` (``servo.armature``); ``*``: of all others."""


def told(words: Sequence[str]) -> Tolerance | None:
    """Tolerances from words like ``0.02`` and ``servo.armature=0.2``; None where there are none. Raises InputError."""
    found: dict[str, float] = {}
    for word in words:
        name, equals, number = word.rpartition("=")
        try:
            found[name.strip() if equals else OTHERS] = float(number)
        except ValueError:
            raise InputError(
                f"tolerance {word!r} is no number", mend="give 0.02, or servo.armature=0.2 for one quantity"
            ) from None
    if not found:
        return None
    return found[OTHERS] if list(found) == [OTHERS] else found


def with_tolerances(system: System, given: Tolerance) -> System:
    """The system with these tolerances in place of its own. Raises InputError for what it has no such quantity of."""
    single = dict(given) if isinstance(given, Mapping) else {OTHERS: given}
    for name, value in single.items():
        if not 0.0 < value < 1.0:
            what = f"tolerance {value:g}" + ("" if name == OTHERS else f" of {name}")
            raise InputError(f"{what} is not between 0 and 1", mend="give a relative 1σ such as 0.01")
    rest = single.pop(OTHERS, system.tolerance)
    known = {f"{q.name}.{q.kind}": q.key for q in nominal_quantities(system)}
    for name in single:
        if name not in known:
            raise InputError(
                f"tolerance of {name!r}: the model states no such quantity, or states it as nothing, of which no share can be off",
                mend=did_you_mean(name, known) or f"known are {', '.join(known)}",
                source=system.source,
            )
    own = {known[name]: value for name, value in single.items()}
    return replace(system, tolerance=rest, tolerances={**system.tolerances, **own})
