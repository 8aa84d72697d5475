"""Recordings that disagree with one another, in a sentence."""

from __future__ import annotations

from harness.diagnose.answer.claims_as_data import units_of
from harness.diagnose.answer.constants import NOTHING_SHARE, RECORDINGS_NAMED
from harness.diagnose.answer.findings import in_words
from harness.diagnose.levels.disagreement import Disagreement
from harness.diagnose.problem.problem import Problem
from harness.recording.units import written


def disagreement_words(found: Disagreement | None, problem: Problem) -> str:
    """That they do, by what, and how large that is in each; empty where they agree."""
    if found is None:
        return ""
    most = max(found.times.values())
    text = (
        f"The recordings disagree with one another: each by itself is explained to {most:.2g} times the noise at most with "
        f"{' and '.join(in_words(member.key) for member in found.members)}, all together by the same to {found.together:.3g} times."
    )
    k, name = found.differing[0]
    member = found.members[k]
    own = written(units_of(problem, member)[name])
    values = {run: of_run[k][name].value for run, of_run in found.values.items()}
    # Beside the largest, what is nothing but for rounding is nothing.
    little = NOTHING_SHARE * max(map(abs, values.values()))
    each = [f"{value:.3g} in {run}" if abs(value) > little else f"0 in {run}" for run, value in values.items()]
    more = f" and {len(each) - RECORDINGS_NAMED} more" if len(each) > RECORDINGS_NAMED else ""
    text += f" Most differs the {name} of {in_words(member.key)} [{own}]: {', '.join(each[:RECORDINGS_NAMED])}{more}."
    return f"{text} They may be of different rigs, or of one before and after a change: diagnose those that agree by themselves."
