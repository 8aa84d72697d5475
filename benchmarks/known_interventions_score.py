"""What is judged of a known intervention, written down before the first case was run.

- *named*: a finding that is more than ``possible`` is the change itself at its place (``exactly``), or says that it cannot be told
  from the change (``in class``). What is found beside it is listed and not judged: friction, load and mounting differ between the
  states of a real rig, by how much nobody knows.
- *interval holds*: where it is named exactly, the 95 % interval of its size holds what was weighed or measured. ``like`` is a
  second figure where the catalogue's effect is a simplification of the change (discs are no points: the point mass that makes
  the same swing is another one); whether the interval holds that is told beside and not counted.
- *false headline*: something is claimed, and none of it is the change.
- *cannot tell*: nothing is claimed.
- *told as possible*: not named, but a finding that is no more than ``possible`` is the change itself at its place, or says that it
  cannot be told from it. (Added when answers first had such findings of the likeliest laws; counted apart.)
- *failed*: the diagnosis ended with an error. (Added when the last case did; it belongs to all that is counted.)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from harness.diagnose.answer.diagnosis import one_by_one
from harness.proof.score import Share

EXACTLY, IN_CLASS, FALSE, SILENT, FAILED = "exactly", "in class", "false", "silent", "failed"


def _name(text: str) -> str:
    """The effect's name in ``effect`` or ``effect@site``."""
    return text.split("@", 1)[0]


def _held(interval: Sequence[float | None] | None, value: float | None) -> bool | None:
    """Whether an interval holds a value; None where there is none, or nothing to hold."""
    if interval is None or value is None or None in interval:
        return None
    low, high = (float(x) for x in interval if x is not None)
    return low <= value <= high


def _size(answer: Mapping[str, Any], found: Mapping[str, Any], parameter: str) -> dict[str, Any]:
    """What was found of one parameter, beside what is true."""
    true, like, estimate = answer["parameters"][parameter], answer["like"].get(parameter), found[parameter]
    interval = estimate.get("ci95")
    return {
        "parameter": parameter, "unit": estimate["unit"], "true": true, "like": like, "value": estimate["value"],
        "ci95": interval, "holds": bool(_held(interval, true)), "holds_like": _held(interval, like),
    }  # fmt: skip


def scored(name: str, answer: Mapping[str, Any], found: Mapping[str, Any]) -> dict[str, Any]:
    """One row: a sealed answer against a diagnosis (``denoc.diagnosis/1`` as data)."""
    error = found.get("error")
    if error is not None:
        found = {"findings": [], "verdict": "error", "summary": error}
    every = one_by_one(found["findings"])
    claims = [f for f in every if f.get("grade") != "possible"]
    itself, alike = _the_change(claims, answer)
    maybe, maybe_alike = _the_change([f for f in every if f.get("grade") == "possible"], answer)
    told = [f"{f['effect']}@{f['site']}" for f in claims]
    row: dict[str, Any] = {
        "case": name, "rig": answer["rig"], "what": answer["what"], "kind": answer["kind"],
        "expected": {key: answer[key] for key in ("effect", "site", "parameters", "like")},
        "verdict": found["verdict"], "told": told, "summary": found["summary"], "seconds": found.get("seconds"),
    }  # fmt: skip
    by = itself or alike
    possible = None if by else maybe or maybe_alike
    row["named"] = EXACTLY if itself else IN_CLASS if by else FALSE if claims else FAILED if error else SILENT
    row["by"] = None if by is None else f"{by['effect']}@{by['site']}"
    row["possible"] = None if possible is None else f"{possible['effect']}@{possible['site']}"
    row["beside"] = [t for t in told if t != row["by"]]
    row["sizes"] = [] if itself is None else [_size(answer, itself["parameters"], p) for p in answer["parameters"]]
    return row


def _the_change(
    findings: Sequence[Mapping[str, Any]], answer: Mapping[str, Any]
) -> tuple[Mapping[str, Any] | None, Mapping[str, Any] | None]:
    """The finding that is the change itself, and the first that cannot be told from it."""
    itself = (f for f in findings if (f["effect"], f["site"]) == (answer["effect"], answer["site"]))
    alike = (f for f in findings if answer["effect"] in map(_name, f.get("indistinguishable_from", ())))
    return next(itself, None), next(alike, None)


def _share(hits: int, of: int) -> dict[str, Any]:
    low, high = Share(hits, of).interval
    return {"hits": hits, "of": of, **({"wilson95": [round(low, 3), round(high, 3)]} if of else {})}


def shares(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Counts over all cases, with Wilson 95 % intervals."""
    count = {kind: sum(row["named"] == kind for row in rows) for kind in (EXACTLY, IN_CLASS, FALSE, SILENT, FAILED)}
    sizes = [size for row in rows for size in row["sizes"]]
    likes = [size["holds_like"] for size in sizes if size["holds_like"] is not None]
    return {
        "named": _share(count[EXACTLY] + count[IN_CLASS], len(rows)),
        "named_exactly": _share(count[EXACTLY], len(rows)),
        "told_as_possible": _share(sum(row["possible"] is not None for row in rows), len(rows)),
        "false_headline": _share(count[FALSE], len(rows)),
        "cannot_tell": _share(count[SILENT], len(rows)),
        "failed": _share(count[FAILED], len(rows)),
        "interval_holds": _share(sum(size["holds"] for size in sizes), len(sizes)),
        "interval_holds_like": _share(sum(likes), len(likes)),
        "rigs": sorted({row["rig"] for row in rows}),
    }
