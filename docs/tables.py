"""Puts the tables of `reference/*.json` where a page of the documentation names them: `python docs/tables.py`.

A page says `<!-- table reference/paper_damping.json open_question -->`, and `<!-- end of table -->` behind it; what stands
between is replaced. Tests hold the pages against the files.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

from harness.report.paper import markdown_table

ROOT = Path(__file__).parents[1]
PLACE = re.compile(r"(<!-- table (\S+) (\S+) -->\n).*?(<!-- end of table -->)", re.DOTALL)


def filled(page: str) -> str:
    """The page with the tables that it names."""

    def table(found: re.Match[str]) -> str:
        told = json.loads((ROOT / found[2]).read_text(encoding="utf-8"))["tables"][found[3]]
        return f"{found[1]}{markdown_table(told['heads'], told['rows'])}{found[4]}"

    return PLACE.sub(table, page)


if __name__ == "__main__":
    for path in sorted((ROOT / "docs").glob("*.md")):
        old = path.read_text(encoding="utf-8")
        if (new := filled(old)) != old:
            path.write_text(new, encoding="utf-8")
            print(f"wrote {path.relative_to(ROOT)}")
