"""``denoc diagnose --engine``: what do an engine's equations lack, by a recording?"""

from __future__ import annotations

from pathlib import Path

from harness.cli.options import console, write_json


def diagnose_engine(
    recordings: tuple[str, ...],
    model: str,
    engine: str,
    mapping: tuple[str, ...],
    allow: tuple[str, ...],
    out: Path | None,
    json_file: str | None,
    *,
    strict: bool,
    floating: bool = False,
) -> int:
    """Which terms of an engine's equation of motion a recording asks to be mended; 1 under ``strict`` if there are any."""
    from harness.cases.case import NATIVE
    from harness.compare.balance import balance
    from harness.engines import registry
    from harness.errors import InputError, UnsupportedError
    from harness.json_text import json_text
    from harness.recording import read_recording
    from harness.report.balance import balance_document, balance_picture, print_balance
    from harness.system import load
    from harness.whole_files import write_folder

    if len(recordings) != 1:
        raise InputError("--engine takes one recording", mend="give them one after the other")
    if engine == NATIVE:
        raise InputError(
            f"{NATIVE} is what other engines are held against",
            mend=f"leave out --engine: diagnose asks the same of {NATIVE}",
        )
    system = load(model, allow=allow, floating=floating)
    doubted = registry.engine(engine)
    doubted.version()
    reason = doubted.refuses(system)
    if reason:
        raise InputError(f"{engine} cannot run it: {reason}", source=model, mend="give a model within its reach")
    read = read_recording(recordings[0], mapping=mapping, system=system)
    try:
        found = balance(read, system, doubted.build(system), registry.engine(NATIVE).build(system))
    except UnsupportedError as lacking:
        raise InputError(
            f"{engine} does not tell its equation term by term: {lacking.what}",
            source=model,
            mend="compare it with denoc validate",
        ) from lacking
    document = balance_document(found, source=recordings[0], model=model, engine=engine)
    screen = console(json_file)
    print_balance(document, screen)
    if out is not None:
        files = {"balance.json": json_text(document), "balance.svg": balance_picture(found, engine)}
        for path in write_folder(out, files):
            screen.print(f"wrote {path}", markup=False)
    write_json(json_text(document), json_file)
    return 1 if strict and found.mends else 0
