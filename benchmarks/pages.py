"""What the scripts that write tables into pages of the documentation share."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any


def put(page: Path, begin: str, end: str, text: str) -> None:
    """Replace what stands between two marks of a page; SystemExit where it has not both."""
    old = page.read_text(encoding="utf-8")
    if begin not in old or end not in old:
        raise SystemExit(f"{page}: no {begin} … {end} to write between")
    before, rest = old.split(begin, 1)
    page.write_text(f"{before}{begin}\n{text}\n{end}{rest.split(end, 1)[1]}", encoding="utf-8")


def errors(entry: Mapping[str, Any] | None) -> str:
    """Held-out error from the first sample / with the initial state fitted; a dash where there is none."""
    held = (entry or {}).get("heldout")
    return f"{held['first_sample']:.3g} / {held['state_fitted']:.3g}" if held else "–"
