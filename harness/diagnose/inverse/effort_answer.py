"""What a diagnosis of efforts tells: findings, tests of what is left, ranking, where and when, the next experiment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.answer.augmented import augmented
from harness.diagnose.answer.constants import SHOWN_HYPOTHESES
from harness.diagnose.answer.curves import Curves, ForceMap, Residuals
from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.answer.explain import Foretold, finding_words, untold
from harness.diagnose.answer.findings import in_words
from harness.diagnose.answer.left_out import explained_share
from harness.diagnose.claims.grades import POSSIBLE
from harness.diagnose.criticism.constants import LOCATED_PIECES
from harness.diagnose.estimation.constants import NORMAL_95
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.inverse.effort_fit import EffortFit, fit_effort, spread
from harness.diagnose.inverse.effort_grades import grade, repeatability, without_each
from harness.diagnose.inverse.effort_left import effort_left
from harness.diagnose.inverse.effort_motion import EffortRun
from harness.diagnose.inverse.effort_search import EffortStudy
from harness.diagnose.inverse.effort_tests import root_mean_square, tests_of
from harness.diagnose.inverse.effort_words import pushed, shown_as, summary
from harness.diagnose.inverse.pushes import Push
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.effects.effect import SiteKind
from harness.recording.recording import QualityNote, Recording
from harness.recording.units import written
from harness.system import System

Array = NDArray[np.float64]

POINTS = 4000  # of a curve
UNREPEATED = ("whether what was found repeats in every recording", "grades may be too low")
UNRIVALLED = (
    "what else could stand in the place of each effect claimed",
    "more effects may be as likely as those told",
)


@dataclass(eq=False)
class EffortAnswer:
    """Everything that the document is told from."""

    system: System
    recordings: Sequence[Recording]
    runs: Sequence[EffortRun]
    study: EffortStudy
    best: EffortFit
    pushes: Sequence[Push]
    notes: Sequence[QualityNote]
    cutoff: float
    training: int

    def document(self) -> Diagnosis:
        study, best = self.study, self.best
        empty = study.fits[frozenset()]
        nominal = fit_effort(
            study.data, Hypothesis(), np.zeros(study.nominal), frozen=np.ones(study.nominal, dtype=bool)
        )
        rows, severity = self._fit(nominal, empty)
        tests = tests_of(self.system, self.recordings, study, best, self.pushes)
        incomplete = bool(tests)
        findings, titles, rivals, pairs = self._findings(remainder=incomplete)
        different = bool(best.hypothesis.members)
        if not different:
            verdict = "unexplained" if incomplete else "consistent"
        else:
            verdict = "partly_explained" if incomplete else "explained"
        values = [self._estimates(k) for k in range(len(best.hypothesis.members))]
        explained = explained_share(rows)
        left = effort_left(self.system, (study.data, study.held), best) if incomplete else None
        return Diagnosis(
            verdict=verdict,
            summary=" ".join(
                filter(
                    None,
                    [
                        summary(verdict, severity, self.cutoff, titles, rivals, Foretold.worst(rows), explained, left),
                        self._pushed(),
                        shown_as(tests),
                    ],
                )
            ),
            explained_share=explained,
            discrepancy=left.document() if left is not None else [],
            noise=[
                {"channel": self._channel(j), "std": study.data.noises[j].std, "unit": self._unit(j)} for j in study.data.joints
            ],
            mismatch=self._mismatch(nominal) if different or incomplete else [],
            findings=findings,
            ranking=self._ranking(),
            fit=rows,
            remainder={"significant": incomplete, "tests": tests, "doubted": []},
            next_experiment=_next(pairs),
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
            curves=self._curves(nominal),
        )  # fmt: skip

    def _channel(self, joint: int) -> str:
        return f"{self.system.joint_names[joint]}.effort"

    def _unit(self, joint: int) -> str:
        return self.system.joint(self.system.joint_names[joint]).force_unit

    def _fit(self, nominal: EffortFit, empty: EffortFit) -> tuple[list[dict[str, Any]], float]:
        rows, severity = [], 0.0
        for j in self.study.data.joints:
            floor = self.study.data.noises[j].std
            row: dict[str, Any] = {"channel": self._channel(j), "unit": self._unit(j)}
            for name, fitted in (("nominal", nominal), ("refitted", empty), ("augmented", self.best)):
                row[name] = {
                    "train_rmse": root_mean_square(self.study.data, fitted, j),
                    "heldout_rmse": root_mean_square(self.study.held, fitted, j),
                }
            row["noise_floor"] = floor
            severity = max(severity, row["nominal"]["train_rmse"] / floor)
            rows.append(row)
        return rows, severity

    def _estimates(self, k: int) -> dict[str, Estimate]:
        member = self.best.hypothesis.members[k]
        first = self.study.nominal + self.best.hypothesis.span(k).start
        sigma = spread(self.best, self.study.nominal)
        out = {}
        for j, parameter in enumerate(member.effect.parameters):
            value, s = float(self.best.x[first + j]), float(sigma[first + j])
            span = 1e-6 * float(member.scales[j])
            bound = value <= parameter.lower + span or value >= parameter.upper - span
            low, high = max(value - NORMAL_95 * s, parameter.lower), min(value + NORMAL_95 * s, parameter.upper)
            out[parameter.name] = Estimate(value, None if bound else s, low, high)
        return out

    def _units(self, member: Candidate) -> dict[str, str]:
        joint = (
            self.system.joint(member.site.split(".")[0])
            if member.effect.site in (SiteKind.JOINT, SiteKind.CHANNEL)
            else None
        )
        units = member.effect.units(
            prismatic=joint is not None and joint.prismatic, channel_unit=joint.position_unit if joint else "rad"
        )
        return dict(zip(member.effect.parameter_names, units, strict=True))

    def _pushed(self) -> str:
        worst = max(self.pushes, key=lambda p: abs(p.peak), default=None)
        return pushed(self.pushes, self.recordings, written(self._unit(worst.joint))) if worst is not None else ""

    def _share(self, smaller: EffortFit) -> float:
        """What a member explains that is missing in a smaller set, in units of what is left beyond the noise (squares)."""
        data = self.study.data
        own, other = (float(np.sum(data.rows(f.hypothesis, f.x) ** 2)) for f in (self.best, smaller))
        left = own - data.samples
        return (other - own) / left if left > 0.0 else np.inf

    def _findings(self, *, remainder: bool) -> tuple[list[dict[str, Any]], list[str], list[str], list[tuple[str, str]]]:
        study, best, deadline = self.study, self.best, self.study.data.model.deadline
        weights = {key: study.criterion(f) for key, f in study.fits.items()}
        lowest = min(weights.values())
        share = {key: float(np.exp(-0.5 * (w - lowest))) for key, w in weights.items()}
        total = sum(share.values())
        findings, titles, rivals, pairs = [], [], [], []
        again: list[tuple[str, EffortFit]] = deadline.attempt(
            *UNREPEATED, lambda: without_each((study.data, study.held), best), lambda: []
        )
        for k, member in enumerate(best.hypothesis.members):
            values, units = self._estimates(k), self._units(member)
            smaller = study.reduce(best, k)
            alike: list[tuple[Candidate, EffortFit]] = deadline.attempt(
                *UNRIVALLED, partial(study.rivals, best, k), lambda: []
            )
            others = [c for c, _ in alike]
            names = [c.effect.name if c.site == member.site else c.key for c in others]
            repeats = repeatability(again, study.nominal, k)
            how = grade(member, values, repeats, share=self._share(smaller), rivals=bool(names), remainder=remainder)
            probability = sum(s for key, s in share.items() if member.key in key) / total
            findings.append(
                {
                    "effect": member.effect.name,
                    "site": member.site,
                    "parameters": {
                        name: {"value": e.value, "std": e.std, "ci95": [e.low, e.high], "unit": units[name]}
                        for name, e in values.items()
                    },
                    "evidence": {
                        "delta_bic": study.criterion(smaller) - study.criterion(best), "probability": probability,
                        "heldout_sigma": study.heldout_z(smaller, best),
                    },
                    "indistinguishable_from": names,
                    "grade": how,
                    "repeatability": repeats,
                }
            )  # fmt: skip
            if how != POSSIBLE:
                titles.append(finding_words(member.effect.title, member.site, values, units))
            if names and how != POSSIBLE:
                rivals.append(untold(member.effect.title, member.site, list(map(in_words, names))))
            pairs += [(member.effect.name, c.effect.name) for c in others]
        return findings, titles, rivals, pairs

    def _ranking(self) -> list[dict[str, Any]]:
        study = self.study
        others = sorted((f for f in study.fits.values() if f is not self.best), key=study.weight)
        rows = []
        for f in [self.best, *others][:SHOWN_HYPOTHESES]:
            errors = {self._channel(j): root_mean_square(study.held, f, j) for j in study.data.joints}
            rows.append(
                {
                    "effects": list(f.hypothesis.keys),
                    "bic": study.criterion(f),
                    "heldout_rmse": next(iter(errors.values())),
                    "heldout": errors,
                }
            )
        return rows

    def _mismatch(self, nominal: EffortFit) -> list[dict[str, Any]]:
        member = next(iter(self.best.hypothesis.members), None)
        side, site = (member.effect.side, member.site) if member else ("input", self.system.joint_names[0])
        residuals = self.study.data.model.residuals(nominal.hypothesis, nominal.x)
        out = []
        for j in self.study.data.joints:
            floor = self.study.data.noises[j].std
            times, powers, q, v = [], [], [], []
            for run, residual in zip(self.study.data.model.runs, residuals, strict=True):
                for index in np.array_split(np.arange(len(run.time)), LOCATED_PIECES):
                    part = index[run.usable[index]]
                    if len(part) and float(np.sqrt(np.mean(residual[part, j] ** 2))) > 2.0 * floor:
                        times.append((float(run.time[part[0]]), float(run.time[part[-1]])))
                        q.append(run.q[part, j])
                        v.append(run.qd[part, j])
                powers.append(np.where(run.usable, residual[:, j], 0.0))
            if not times:
                continue
            step = float(self.study.data.model.runs[0].time[1])
            density = np.abs(np.fft.rfft(powers[0] * np.hanning(len(powers[0])))) ** 2
            share = np.cumsum(density) / max(float(density.sum()), 1e-300)
            frequency = np.fft.rfftfreq(len(powers[0]), step)
            band = [float(frequency[np.searchsorted(share, part)]) for part in (0.05, 0.95)]
            positions, velocities = np.concatenate(q), np.concatenate(v)
            severity = root_mean_square(self.study.data, nominal, j) / floor
            out.append(
                {
                    "channel": self._channel(j), "side": side, "site": site, "time": [list(t) for t in _joined(times)],
                    "frequency_hz": band,
                    "region": {
                        "position": [float(positions.min()), float(positions.max())],
                        "velocity": [float(velocities.min()), float(velocities.max())],
                    },
                    "severity": severity,
                    "what": "the motion needs another effort than was recorded",
                }
            )  # fmt: skip
        return out

    def _curves(self, nominal: EffortFit) -> Curves:
        residuals, forces = [], []
        study = self.study
        for part, held in ((study.data, False), (study.held, True)):
            before = part.model.residuals(nominal.hypothesis, nominal.x)
            after = part.model.residuals(self.best.hypothesis, self.best.x)
            for j in study.data.joints:
                for run, a, b in zip(part.model.runs, before, after, strict=True):
                    if not run.driven[j]:
                        continue
                    pick = slice(None, None, max(1, len(run.time) // POINTS))
                    blank = np.where(run.usable, 1.0, np.nan)[pick]
                    residuals.append(
                        Residuals(
                            self._channel(j), self._unit(j), run.name, held, study.data.noises[j].std, run.time[pick],
                            run.effort[pick, j], a[pick, j] * blank, b[pick, j] * blank,
                        )
                    )  # fmt: skip
                    if not held:
                        use = np.flatnonzero(run.usable)[:: max(1, int(run.usable.sum()) // 1000)]
                        forces.append((j, run.q[use, j], run.qd[use, j], a[use, j]))
        maps = [
            ForceMap(
                self.system.joint_names[j],
                (self.system.joint(self.system.joint_names[j]).position_unit, self._unit(j)),
                *(np.concatenate([row[k] for row in forces if row[0] == j]) for k in (1, 2, 3)),
            )
            for j in study.data.joints
        ]
        return Curves(tuple(residuals), (), tuple(maps), ())


def _joined(intervals: list[tuple[float, float]]) -> list[tuple[float, float]]:
    joined: list[tuple[float, float]] = []
    for low, high in sorted(intervals):
        if joined and low <= joined[-1][1] + 0.15 * (high - low):
            joined[-1] = (joined[-1][0], max(high, joined[-1][1]))
        else:
            joined.append((low, high))
    return [(round(a, 3), round(b, 3)) for a, b in joined]


# Effects that scale everything else the effort is held against.
SCALES = ("actuator_gain", "payload_mass", "added_inertia", "com_offset")


def _next(pairs: list[tuple[str, str]]) -> dict[str, Any]:
    """The experiment that would part what cannot be told apart."""
    for pair in pairs:
        if "actuator_gain" in pair:
            return {
                "what": "hang a known weight on the arm and record again: what it adds to the effort is known, "
                "so that the effort's scale shows",
                "separates": list(pair),
            }
    for pair in pairs:
        if set(pair) <= set(SCALES):
            return {
                "what": "let the arm swing freely, undriven: its period fixes inertia over gravity torque",
                "separates": list(pair),
            }
    for pair in pairs:
        return {"what": "drive slowly through the whole range in both directions, then fast", "separates": list(pair)}
    return {"what": "", "separates": []}
