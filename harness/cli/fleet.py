"""``denoc diagnose --fleet``: every unit of a folder."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from harness.cli.interrupt import Interrupted
from harness.cli.options import console, progress, say_notes, write_json


def diagnose_all(
    folder: str, model: str | None, out: Path, json_file: str | None, *, strict: bool, **options: Any
) -> int:
    """Diagnose, print the table, write it; 1 where units failed, or with ``strict`` where one is not explained."""
    from harness.errors import InputError
    from harness.fleet import diagnose_fleet
    from harness.json_text import json_text
    from harness.report.fleet import print_fleet, write_fleet

    limit = options["time_limit"]
    if limit is not None and not limit > 0.0:
        raise InputError(f"a time limit of {limit:g} s", mend="give the seconds that each unit may take")
    if limit is not None and math.isinf(limit):
        options["time_limit"] = None
    if options["dask"] is None:
        # Each process would compile its own kernels.
        from harness.denoc.compiling import ahead

        ahead.everything()
    with progress("fleet") as step:
        try:
            found = diagnose_fleet(folder, model, out=out, progress=step, **options)
        except KeyboardInterrupt:
            raise Interrupted(f"stopped; the same command goes on from here (what is done is in {out})") from None
    document = found.to_json()
    screen = console(json_file)
    if document["others"]:
        some = ", ".join(document["others"][:3]) + (", …" if len(document["others"]) > 3 else "")
        say_notes([f"{folder}: {some}: no recording by its ending, left out"])
    print_fleet(document, screen)
    for path in write_fleet(found, out):
        screen.print(f"wrote {path}", markup=False)
    write_json(json_text(document), json_file)
    unexplained = sum(
        count for verdict, count in document["verdicts"].items() if verdict not in ("consistent", "explained")
    )
    return 1 if document["failed"] or (strict and unexplained) else 0
