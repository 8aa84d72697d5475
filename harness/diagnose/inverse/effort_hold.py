"""Whether recorded efforts act smoothly through their samples or are held from each to the next, where efforts are the measurement.

Taken for smooth (see ``problem.held_efforts``) a held effort shows as a delay of half an interval at each drive. Where the two are
equally good, efforts are taken as smooth.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from harness.diagnose.inverse.effort_fit import EffortFit
from harness.diagnose.inverse.effort_motion import EffortRun, recorded_efforts
from harness.diagnose.inverse.effort_search import EffortStudy, search
from harness.diagnose.problem.constants import UNPARTED_EVIDENCE
from harness.diagnose.problem.held_efforts import late
from harness.recording.recording import Recording
from harness.system import System


def held_runs(system: System, runs: Sequence[EffortRun], recordings: Sequence[Recording]) -> list[EffortRun]:
    """The runs with their efforts half an interval later."""
    out = []
    for run, recording in zip(runs, recordings, strict=True):
        raw = recorded_efforts(system, recording, run.time - 0.5 * recording.interval)
        out.append(replace(run, raw=raw, effort=run.smooth(raw)))
    return out


def search_either_way(
    smooth: EffortStudy, held: EffortStudy, progress: Callable[[str], None], tell: Callable[[EffortStudy], None]
) -> EffortFit:
    """The best set of effects, of whichever study it is; ``tell`` is given the study each time that it is another one."""
    study = smooth

    def turned(fitted: EffortFit) -> EffortStudy | None:
        nonlocal study
        if study is smooth and held.fit(fitted.hypothesis, [fitted.x]).cost < fitted.cost - UNPARTED_EVIDENCE:
            held.fit(smooth.nothing.hypothesis, [smooth.nothing.x])
            study = held
            tell(held)
            return held
        return None

    best = search(smooth, progress, turned)
    if study is held:
        other = smooth.fit(best.hypothesis, [best.x])
        if other.cost <= best.cost + UNPARTED_EVIDENCE:
            tell(smooth)
            return other
    elif late(best.hypothesis):
        # Beside what else is missing a single late drive may have been taken before all of them were.
        held.fit(smooth.nothing.hypothesis, [smooth.nothing.x])
        other = search(held, progress)
        if held.criterion(other) < smooth.criterion(best):
            tell(held)
            return other
    return best
