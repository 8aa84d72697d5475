"""The answer of a diagnosis, immutable, for people and programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.diagnose.answer.curves import Curves
from harness.diagnose.answer.replay import Opening, replay, replayable
from harness.diagnose.problem.deadline import NotTried
from harness.system import System

SCHEMA = "denoc.diagnosis/1"
MODIFIED_BY = "modified_by"  # of a finding: others that only alter how this one acts, such as creep of dry friction


def one_by_one(findings: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Findings and what modifies them, each by itself."""
    return [each for finding in findings for each in (finding, *finding.get(MODIFIED_BY, ()))]


def numbers_of(finding: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """The parameters of a finding, and the zeros of recordings if it lists them, by name: ``value``, ``unit``, and their spread if
    it is known."""
    zeros = {
        f"zero of {zero['recording']}": {"value": zero["zero"], "unit": zero["unit"]}
        for zero in finding.get("zeros", ())
    }
    return {**finding["parameters"], **zeros}


def rivals_of(finding: Mapping[str, Any]) -> list[str]:
    """What a finding cannot be told from, with what would have to stand beside it if it could only so."""
    beside = finding.get("only_beside", {})
    return [
        f"{rival} (beside {' or '.join(beside[rival])})" if rival in beside else str(rival)
        for rival in finding.get("indistinguishable_from", ())
    ]


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """What a diagnosis found; fields as in ``denoc.diagnosis/1``.

    verdict: "consistent", "explained", "partly_explained" or "unexplained". augmented: the model with the findings attached.
    curves: what the plots are drawn from. opening: from where the augmented model runs again; replay: how it does so in other
    engines, once asked for (``replayed``). levels, levelled: dry friction that differs from recording to recording, and the model
    with its laws fitted beside such levels, where recordings ask for them. not_tried: what was left when the time was up.
    """

    verdict: str
    summary: str
    noise: Sequence[Mapping[str, Any]]
    mismatch: Sequence[Mapping[str, Any]]
    findings: Sequence[Mapping[str, Any]]
    ranking: Sequence[Mapping[str, Any]]
    fit: Sequence[Mapping[str, Any]]
    remainder: Mapping[str, Any]
    next_experiment: Mapping[str, Any]
    quality: Sequence[Mapping[str, Any]] = ()
    augmented: System | None = None
    curves: Curves | None = None
    levels: Mapping[str, Any] | None = None
    levelled: System | None = None
    opening: Opening | None = None
    replay: Sequence[Mapping[str, Any]] = ()
    not_tried: Sequence[NotTried] = ()

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
        }
        if not self.complete:
            document["not_tried"] = [{"what": n.what, "may_change": n.may_change} for n in self.not_tried]
        if self.replay:
            document["replay"] = list(self.replay)
        if self.levels is not None:
            document["levels"] = dict(self.levels)
        plain = _plain(document)
        assert isinstance(plain, dict)
        return plain

    def __str__(self) -> str:
        return f"{self.verdict}: {self.summary}"


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
