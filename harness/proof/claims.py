"""What any tool claims of sealed cases, in a small file, and its score against the answers.

``denoc.claims/1``::

    {"schema": "denoc.claims/1", "entrant": "name and version",
     "cases": {"case-001": {"findings": [{"effect": "coulomb_friction", "site": "pivot",
                                          "parameters": {"torque": {"value": 0.0118, "ci95": [0.0114, 0.0122]}},
                                          "indistinguishable_from": []}],
                            "verdict": "consistent | explained | partly_explained | unexplained",
                            "heldout_rmse": 0.0031, "seconds": 12.5}}}

Of a case only ``findings`` has to be there; empty means that nothing is missing. Effects, parameters and sites are the
catalogue's words. Without ``verdict`` a case with findings is explained, one without consistent. Cases that are not in
the file count as failed.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from harness.effects.catalogue import catalogue
from harness.errors import InputError
from harness.proof.score import CaseScore, Share, score_case
from harness.proof.sharpness import sharpness

SCHEMA = "denoc.claims/1"
OWN = ("findings", "verdict", "heldout_rmse", "seconds")  # what an entrant says of a case
VERDICTS = ("consistent", "explained", "partly_explained", "unexplained")


@dataclass(frozen=True)
class Claims:
    """A claims file. entrant: who says so; cases: what is said, by case."""

    entrant: str
    cases: Mapping[str, Mapping[str, Any]]


def read_claims(path: Path) -> Claims:
    """A ``denoc.claims/1`` file; InputError, naming case and finding, where it is none."""

    def wrong(what: str, mend: str = "see `denoc prove --help` and the README.md of an export") -> InputError:
        return InputError(what, source=path, mend=mend)

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        names = [name for name, _ in pairs]
        for name in names:
            if names.count(name) > 1:
                raise wrong(f'has "{name}" more than once in one object', "write it with a JSON library")
        return dict(pairs)

    try:
        # With or without a mark of its encoding, as some editors write it.
        data = json.loads(Path(path).read_text(encoding="utf-8-sig"), object_pairs_hook=once)
    except RecursionError:
        raise wrong("is nested too deep for any claims", "see the README.md of an export") from None
    except (OSError, UnicodeDecodeError) as error:
        raise wrong(f"cannot be read: {getattr(error, 'strerror', None) or error}", "give a JSON file") from None
    except json.JSONDecodeError as error:
        raise InputError(
            f"is no JSON: {error.msg}", source=path, line=error.lineno, mend="write it with a JSON library"
        ) from None
    except InputError:
        raise
    except ValueError as error:  # a whole number of thousands of digits
        raise wrong(f"cannot be read: {error}", "write it with a JSON library") from None
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise wrong(f'does not say "schema": "{SCHEMA}"')
    cases = data.get("cases")
    if not isinstance(cases, dict) or not cases:
        raise wrong('has no "cases", an object of what is claimed by case')
    known = {name: {p.name for p in effect.parameters} for name, effect in catalogue().items()}
    for case, said in cases.items():
        if not isinstance(said, dict) or not isinstance(said.get("findings"), list):
            raise wrong(f'case {case} has no "findings", a list (empty if nothing is missing)')
        if said.get("verdict", "consistent") not in VERDICTS:
            raise wrong(f"case {case} has the verdict {said['verdict']!r}", f"one of {', '.join(VERDICTS)}")
        if said["findings"] and said.get("verdict") == "consistent":
            raise wrong(f"case {case} is consistent and has findings", "leave the one or the other away")
        for number, finding in enumerate(said["findings"], 1):
            _check(finding, f"case {case}, finding {number}", known, wrong)
        told = [f"{f['effect']} at {f['site']}" for f in said["findings"]]
        for twice in told:
            if told.count(twice) > 1:
                raise wrong(f"case {case} claims {twice} more than once", "claim it once")
        for key in ("heldout_rmse", "seconds"):
            if not _number(said.get(key, 0.0)) or said.get(key, 0.0) < 0.0:
                raise wrong(f"case {case} has a {key} that is no number of nothing or more: {str(said[key])[:40]!r}")
    entrant = data.get("entrant") or Path(path).stem  # empty as in the template of an export
    if not isinstance(entrant, str):
        raise wrong('has an "entrant" that is no text', "name who claims this")
    return Claims(entrant, cases)


def _number(value: Any) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # a whole number beyond any float
        return False


def _check(finding: Any, where: str, known: Mapping[str, set[str]], wrong: Any) -> None:
    if (
        not isinstance(finding, dict)
        or not isinstance(finding.get("effect"), str)
        or not isinstance(finding.get("site"), str)
    ):
        raise wrong(f'{where} has no "effect" and "site", both text')
    effect = finding["effect"]
    if effect not in known:
        raise wrong(f"{where} names {effect!r}, which the catalogue does not know", "its words are in docs/effects.md")
    if not isinstance(finding.get("parameters", {}), dict):
        raise wrong(f'{where} has "parameters" that are no object')
    if not isinstance(finding.get("indistinguishable_from", []), list):
        raise wrong(f'{where} has "indistinguishable_from" that is no list')
    for other in finding.get("indistinguishable_from", []):
        if not isinstance(other, str) or other.partition("@")[0] not in known:
            raise wrong(
                f'{where} has {str(other)[:40]!r} in "indistinguishable_from", which the catalogue does not know',
                "its words are in docs/effects.md",
            )
    for name, estimate in finding.get("parameters", {}).items():
        if name not in known[effect]:
            raise wrong(
                f"{where} has a parameter {name!r}", f"{effect} has {', '.join(sorted(known[effect])) or 'none'}"
            )
        if not isinstance(estimate, dict) or not _number(estimate.get("value")):
            raise wrong(f'{where}, {name} has no "value", a number')
        ends = estimate.get("ci95")
        if ends is not None and not (
            isinstance(ends, list) and len(ends) == 2 and all(map(_number, ends)) and ends[0] <= ends[1]
        ):
            raise wrong(f'{where}, {name} has a "ci95" that is not [low, high]')
        if ends is not None and not ends[0] <= estimate["value"] <= ends[1]:
            raise wrong(f'{where}, {name} has a "value" outside its own "ci95"')


def as_found(said: Mapping[str, Any] | None) -> dict[str, Any]:
    """What was said of a case in the form that diagnoses are scored in; None or an error: no answer."""
    if said is None or "findings" not in said:
        reason = "no answer" if said is None else str(said.get("error") or said.get("skipped") or "no answer")
        return {"error": reason}
    findings = [
        {
            "effect": f["effect"],
            "site": f["site"],
            "parameters": f.get("parameters", {}),
            "indistinguishable_from": f.get("indistinguishable_from", []),
        }
        for f in said["findings"]
    ]
    verdict = said.get("verdict") or ("explained" if findings else "consistent")
    return {"verdict": verdict, "findings": findings, "seconds": said.get("seconds", float("nan"))}


def score_claims(claims: Mapping[str, Mapping[str, Any]], answers: Mapping[str, Mapping[str, Any]]) -> list[CaseScore]:
    """Scores of every answered case; ``answers`` are sealed answers by case."""
    return [score_case(name, answer, as_found(claims.get(name))) for name, answer in answers.items()]


def tally(
    scores: list[CaseScore], said: Mapping[str, Mapping[str, Any]], answers: Mapping[str, Mapping[str, Any]]
) -> dict[str, Any]:
    """One line of the table of peers: named, false, coverage, error held out, seconds.

    named_single: the truth is what was claimed or what that was said to be indistinguishable from, as far as that is believed
    (``alike``); named_exactly: the former alone; worth_single, listed_single, interval_width, interval_score: ``sharpness``. What
    was asked and not answered is not named. asked leaves out what a method is not made for (not_for_it). heldout_over_noise:
    median over cases of the error held out, in standard deviations of the sensor's noise. coverage95: intervals of rightly named
    effects that hold the truth. claims: how often each effect was claimed, by what was concealed.
    """
    passed_by = {name for name, what in said.items() if "skipped" in what}
    scores = [s for s in scores if s.name not in passed_by]
    answered = [s for s in scores if s.verdict != "error"]
    clean = [s for s in answered if s.kind == "clean"]
    single = [s for s in scores if s.kind == "single"]
    inside = [low <= true <= high for s in answered if s.in_class for _, _, true, _, _, low, high in s.parameters]
    errors = [
        float(said[s.name]["heldout_rmse"]) / float(answers[s.name]["noise_std"])
        for s in answered
        if s.name in said and said[s.name].get("heldout_rmse") is not None and answers[s.name].get("noise_std")
    ]
    seconds = [s.seconds for s in answered if np.isfinite(s.seconds)]
    claimed: dict[str, dict[str, int]] = {}
    for s in (*clean, *(s for s in single if s.verdict != "error")):
        row = claimed.setdefault(s.planted[0][0] if s.planted else "nothing", {})
        for effect in {e for e, _ in s.found} or {"nothing"}:
            row[effect] = row.get(effect, 0) + 1
    return {
        "asked": len(scores),
        "failed": len(scores) - len(answered),
        "not_for_it": len(passed_by),
        "clean_false": _pair([bool(s.found) for s in clean]),
        "named_single": _pair([s.in_class for s in single]),
        "named_exactly": _pair([s.exact for s in single]),
        **sharpness(scores),
        "false_beside_single": _pair([bool(s.false) for s in single if s.verdict != "error"]),
        "coverage95": _pair(inside),
        "heldout_over_noise": float(np.median(errors)) if errors else None,
        "seconds": float(np.median(seconds)) if seconds else None,
        "claims": claimed,
    }


def _pair(hits: list[bool]) -> list[int]:
    share = Share(sum(hits), len(hits))
    return [share.hits, share.of]
