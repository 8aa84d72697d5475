"""The search for sets of laws beside a force over the state: sets grow and shrink by that evidence alone.

Sets that leave a force out are not told apart by what they leave of free runs: the force is in the evidence, and what a law is
worth is what the recordings say beyond it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.constants import UNPARTED_EVIDENCE
from harness.diagnose.problem.hypothesis import Candidate, dear
from harness.diagnose.selection.constants.search import GENEROUS_PROMISE
from harness.diagnose.selection.constants.weighing import (
    BEHIND_EVIDENCE,
    FAR_REMAINDER_EVIDENCE,
    FEWEST_WAVES,
    HOPED_EVIDENCE,
    MEMBERS_TRIED_BESIDE,
    MOST_ROUNDS_BESIDE,
    OUT_OF_REACH_EVIDENCE,
    SETS_ABREAST,
)
from harness.diagnose.selection.rewrites.special_case import specialized
from harness.diagnose.selection.score_beside_force import promised, ranked_beside
from harness.diagnose.selection.score_tests import Score
from harness.diagnose.selection.state_evidence import (
    Evidence,
    curious,
    evidence_over_the_state,
    piece_of_a_force,
    placed,
    plainest,
    visited,
    without_placed,
)
from harness.diagnose.selection.study import Study

LEFT = "further sets of effects beside the force that is left out", "another set may be likelier, or as likely"


def likeliest_beside(study: Study, evidence: Evidence, seeds: Sequence[Fit], progress: Callable[[str], None]) -> Fit:
    """The plainest of the sets that are not parted from the likeliest one, of the seeds and what can be reached from them."""
    asked = [c for c in study.candidates if not placed(c) or _can_be_whole(study, c)]
    return plainest(_reached(study, evidence, seeds, progress, asked))


def _can_be_whole(study: Study, candidate: Candidate) -> bool:
    """Whether as many waves of it as tell it from a smooth force may have been seen."""
    periods = next((p for p in candidate.effect.parameters if p.name == "periods"), None)
    return periods is not None and visited(study, candidate) * periods.upper >= FEWEST_WAVES * 2.0 * np.pi


def plain_instead(study: Study, found: Fit, progress: Callable[[str], None]) -> Fit | None:
    """The plain set that beside a force over the state is likelier than this one, where there is such a one.

    Of a set that leaves nothing but noise: laws that can be bent to many shapes may be pieces of what nobody has named. Where one
    was chosen among many places, it is enough that the two are not parted. Each is weighed by what it leaves itself: plain laws
    whose force leaves the recordings by many times the noise explain nothing, however few samples of that are news.
    """
    if not curious(found):
        return None
    plain = sorted((f for f in study.fits.values() if not curious(f)), key=study.criterion)[:SETS_ABREAST]
    if not plain:
        return None
    evidence = evidence_over_the_state(study, study.likelihood.of_sensors, found, plain[0])
    if evidence is None:
        return None
    progress("plain laws and a force that is left out")
    own = evidence.criterion(study, found)
    if min(evidence.criterion(study, f) for f in plain) > own + OUT_OF_REACH_EVIDENCE:
        return None
    left = evidence.by_own_remainder(study, found)
    if min(evidence.by_own_remainder(study, f) for f in plain) > left + FAR_REMAINDER_EVIDENCE:
        return None
    rows = _reached(study, evidence, plain, progress, [c for c in study.candidates if c.effect.plain])
    likeliest = min(rows, key=lambda row: row[0])[1]
    spare = UNPARTED_EVIDENCE if any(map(placed, found.hypothesis.members)) else 0.0
    stands = evidence.by_own_remainder(study, likeliest) < left + spare
    return likeliest if stands else None


def _reached(
    study: Study,
    evidence: Evidence,
    seeds: Sequence[Fit],
    progress: Callable[[str], None],
    candidates: Sequence[Candidate],
) -> list[tuple[float, Fit]]:
    """The sets that can be reached from some with these candidates, each with its criterion.

    Where the time is up, those that were reached; raises TimeUp if there is none.
    """
    known: dict[frozenset[str], tuple[float, Fit]] = {}
    expanded: set[frozenset[str]] = set()

    def weigh(fitted: Fit) -> None:
        if fitted.hypothesis.identity not in known and not piece_of_a_force(study, fitted):
            known[fitted.hypothesis.identity] = evidence.criterion(study, fitted), fitted

    def front() -> list[Fit]:
        rows = sorted(known.values(), key=lambda row: row[0])
        rows = [row for row in rows if row[0] < rows[0][0] + BEHIND_EVIDENCE]
        # The plainest of what is not parted will be taken: that is looked for as well.
        chosen = rows[:SETS_ABREAST] + [row for row in rows[SETS_ABREAST:] if not curious(row[1])][:1]
        return [fitted for _, fitted in chosen if fitted.hypothesis.identity not in expanded]

    begun = [without_placed(study, fitted) for fitted in seeds]
    if study.predictor.deadline.limited:
        # The time may be up before all are weighed, and a set that leaves more is less likely.
        begun.sort(key=lambda fitted: fitted.score)

    def grown() -> None:
        for fitted in begun:
            # Where one of them has ended in a wrong valley, the others begun from it would end there too.
            evidence.beside(study, fitted, by_itself=True)
        for fitted in begun:
            weigh(fitted)
        for _ in range(MOST_ROUNDS_BESIDE):
            asked = front()
            if not asked:
                return
            progress(" + ".join(asked[0].hypothesis.keys) or "nothing")
            for fitted in asked:
                expanded.add(fitted.hypothesis.identity)
                for k in range(len(fitted.hypothesis.members)):
                    weigh(study.reduce(fitted, k))
                for special in specialized(study, fitted):
                    weigh(special)
                for found in _promising(study, evidence, fitted, candidates):
                    weigh(study.extend(fitted, found))

    def so_far() -> None:
        # What leaves least may take longest to weigh: it is not passed over for what happened to be weighed before, nor is nothing.
        nearest = min(begun, key=lambda fitted: fitted.score)
        for fitted in begun:
            if evidence.has(fitted) or fitted is nearest or not fitted.hypothesis.members:
                weigh(fitted)

    deadline = study.predictor.deadline
    deadline.attempt(*LEFT, grown, so_far)
    if not known:
        deadline.check()
    return list(known.values())


def _promising(study: Study, evidence: Evidence, fitted: Fit, candidates: Sequence[Candidate]) -> list[Score]:
    """Further members that are worth fitting beside a set and its force, those that promise most first.

    The usual laws are all asked about; of others those by whose score they might pay. What is dear to run is weighed only where the
    search under noise alone came upon it.
    """
    ranked = ranked_beside(evidence, study, fitted, [c for c in candidates if not dear(c)])
    usual = [s for s in ranked if s.candidate.effect.plain]
    others = [s for s in ranked if not s.candidate.effect.plain]
    asked = (
        usual
        + [s for s in others if GENEROUS_PROMISE * s.gain > evidence.price(study, s.candidate)][:MEMBERS_TRIED_BESIDE]
    )
    rows = [(promised(evidence, study, fitted, s), s) for s in asked]
    return [s for gain, s in sorted(rows, key=lambda row: -row[0]) if gain > -HOPED_EVIDENCE][:MEMBERS_TRIED_BESIDE]
