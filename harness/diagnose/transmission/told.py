"""What second encoders show, as rows of the document and in a sentence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.answer.curves import Residuals
from harness.diagnose.answer.explain import holding_up, untold
from harness.diagnose.answer.findings import in_words
from harness.diagnose.claims.grades import POSSIBLE, beside_a_remainder
from harness.diagnose.estimation.constants import NORMAL_95
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.inverse.effort_words import InWords, gathered
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.transmission.constants import COMPLETE_RATIO, FEWEST_RECORDINGS, LEAST_SHARE
from harness.diagnose.transmission.laws import LAWS
from harness.diagnose.transmission.regression import TwistFit, left, refitted
from harness.diagnose.transmission.twist import SECOND, TwistRun
from harness.recording.units import written

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class JointTwist:
    """A joint's twist and what explains it. candidates: of every law; unit: of the joint's position."""

    joint: str
    unit: str
    prismatic: bool
    train: Sequence[TwistRun]
    held: Sequence[TwistRun]
    fitted: TwistFit
    candidates: Sequence[Candidate]

    @property
    def channel(self) -> str:
        return f"{self.joint}.{SECOND}"

    @property
    def noise(self) -> float:
        return float(np.median([run.noise for run in (*self.train, *self.held)]))

    @property
    def explained(self) -> float:
        """Share of the mean-square twist on data held out, beside its zero, that the laws remove."""
        before, after = (_size(self.held, f) for f in (None, self.fitted))
        return 1.0 - (after / before) ** 2

    @property
    def complete(self) -> bool:
        """Whether the encoders' noise is all that is left of the data held out."""
        return _size(self.held, self.fitted) <= COMPLETE_RATIO * self.noise

    def fit(self) -> dict[str, Any]:
        """Its row of ``fit``: as read, and with what was found, both beside a zero of every recording, which is no error."""
        row: dict[str, Any] = {"channel": self.channel, "unit": self.unit, "noise_floor": self.noise}
        for name, fitted in (("nominal", None), ("refitted", None), ("augmented", self.fitted)):
            row[name] = {"train_rmse": _size(self.train, fitted), "heldout_rmse": _size(self.held, fitted)}
        return row

    def findings(self) -> list[dict[str, Any]]:
        """Its rows of ``findings``."""
        fitted, out = self.fitted, []
        repeats = self._repeats()
        for k, law in enumerate(fitted.laws):
            site, units = LAWS[law].site(self.joint), self.units(law)
            others = [self.candidates[r] for r in fitted.rivals[k]]
            rows = [
                {
                    "recording": name, "left_out": True,
                    "parameters": {p: {"value": e.value, "ci95": [e.low, e.high]} for p, e in each[k].items()},
                }
                for name, each in repeats
            ]  # fmt: skip
            out.append(
                {
                    "effect": LAWS[law].effect, "site": site,
                    "parameters": {p: e.document(units[p]) for p, e in self.values(k).items()},
                    "evidence": {
                        "delta_bic": fitted.delta[k], "probability": fitted.probability[k], "heldout_sigma": fitted.heldout[k],
                    },
                    "indistinguishable_from": [c.effect.name if c.site == site else c.key for c in others],
                    "grade": self._grade(k, rows),
                    "repeatability": rows,
                }
            )  # fmt: skip
        return out

    def values(self, k: int, shares: Array | None = None, spread: Array | None = None) -> dict[str, Estimate]:
        """The parameters of the k-th law, by its shares, one moved at a time; shares, spread: of the fit if None."""
        law, span = LAWS[self.fitted.laws[k]], self.fitted.laws.spans[k]
        own = (self.fitted.shares if shares is None else shares)[span].tolist()
        away = (self.fitted.spread if spread is None else spread)[span].tolist()
        best, out = law.values(own), {}
        for name, value in best.items():
            low = high = value
            for j in range(len(own)):
                # What gives its sign away may not be absent: a stiffness would be infinite.
                ends = [own[j] + sense * NORMAL_95 * away[j] for sense in (-1.0, 1.0)]
                if law.positive:
                    ends[0] = max(ends[0], LEAST_SHARE * own[j])
                there = [law.values([*own[:j], end, *own[j + 1 :]])[name] for end in ends]
                low, high = (
                    value - float(np.hypot(value - low, value - min(*there, value))),
                    value + float(np.hypot(high - value, max(*there, value) - value)),
                )
            out[name] = Estimate(value, (high - low) / (2.0 * NORMAL_95), low, high)
        return out

    def units(self, law: int) -> dict[str, str]:
        """Units of a law's parameters, as the catalogue has them."""
        own = self.candidates[law].effect
        units = own.units(prismatic=self.prismatic, channel_unit=self.unit)
        return dict(zip(own.parameter_names, units, strict=True))

    def residuals(self) -> list[Residuals]:
        """Twist over time, as read and with what was found, both less the recording's zero."""
        return [
            Residuals(
                self.channel, self.unit, run.name, held, self.noise, run.time, run.position,
                -left(run, None), -left(run, self.fitted),
            )
            for runs, held in ((self.train, False), (self.held, True))
            for run in runs
        ]  # fmt: skip

    def _repeats(self) -> list[tuple[str, list[dict[str, Estimate]]]]:
        """The laws' parameters with every recording left out in turn; none where there are two or fewer."""
        every = [*self.train, *self.held]
        names = list(dict.fromkeys(run.name for run in every))
        if len(names) < FEWEST_RECORDINGS or not self.fitted.laws:
            return []
        out = []
        for name in names:
            shares, spread = refitted([run for run in every if run.name != name], self.fitted)
            out.append((name, [self.values(k, shares, spread) for k in range(len(self.fitted.laws))]))
        return out

    def _grade(self, k: int, rows: Sequence[dict[str, Any]]) -> str:
        """How firmly a law stands: by what it explains of the twist beside what is left beyond the encoders' noise."""
        fitted, values = self.fitted, self.values(k)
        kept = np.delete(fitted.shares, fitted.laws.spans[k])
        less = replace(fitted, laws=fitted.laws.without(k), shares=kept)
        own, other = (np.concatenate([left(run, f) for run in self.train]) for f in (fitted, less))
        candidate = self.candidates[fitted.laws[k]]
        told = replace(candidate.effect, parameters=tuple(p for p in candidate.effect.parameters if p.name in values))
        return beside_a_remainder(
            replace(candidate, effect=told),
            values,
            rows,
            gain=float(np.sum(other**2) - np.sum(own**2)),
            excess=float(np.sum(own**2) - len(own) * self.noise**2),
            itself=not fitted.rivals[k],
        )


def sentence(joints: Sequence[JointTwist], rows: Sequence[Sequence[dict[str, Any]]]) -> str:
    """What second encoders show, in words; rows: the findings of each joint."""
    found, unsure = [], []
    for joint, own in zip(joints, rows, strict=True):
        for k, row in enumerate(own):
            if row["grade"] == POSSIBLE:
                continue
            law = joint.fitted.laws[k]
            title, values, units = joint.candidates[law].effect.title, joint.values(k), joint.units(law)
            found.append(InWords(title, row["site"], values, {name: units[name] for name in values}))
            if row["indistinguishable_from"]:
                unsure.append(untold(title, row["site"], [in_words(r) for r in row["indistinguishable_from"]]))
    worst = max(joints, key=lambda joint: _size(joint.held, joint.fitted) / joint.noise)
    size = _size(worst.held, worst.fitted)
    where = f"{size:.2g} {written(worst.unit)} at {worst.channel}"
    if not found:
        if all(joint.complete for joint in joints):
            return "The encoders behind the gears read what those of the drives do, beside their zeros."
        return (
            f"The encoders behind the gears read otherwise than those of the drives, by {where}, beside their zeros; nothing that "
            "was looked for (flexibility, play, lateness, gain) earns its place."
        )
    share = min(joint.explained for joint in joints if joint.fitted.laws)
    rest = (
        "what is left of the data held out is the encoders' noise"
        if all(joint.complete for joint in joints)
        else f"what is left of the data held out is {where} at most, {size / worst.noise:.2g} times the encoders' noise"
    )
    told = f"By the encoders behind the gears, {holding_up(gathered(found), share)}; {rest}."
    return " ".join([told, *unsure])


def _size(runs: Sequence[TwistRun], fitted: TwistFit | None) -> float:
    """Root mean square of what is left of the twist [position unit]."""
    return float(np.sqrt(np.mean(np.concatenate([left(run, fitted) for run in runs]) ** 2)))
