"""What closes the gate for code-scanning views: SARIF 2.1.0, and annotations of GitHub Actions."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from harness.cases.gate import Judgement
from harness.report.gate.closing import is_description
from harness.report.gate.places import Place, places

_SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"


def sarif(judgement: Judgement | None, files: Mapping[str, Path]) -> str:
    """SARIF text: a result for every row that closes the gate, at file and line of the model by case.

    Paths are relative to the working directory where they can be. Rows of the suite itself have no place in a file.
    """
    from harness import __version__

    found = places(judgement, files)
    quantities = sorted({place.judged.key.rsplit("/", 2)[1] for place in found})
    tool = {
        "name": "denoc gate",
        "version": __version__,
        "rules": [{"id": name, "shortDescription": {"text": name.replace("_", " ")}} for name in quantities],
    }
    run = {"tool": {"driver": tool}, "columnKind": "unicodeCodePoints", "results": [_result(place) for place in found]}
    return json.dumps({"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}, indent=1, ensure_ascii=False) + "\n"


def _result(place: Place) -> dict[str, Any]:
    case, quantity, engines = place.judged.key.rsplit("/", 2)
    result: dict[str, Any] = {
        "ruleId": quantity,
        "level": "error",
        "message": {
            "text": f"{case}, {quantity.replace('_', ' ')} ({engines.replace('+', ' against ')}): {place.said}"
        },
        "partialFingerprints": {"denocRow/v1": place.judged.key},
    }
    if place.path is not None:
        physical: dict[str, Any] = {"artifactLocation": {"uri": _relative(place.path)}}
        if place.line is not None:
            physical["region"] = {"startLine": place.line}
        result["locations"] = [{"physicalLocation": physical}]
    return result


def _relative(path: Path) -> str:
    whole = path.resolve()
    here = Path.cwd()
    return whole.relative_to(here).as_posix() if whole.is_relative_to(here) else whole.as_uri()


def github_annotations(judgement: Judgement, files: Mapping[str, Path]) -> list[str]:
    """Lines that GitHub Actions turns into annotations of the files in a pull request.

    It shows ten of a step: numbers of a description that changed stand first, and what several engines say is said once.
    """
    lines = []
    for place in sorted(places(judgement, files), key=lambda place: not is_description(place.judged)):
        case, quantity, _ = place.judged.key.rsplit("/", 2)
        where = ""
        if place.path is not None:
            where = f"file={_property(_relative(place.path))}" + (f",line={place.line}" if place.line else "") + ","
        title = case if place.judged.row is None else f"{case}: {quantity}"
        lines.append(f"::error {where}title={_property(title)}::{_message(place.said)}")
    lines = list(dict.fromkeys(lines))
    if judgement.reference:
        lines.append(f"::error title=denoc gate::{_message('the reference ' + judgement.reference)}")
    return lines


def _message(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _message(text).replace(":", "%3A").replace(",", "%2C")
