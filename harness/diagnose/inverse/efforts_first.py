"""What recorded efforts tell of a motion: laws that its search may begin with, and the answer while there is no time to run it.

Running the motion of an arm with each of a hundred effects takes minutes, inverse dynamics along it seconds. Where there is a
limit, arms of many joints have their efforts asked first; of one or two joints the motion comes first, and leaves some of the time.
What the efforts tell is the answer if the limit leaves the motion without one. Beside a force that is left out, free runs have many
wrong valleys and efforts along the recorded motion none, so that what they tell is one of the sets that the search weighs, too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.answer.explain import untried
from harness.diagnose.claims.grades import ESTABLISHED, LIKELY
from harness.diagnose.inverse.constants import (
    EFFORTS_FIRST_JOINTS,
    EFFORTS_FIRST_SHARE,
    MOTION_FIRST_SHARE,
    SEEDING_SHARE,
)
from harness.diagnose.inverse.effort import diagnose_effort
from harness.diagnose.problem.deadline import Deadline, NotTried
from harness.errors import InputError, UnsupportedError
from harness.recording.recording import Recording
from harness.system import System

UNRUN = NotTried(
    "runs of the motion itself, and with them effects that have a memory or coordinates of their own",
    "what was found in the efforts may stand in for such an effect, such as play or a joint that gives",
)
UNFINISHED = replace(UNRUN, what=f"further {UNRUN.what}")
BY_EFFORTS = "By the recorded efforts, since"
# Nothing is called well, and nothing complete, that was looked at from one side only.
WEAKER = {"consistent": "unexplained", "explained": "partly_explained"}


@dataclass(eq=False)
class ByEfforts:
    """The answer by efforts of a mechanism whose every joint has its position and effort recorded.

    ask: for it, by a deadline; None where it cannot be asked for. motion: the deadline of the motion's own answer. early: what was
    asked for before the motion is run, where there is a limit.
    """

    ask: Callable[[Deadline], Diagnosis] | None
    deadline: Deadline
    motion: Deadline
    early: Diagnosis | None = None
    _laws: Mapping[str, Mapping[str, float]] | None = field(default=None, init=False)

    def laws(self) -> Mapping[str, Mapping[str, float]]:
        """Numbers of what efforts find, by the effect's key; asked for once, and empty where that cannot be."""
        if self._laws is None:
            found = self.early
            if found is None and self.ask is not None and not self.deadline.interrupted:
                found = _asked(self.ask, self.motion.part(SEEDING_SHARE))
            self._laws = {
                f"{row['effect']}@{row['site']}": {name: told["value"] for name, told in row["parameters"].items()}
                for row in (found.findings if found is not None else ())
            }
        return self._laws

    def instead(self, found: Diagnosis | None) -> Diagnosis | None:
        """The answer by efforts where the motion's own was cut short (None: before it had any) with nothing claimed."""
        answered = found is not None and (found.complete or _claims(found))
        hurried = self.deadline.limited and not self.deadline.interrupted
        if not answered and self.early is None and self.ask is not None and hurried:
            self.early = _asked(self.ask, self.deadline.part(1.0))
        return instead(found, self.early)


def by_efforts(
    system: System,
    recordings: Sequence[Recording],
    held: Recording | None,
    *,
    only: Sequence[str],
    tell: Callable[[str], None],
    deadline: Deadline,
) -> ByEfforts:
    """The answer by efforts, of arms of many joints asked for at once where there is a limit."""
    every = [*recordings, *([held] if held is not None else [])]
    # Of mechanisms whose efforts cannot be fitted the motion has all of the time.
    if system.flexible or system.drives or not all(_whole(system, one) for one in every):
        return ByEfforts(None, deadline, deadline)

    def ask(by: Deadline) -> Diagnosis:
        return diagnose_effort(system, recordings, held, only=only, tell=tell, deadline=by)

    if not deadline.limited:
        return ByEfforts(ask, deadline, deadline)
    if len(system.joint_names) < EFFORTS_FIRST_JOINTS:
        return ByEfforts(ask, deadline, deadline.part(MOTION_FIRST_SHARE))
    return ByEfforts(ask, deadline, deadline, _asked(ask, deadline.part(EFFORTS_FIRST_SHARE)))


def _asked(ask: Callable[[Deadline], Diagnosis], deadline: Deadline) -> Diagnosis | None:
    try:
        found = ask(deadline)
    except (InputError, UnsupportedError):
        # It is the motion that was asked about.
        return None
    return found if found.fit else None


def instead(found: Diagnosis | None, by_effort: Diagnosis | None) -> Diagnosis | None:
    """The answer by efforts where the motion's own was cut short (None: before it had any) with nothing claimed.

    Where the efforts claim nothing either, the motion's own stays, which says what is left and where.
    """
    if by_effort is None or (found is not None and (found.complete or _claims(found) or not _claims(by_effort))):
        return found
    why = (
        "there was no time to run the motion" if found is None else "the time was up before the motion claimed anything"
    )
    not_tried = (*by_effort.not_tried, UNRUN if found is None else UNFINISHED)
    # The answer by efforts ends with what it left untried itself: all of it is told in one sentence.
    told = by_effort.summary.removesuffix(untried(by_effort.not_tried)).rstrip()
    summary = f"{BY_EFFORTS} {why}: {told} {untried(not_tried)}"
    findings = [
        {**finding, "grade": LIKELY} if finding.get("grade") == ESTABLISHED else finding
        for finding in by_effort.findings
    ]
    return replace(
        by_effort,
        verdict=WEAKER.get(by_effort.verdict, by_effort.verdict),
        summary=summary,
        findings=findings,
        not_tried=not_tried,
    )


def _whole(system: System, recording: Recording) -> bool:
    placed = {c.site for c in recording.channels if c.quantity == "position"}
    driven = {c.site for c in recording.efforts}
    return set(system.joint_names) <= placed & driven


def _claims(found: Diagnosis) -> bool:
    return any(finding.get("grade") != "possible" for finding in found.findings)
