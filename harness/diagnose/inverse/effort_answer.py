"""What a diagnosis of efforts tells: findings, tests of what is left, ranking, where and when, the next experiment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import f as fisher
from scipy.stats import norm

from harness.diagnose.answer.augmented import augmented
from harness.diagnose.answer.curves import Curves, ForceMap, Residuals
from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.answer.explain import finding_words
from harness.diagnose.answer.findings import in_words
from harness.diagnose.estimation.intervals import WIDE, Estimate
from harness.diagnose.inverse.effort_fit import EffortData, EffortFit, fit_effort, spread
from harness.diagnose.inverse.effort_motion import EffortRun
from harness.diagnose.inverse.effort_search import EffortStudy
from harness.diagnose.inverse.pushes import Push
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.effects.effect import SiteKind
from harness.recording.recording import QualityNote, Recording
from harness.system import System

Array = NDArray[np.float64]

CHANCE = 1e-4  # at which a shape left in the residual counts
SHARE = 0.05  # of the residual's variance that it must explain besides
WORSE = 1.3  # times the training residual that the held-out one may be
SHOWN = 8  # hypotheses in the ranking
PIECES = 24  # of a recording, in which the nominal model is judged
POINTS = 4000  # of a curve
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
        tests = self._tests()
        incomplete = bool(tests)
        findings, titles, rivals, pairs = self._findings()
        different = bool(best.hypothesis.members)
        if not different:
            verdict = "unexplained" if incomplete else "consistent"
        else:
            verdict = "partly_explained" if incomplete else "explained"
        values = [self._estimates(k) for k in range(len(best.hypothesis.members))]
        return Diagnosis(
            verdict=verdict,
            summary=self._summary(verdict, severity, titles, rivals, tests),
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

    def _plain(self, data: EffortData, fitted: EffortFit, joint: int) -> Array:
        return data.plain(data.model.residuals(fitted.hypothesis, fitted.x), joint)

    def _rms(self, data: EffortData, fitted: EffortFit, joint: int) -> float:
        values = self._plain(data, fitted, joint)
        return float(np.sqrt(np.mean(values**2))) if len(values) else float("nan")

    def _fit(self, nominal: EffortFit, empty: EffortFit) -> tuple[list[dict[str, Any]], float]:
        rows, severity = [], 0.0
        for j in self.study.data.joints:
            floor = self.study.data.noises[j].std
            row: dict[str, Any] = {"channel": self._channel(j), "unit": self._unit(j)}
            for name, fitted in (("nominal", nominal), ("refitted", empty), ("augmented", self.best)):
                row[name] = {
                    "train_rmse": self._rms(self.study.data, fitted, j),
                    "heldout_rmse": self._rms(self.study.held, fitted, j),
                }
            row["noise_floor"] = floor
            severity = max(severity, row["nominal"]["train_rmse"] / floor)
            rows.append(row)
        return rows, severity

    def _tests(self) -> list[dict[str, Any]]:
        """What is still in the residual: shapes over the state, a worse fit of the data held out, pushes."""
        out: list[dict[str, Any]] = []
        best, study = self.best, self.study
        residuals = study.data.model.residuals(best.hypothesis, best.x)
        taken = len(best.x)
        for j in study.data.joints:
            shapes, left = [], []
            for run, grid, residual in zip(study.data.model.runs, study.data.grids, residuals, strict=True):
                for s in grid.stretches:
                    if run.driven[j]:
                        shapes.append(_shapes(run, j, s))
                        left.append(residual[s, j])
            design, target = np.concatenate(shapes), np.concatenate(left)
            total = float(target @ target)
            rest = target - design @ np.linalg.lstsq(design, target, rcond=1e-8)[0]
            explained = total - float(rest @ rest)
            dof = len(target) - design.shape[1] - taken
            ratio = (explained / design.shape[1]) / max(float(rest @ rest) / max(dof, 1), 1e-300)
            chance = float(fisher.sf(ratio, design.shape[1], max(dof, 1)))
            if chance < CHANCE and explained > SHARE * total:
                where = self.system.joint_names[j]
                out.append({"what": f"a smooth force over the state at {where}", "gain": explained / study.data.noises[j].std**2,
                            "chance": chance, "heldout_sigma": None, "where": [where]})  # fmt: skip
            held, floor = self._rms(study.held, best, j), self._rms(study.data, best, j)
            count = max(study.held.samples, 2)
            unsure = float(
                np.linalg.norm([_unsureness(self._plain(data, best, j)) for data in (study.held, study.data)])
            )
            z = float(np.log(held / floor)) / unsure if floor > 0.0 and unsure > 0.0 else 0.0
            if held > WORSE * floor and z > 5.0:
                out.append({"what": "a worse fit of the data held out", "gain": (held / floor) ** 2 * count - count,
                            "chance": float(norm.sf(z)), "heldout_sigma": None,
                            "where": [f"{held / floor:.2f} times the training data's residual"]})  # fmt: skip
            z_size = best.prior
            if z_size > 0.0 and study.nominal:
                worst = int(np.argmax(np.abs(best.x[: study.nominal])))
                if abs(best.x[worst]) > 5.0:
                    quantity = study.data.model.nominal[worst]
                    out.append({"what": "nominal quantities outside their tolerance", "gain": z_size,
                                "chance": float(2.0 * norm.sf(abs(best.x[worst]))), "heldout_sigma": None,
                                "where": [f"{quantity.kind} of {quantity.name} by {best.x[worst]:+.1f} of its σ"]})  # fmt: skip
        for push in self.pushes:
            joint = self.system.joint_names[push.joint]
            where = (
                f"{self.recordings[push.run].name}, {push.first:.2f} to {push.last:.2f} s, up to {-push.peak:+.2g} "
                + self._unit(push.joint).replace("*", "·")
            )
            gain = (push.peak / self.study.data.noises[push.joint].std) ** 2
            out.append({"what": f"a force that acts once at {joint}", "gain": gain,
                        "chance": 0.0, "heldout_sigma": None, "where": [joint, where]})  # fmt: skip
        return out

    def _estimates(self, k: int) -> dict[str, Estimate]:
        member = self.best.hypothesis.members[k]
        first = self.study.nominal + self.best.hypothesis.span(k).start
        sigma = spread(self.best, self.study.nominal)
        out = {}
        for j, parameter in enumerate(member.effect.parameters):
            value, s = float(self.best.x[first + j]), float(sigma[first + j])
            span = 1e-6 * float(member.scales[j])
            bound = value <= parameter.lower + span or value >= parameter.upper - span
            low, high = max(value - WIDE * s, parameter.lower), min(value + WIDE * s, parameter.upper)
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

    def _findings(self) -> tuple[list[dict[str, Any]], list[str], list[str], list[tuple[str, str]]]:
        study, best, deadline = self.study, self.best, self.study.data.model.deadline
        weights = {key: study.criterion(f) for key, f in study.fits.items()}
        lowest = min(weights.values())
        share = {key: float(np.exp(-0.5 * (w - lowest))) for key, w in weights.items()}
        total = sum(share.values())
        findings, titles, rivals, pairs = [], [], [], []
        for k, member in enumerate(best.hypothesis.members):
            values, units = self._estimates(k), self._units(member)
            smaller = study.reduce(best, k)
            alike: list[tuple[Candidate, EffortFit]] = deadline.attempt(
                *UNRIVALLED, partial(study.rivals, best, k), lambda: []
            )
            others = [c for c, _ in alike]
            names = [c.effect.name if c.site == member.site else c.key for c in others]
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
                }
            )  # fmt: skip
            titles.append(finding_words(member.effect.title, member.site, values, units))
            if names:
                rivals.append(
                    f"{member.effect.title.capitalize()} cannot be told here from {', '.join(map(in_words, names))}."
                )
                pairs += [(member.effect.name, c.effect.name) for c in others]
        return findings, titles, rivals, pairs

    def _ranking(self) -> list[dict[str, Any]]:
        study = self.study
        others = sorted((f for f in study.fits.values() if f is not self.best), key=study.weight)
        rows = []
        for f in [self.best, *others][:SHOWN]:
            errors = {self._channel(j): self._rms(study.held, f, j) for j in study.data.joints}
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
                for index in np.array_split(np.arange(len(run.time)), PIECES):
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
            severity = self._rms(self.study.data, nominal, j) / floor
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

    def _summary(
        self, verdict: str, severity: float, titles: list[str], rivals: list[str], tests: list[dict[str, Any]]
    ) -> str:
        size = f"by {severity:.3g} times the noise"
        left = f"The effort that the nominal model needs for the recorded motion leaves the recorded one {size}"
        band = f"below {self.cutoff:.2g} Hz, where accelerations can be read off the recorded angle"
        hold = "hold" if len(titles) > 1 else "holds"
        text = {
            "consistent": f"The effort that the model needs for the recorded motion agrees with the recorded one ({band}).",
            "explained": f"{left} ({band}); with {' and '.join(titles)} the residual is at the noise, also on data held out.",
            "partly_explained": f"{left} ({band}); {' and '.join(titles)} {hold} up on data held out, but there is more.",
            "unexplained": f"{left} ({band}), and nothing in the catalogue earns its place.",
        }[verdict]
        if rivals:
            text += " " + " ".join(rivals)
        others = [t for t in tests if "acts once" not in t["what"]]
        if self.pushes:
            worst = max(self.pushes, key=lambda p: abs(p.peak))
            times = "stretches" if len(self.pushes) > 1 else "stretch"
            text += (
                f" Something outside pushes in {len(self.pushes)} {times}, most in "
                f"{self.recordings[worst.run].name} at {worst.first:.1f} s with {-worst.peak:+.2g} N·m; "
                "that is left out of every fit."
            )
        if others:
            text += f" What is left shows as {others[0]['what']} ({', '.join(others[0]['where'])})."
        return text

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


def _unsureness(values: Array) -> float:
    """Standard deviation of the logarithm of the values' root mean square, heavy tails (reversals) counted."""
    power = values**2
    return 0.5 * float(np.std(power)) / (float(np.mean(power)) * float(np.sqrt(len(power)))) if power.any() else 0.0


def _shapes(run: EffortRun, j: int, s: NDArray[np.intp]) -> Array:
    """Smooth forces over the state of a joint that no ordinary torque has, shape (len(s), 8)."""
    q, v, a = run.q[s, j], run.qd[s, j], run.qdd[s, j]
    fast, quick = max(float(np.abs(run.qd[:, j]).max()), 1e-12), max(float(np.abs(run.qdd[:, j]).max()), 1e-12)
    w, b = v / fast, a / quick
    return np.stack(
        [np.cos(q), np.sin(2.0 * q), np.cos(2.0 * q), w * np.sin(q), w**2, w**3, w * b, b * np.abs(b)], axis=1
    )


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
