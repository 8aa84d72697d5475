"""The answer where there was no time for any: what was recorded, and that nothing is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.answer.explain import untried
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.problem.deadline import Deadline
from harness.diagnose.problem.problem import Problem
from harness.recording import Recording

NOTHING = ("the fit of the nominal model, and all that comes after it", "nothing is known of what the model left out")


def crude_noise(problem: Problem) -> list[Mapping[str, Any]]:
    """How loud the channels are, by what needs no model."""
    return [
        {"channel": channel.name, "std": colour.std, "unit": channel.unit}
        for channel, colour in zip(problem.channels, crude_colours(problem), strict=True)
    ]


def nothing_fitted(
    noise: Sequence[Mapping[str, Any]], recordings: Sequence[Recording], deadline: Deadline
) -> Diagnosis:
    """What may be said before the nominal model has been fitted: how loud the recordings are."""
    deadline.leave(*NOTHING)
    return Diagnosis(
        verdict="unexplained",
        summary=untried(deadline.not_tried),
        noise=noise,
        mismatch=(),
        findings=(),
        ranking=(),
        fit=(),
        remainder={"significant": False, "tests": [], "doubted": []},
        next_experiment={"what": "", "separates": []},
        quality=[
            {"recording": r.name, "kind": n.kind, "channel": n.channel, "what": n.what, "done": n.done}
            for r in recordings
            for n in r.quality
        ],
        not_tried=deadline.not_tried,
    )
