"""The answer of a diagnosis, immutable, for people and programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from markupsafe import Markup

from harness.diagnose.answer.curves import Curves
from harness.diagnose.answer.findings import MODIFIED_BY, Findings, numbers_of, one_by_one, rivals_of
from harness.diagnose.answer.replay import Opening, replay, replayable
from harness.diagnose.problem.deadline import NotTried
from harness.effects.force_table import ForceTable
from harness.system import System

SCHEMA = "denoc.diagnosis/1"
__all__ = ["MODIFIED_BY", "SCHEMA", "Diagnosis", "Findings", "numbers_of", "one_by_one", "rivals_of"]


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """What a diagnosis found; fields as in ``denoc.diagnosis/1``.

    verdict: "consistent", "explained", "partly_explained" or "unexplained". augmented: the model with the findings attached.
    curves: what the plots are drawn from. opening: from where the augmented model runs again; replay: how it does so in other
    engines, once asked for (``replayed``). levels, levelled: dry friction that differs from recording to recording, and the model
    with its laws fitted beside such levels, where recordings ask for them. disagreement: what each recording says by itself, where
    they disagree with one another. explained_share: share of the nominal model's
    mean-square mismatch on data held out that the findings remove. discrepancy: the force that they leave out, a row a joint.
    predicting, predictive: effects of the set that predicts best where a force is left out, and the model with them;
    unnamed_force: the force over the state that is one of them, if it is. provenance:
    what the answer was made from. correlations: of the parameters told. notes: what reading the model left out, one line each.
    not_tried: what was left when the time was up.
    """

    verdict: str
    summary: str
    noise: Sequence[Mapping[str, Any]]
    mismatch: Sequence[Mapping[str, Any]]
    findings: Findings | Sequence[Mapping[str, Any]]
    ranking: Sequence[Mapping[str, Any]]
    fit: Sequence[Mapping[str, Any]]
    remainder: Mapping[str, Any]
    next_experiment: Mapping[str, Any]
    quality: Sequence[Mapping[str, Any]] = ()
    augmented: System | None = None
    curves: Curves | None = None
    levels: Mapping[str, Any] | None = None
    levelled: System | None = None
    disagreement: Mapping[str, Any] | None = None
    opening: Opening | None = None
    replay: Sequence[Mapping[str, Any]] = ()
    explained_share: float | None = None
    discrepancy: Sequence[Mapping[str, Any]] = ()
    predicting: Sequence[str] = ()
    predictive: System | None = None
    unnamed_force: ForceTable | None = None
    provenance: Mapping[str, Any] | None = None
    correlations: Mapping[str, Any] | None = None
    notes: Sequence[str] = ()
    not_tried: Sequence[NotTried] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "findings", Findings(self.findings))

    @property
    def complete(self) -> bool:
        """Whether nothing was left because the time was up."""
        return not self.not_tried

    def replayed(self) -> Diagnosis:
        """The same answer with the augmented model run in every installed engine that can express what was found."""
        if self.augmented is None or self.opening is None or not replayable(self.augmented):
            return self
        return replace(self, replay=replay(self.augmented, self.opening))

    def to_json(self) -> dict[str, Any]:
        """The document ``denoc.diagnosis/1`` as plain data; numbers that are not finite become null."""
        document = {
            "schema": SCHEMA,
            "verdict": self.verdict,
            "complete": self.complete,
            "summary": self.summary,
            "noise": list(self.noise),
            "mismatch": list(self.mismatch),
            "findings": list(self.findings),
            "ranking": list(self.ranking),
            "fit": list(self.fit),
            "remainder": dict(self.remainder),
            "next_experiment": dict(self.next_experiment),
            "quality": list(self.quality),
            "explained_share": self.explained_share,
            "discrepancy": list(self.discrepancy),
            "notes": list(self.notes),
        }
        if self.predictive is not None:
            document["predictive"] = {"effects": list(self.predicting)}
        if not self.complete:
            document["not_tried"] = [{"what": n.what, "may_change": n.may_change} for n in self.not_tried]
        if self.replay:
            document["replay"] = list(self.replay)
        if self.levels is not None:
            document["levels"] = dict(self.levels)
        if self.disagreement is not None:
            document["disagreement"] = dict(self.disagreement)
        if self.correlations is not None:
            document["correlations"] = dict(self.correlations)
        if self.provenance is not None:
            document["provenance"] = dict(self.provenance)
        plain = _plain(document)
        assert isinstance(plain, dict)
        return plain

    def to_frame(self) -> Any:
        """What was found as a ``pandas.DataFrame``, a row a parameter; ImportError where pandas is not installed."""
        return Findings(self.findings).to_frame()

    def __str__(self) -> str:
        found = Findings(self.findings)
        return f"{self.verdict}: {self.summary}" + (f"\n\n{found}" if found else "")

    def __repr__(self) -> str:
        names = ", ".join(f"{f['effect']}@{f['site']}" for f in one_by_one(self.findings))
        return f"<Diagnosis: {self.verdict}{f', {names}' if names else ''}>"

    def _repr_html_(self) -> str:
        """Verdict, summary and findings, for notebooks."""
        told = Markup("<p><strong>{}</strong>: {}</p>").format(self.verdict.replace("_", " "), self.summary)
        return str(told) + (Findings(self.findings)._repr_html_() if self.findings else "")


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, (bool, str)) or value is None:
        return value
    if isinstance(value, (int, np.integer)):
        return int(value)
    number = float(value)
    return number if np.isfinite(number) else None
