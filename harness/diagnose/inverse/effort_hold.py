"""Whether recorded efforts act smoothly through their samples or are held from each to the next, where efforts are the measurement.

How an effort was logged is a convention and no physics that a model left out, so it is no effect: to a mechanism a held effort is a
smooth one that is half an interval late, at every joint alike. Taken for smooth it shows as a delay of half an interval at each
drive. Where the two are equally good, efforts are taken as smooth.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from harness.diagnose.inverse.effort_fit import EffortFit
from harness.diagnose.inverse.effort_motion import EffortRun, recorded_efforts
from harness.diagnose.inverse.effort_search import EffortStudy, search
from harness.effects.catalogue import catalogue
from harness.recording.recording import QualityNote, Recording
from harness.system import System

PLAIN = 10.0  # in the criterion, from which holding counts as seen
LATE = "actuator_delay"


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
        if study is smooth and held.fit(fitted.hypothesis, [fitted.x]).cost < fitted.cost - PLAIN:
            held.fit(smooth.nothing.hypothesis, [smooth.nothing.x])
            study = held
            tell(held)
            return held
        return None

    best = search(smooth, progress, turned)
    if study is held:
        other = smooth.fit(best.hypothesis, [best.x])
        if other.cost <= best.cost + PLAIN:
            tell(smooth)
            return other
    elif _late(best):
        # Beside what else is missing a single late drive may have been taken before all of them were.
        held.fit(smooth.nothing.hypothesis, [smooth.nothing.x])
        other = search(held, progress)
        if held.criterion(other) < smooth.criterion(best):
            tell(held)
            return other
    return best


def _late(fitted: EffortFit) -> bool:
    """Whether a set has something in it that acts late or is read late."""
    kin = {LATE, *catalogue()[LATE].confusable_with}
    return any(member.effect.name in kin for member in fitted.hypothesis.members)


def held_notes(recording: Recording) -> list[QualityNote]:
    """What is told of every effort of a recording that was found to be held."""
    return [
        QualityNote(
            "held_effort",
            effort.column or effort.name,
            "acts from each sample to the next, as a controller's command does, or half an interval late",
            "taken as held",
            len(recording.time),
            size=0.5 * recording.interval,
        )
        for effort in recording.efforts
    ]
