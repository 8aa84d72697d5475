"""The gate's answer for a program."""

from __future__ import annotations

import json
from typing import Any

from harness.cases.gate import Judged, Judgement, SelfTest
from harness.cases.results import Results, row_as_dict


def as_dict(results: Results, judgement: Judgement | None, trials: SelfTest | None) -> str:
    """``denoc.results/1`` as JSON text with ``accepted``, ``change`` and ``reason`` in each row, and ``self_test``.

    ``not_asked``: how many accepted rows were not held, by the engine that was not asked for.
    """
    document: dict[str, Any] = results.to_json()
    del document["series"]
    if judgement is not None:
        document["rows"] = [_row(judged) for judged in judgement.rows]
        document["reference"] = judgement.reference
        document["not_asked"] = dict(judgement.not_asked)
        document["versions_changed"] = {name: list(pair) for name, pair in judgement.versions_changed.items()}
    document["ok"] = (judgement is None or judgement.ok) and (trials is None or trials.ok)
    document["self_test"] = None if trials is None else trials.as_dict()
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)


def _row(judged: Judged) -> dict[str, Any]:
    if judged.row is not None:
        values = row_as_dict(judged.row)
    else:
        case, quantity, engines = judged.key.rsplit("/", 2)
        values = {
            "case": case,
            "quantity": quantity,
            "engines": engines.split("+"),
            "difference": None,
            "allowed": None,
            "unit": None,
            "why_allowed": "",
            "verdict": "missing",
            "note": judged.reason,
            "first_divergence": None,
        }
    return {**values, "accepted": judged.accepted, "change": judged.change, "ok": judged.ok, "reason": judged.reason}
