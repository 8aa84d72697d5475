"""Sets found on short windows, where whole runs have many wrong valleys: far from the truth, or where the nominal model is bent.

What was bent beyond its tolerance is far from the truth too, however well it fits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.beam_search import Effort, grow, transfer
from harness.diagnose.selection.dissipation_starts import ordinary
from harness.diagnose.selection.effort_hold import either_way
from harness.diagnose.selection.fitted_again import fitted_again
from harness.diagnose.selection.opening import Opened, Opening
from harness.diagnose.selection.study import Study


def _go(opened: Opened) -> None:
    short, first = opened.short, opened.first
    if opened.groups == short.windows or not (opened.lost or short.stretched(first)):
        return
    if not any(map(short.only_noise, opened.shorter)):
        opened.shorter += ordinary(short, first)
    study, ordered = _begun_with(short, [first, *opened.shorter], opened.effort, opened.progress)
    if study is not short:
        opened.reached.append(study)
        opened.lengthen(study)
    found = [f for f in ordered if f.hypothesis.members]
    opened.seeds += transfer(opened.long, found, 2 * opened.effort.beam, opened.progress)


def _begun_with(
    study: Study, seeds: Sequence[Fit], effort: Effort, progress: Callable[[str], None]
) -> tuple[Study, list[Fit]]:
    """Sets on short windows for whole runs to begin with; efforts are held from where that shows on."""
    held: list[Study] = []

    def shows(best: Fit) -> bool:
        other, _ = either_way(study, best)
        if other is not study:
            held.append(other)
        return bool(held)

    ordered = grow(study, seeds, effort, progress, to_begin_with=True, stop=shows)
    if not held:
        return study, ordered
    progress("efforts held between samples")
    again = fitted_again(held[0], ordered[: 2 * effort.beam], ordered[0])
    return held[0], grow(held[0], again, effort, progress, to_begin_with=True)


OPENING = Opening(_go)
