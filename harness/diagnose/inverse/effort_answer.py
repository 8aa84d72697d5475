"""What a diagnosis of efforts tells: findings, tests of what is left, ranking, where and when, the next experiment."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.answer.against_nominal import beside_findings
from harness.diagnose.answer.augmented import augmented
from harness.diagnose.answer.constants import SHOWN_HYPOTHESES
from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.answer.explain import Foretold
from harness.diagnose.answer.left_out import explained_share
from harness.diagnose.claims.grades import verdict_of
from harness.diagnose.inverse.effort_findings import effort_findings
from harness.diagnose.inverse.effort_fit import EffortFit, fit_effort
from harness.diagnose.inverse.effort_grades import estimates
from harness.diagnose.inverse.effort_left import effort_left
from harness.diagnose.inverse.effort_motion import EffortRun
from harness.diagnose.inverse.effort_next import next_experiment
from harness.diagnose.inverse.effort_search import EffortStudy
from harness.diagnose.inverse.effort_shown import channel, curves, mismatch, unit
from harness.diagnose.inverse.effort_tests import root_mean_square, tests_of
from harness.diagnose.inverse.effort_words import may_be_one_force, pushed, shown_as, summary
from harness.diagnose.inverse.pushes import Push
from harness.diagnose.problem.deadline import TimeUp
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.recording.recording import QualityNote, Recording
from harness.recording.units import written
from harness.system import System

Array = NDArray[np.float64]


@dataclass(eq=False)
class EffortAnswer:
    """Everything that the document is told from. doubtful: keys of members of the set that nobody had the time to judge."""

    system: System
    recordings: Sequence[Recording]
    runs: Sequence[EffortRun]
    study: EffortStudy
    best: EffortFit
    pushes: Sequence[Push]
    notes: Sequence[QualityNote]
    cutoff: float
    training: int
    doubtful: frozenset[str] = frozenset()
    _errors: dict[EffortFit, dict[str, float]] = field(default_factory=dict)  # on data held out, by fit

    def document(self) -> Diagnosis:
        study, best = self.study, self.best
        empty = study.fits[frozenset()]
        nominal = fit_effort(
            study.data, Hypothesis(), np.zeros(study.nominal), frozen=np.ones(study.nominal, dtype=bool)
        )
        rows, severity = self._fit(nominal, empty)
        tests = tests_of(self.system, self.recordings, study, best, self.pushes)
        incomplete = bool(tests)
        # What no answer should do without comes before the further fits that findings ask for as long as there is time.
        explained = explained_share(rows)
        left = effort_left(self.system, (study.data, study.held), best) if incomplete else None
        differing = mismatch(self.system, study, nominal, best) if best.hypothesis.members or incomplete else []
        shown, ranking = curves(self.system, study, nominal, best), self._ranking()
        found = effort_findings(self.system, study, best, remainder=incomplete, doubtful=self.doubtful)
        with suppress(TimeUp):
            ranking = self._ranking()
        different = bool(best.hypothesis.members)
        if not different:
            verdict = "unexplained" if incomplete else "consistent"
        else:
            verdict = "partly_explained" if incomplete else "explained"
        # The words say "for certain" where something is possible.
        graded = verdict_of(verdict, (str(row["grade"]) for row in found.rows))
        values = [estimates(best, study.nominal, k) for k in range(len(best.hypothesis.members))]
        return Diagnosis(
            verdict=graded,
            summary=" ".join(
                filter(
                    None,
                    [
                        summary(
                            verdict, severity, self.cutoff, found.titles, found.rivals, Foretold.worst(rows), explained, left,
                            hurried=bool(study.data.model.deadline.not_tried), beside=len(found.titles) < len(found.rows),
                        ),
                        *(beside_findings(study.data.model.nominal, best.x, rows) if found.titles else ()),
                        may_be_one_force(found.of_any_shape),
                        self._pushed(),
                        shown_as(tests),
                    ],
                )
            ),
            explained_share=explained,
            discrepancy=left.document() if left is not None else [],
            noise=[
                {"channel": channel(self.system, j), "std": study.data.noises[j].std, "unit": unit(self.system, j)}
                for j in study.data.joints
            ],
            mismatch=differing,
            findings=list(found.rows),
            ranking=ranking,
            fit=rows,
            remainder={"significant": incomplete, "tests": tests, "doubted": []},
            next_experiment=next_experiment(found.pairs, gravity=bool(np.any(self.system.gravity))),
            quality=[
                {"recording": self.recordings[p.run].name, "kind": n.kind, "channel": n.channel, "what": n.what, "done": n.done}
                for p, n in zip(self.pushes, self.notes, strict=True)
            ]
            + [
                {"recording": r.name, "kind": n.kind, "channel": n.channel, "what": n.what, "done": n.done}
                for r in self.recordings
                for n in r.quality
            ],
            augmented=augmented(
                self.system,
                self.study.data.model.nominal,
                self.best.x,
                zip(self.best.hypothesis.members, values, strict=True),
            ),
            curves=shown,
        )  # fmt: skip

    def _fit(self, nominal: EffortFit, empty: EffortFit) -> tuple[list[dict[str, Any]], float]:
        rows, severity = [], 0.0
        for j in self.study.data.joints:
            floor = self.study.data.noises[j].std
            row: dict[str, Any] = {"channel": channel(self.system, j), "unit": unit(self.system, j)}
            for name, fitted in (("nominal", nominal), ("refitted", empty), ("augmented", self.best)):
                row[name] = {
                    "train_rmse": root_mean_square(self.study.data, fitted, j),
                    "heldout_rmse": root_mean_square(self.study.held, fitted, j),
                }
            row["noise_floor"] = floor
            severity = max(severity, row["nominal"]["train_rmse"] / floor)
            rows.append(row)
        return rows, severity

    def _pushed(self) -> str:
        worst = max(self.pushes, key=lambda p: abs(p.peak), default=None)
        return (
            pushed(self.pushes, self.recordings, written(unit(self.system, worst.joint))) if worst is not None else ""
        )

    def _ranking(self) -> list[dict[str, Any]]:
        study = self.study
        others = sorted((f for f in study.fits.values() if f is not self.best), key=study.weight)
        rows = []
        for f in [self.best, *others][:SHOWN_HYPOTHESES]:
            if f not in self._errors:
                self._errors[f] = {
                    channel(self.system, j): root_mean_square(study.held, f, j) for j in study.data.joints
                }
            errors = self._errors[f]
            rows.append(
                {
                    "effects": list(f.hypothesis.keys),
                    "bic": study.criterion(f),
                    "heldout_rmse": next(iter(errors.values())),
                    "heldout": errors,
                }
            )
        return rows
