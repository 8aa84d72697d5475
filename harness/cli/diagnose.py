"""``denoc diagnose``: what did the model leave out?"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import click

from harness.cli.interrupt import answers_to_interrupt
from harness.cli.options import allow_option, console, output_options, progress, say_notes, write_json

USUAL_LIMIT = 120.0  # s, on a terminal: somebody waits there


@click.command()
@click.argument("recordings", nargs=-1, required=True, metavar="RECORDING …")
@click.option("--model", required=True, metavar="MODEL", help="The nominal model: URDF, MJCF or TOML.")
@click.option(
    "--map",
    "mapping",
    multiple=True,
    metavar="'SRC=DST[UNIT]'",
    help="A foreign column: 'theta_meas=pivot.position[deg]', or NAME=ignore; repeatable. Or a TOML file beside the recording.",
)
@click.option(
    "--holdout", metavar="FILE", help="Judge on this recording; default: the last one, or the last 30 % of one."
)
@allow_option
@click.option(
    "--tolerance", type=float, metavar="X", help="Relative 1σ of nominal masses, lengths, inertias, stiffnesses."
)
@click.option("--fit-effort", is_flag=True, help="Efforts are measurements to fit, not known inputs.")
@click.option(
    "--effects", "effects_files", multiple=True, metavar="FILE", help="Effects of your own beside the catalogue."
)
@click.option(
    "--time-limit",
    type=float,
    metavar="SECONDS",
    help="Give the best answer so far after so long, and say what was not tried; default: 120 on a terminal, else none (inf). "
    "Ctrl-C once does the same, twice stops.",
)
@click.option(
    "--actuators/--no-actuators",
    default=True,
    help="Whether the MJCF's actuators act where no effort is recorded, by columns <joint>.command, else with command 0.",
)
@click.option(
    "--limits/--no-limits",
    default=True,
    help="Whether the MJCF's limits act, as soft constraints, where a recording meets them.",
)
@click.option("--strict", is_flag=True, help="Exit with 1 unless the verdict is consistent or explained.")
@output_options("Write diagnosis.json, report.html and the augmented model there.")
def diagnose(
    recordings: tuple[str, ...],
    model: str,
    mapping: tuple[str, ...],
    holdout: str | None,
    allow: tuple[str, ...],
    tolerance: float | None,
    fit_effort: bool,
    effects_files: tuple[str, ...],
    time_limit: float | None,
    actuators: bool,
    limits: bool,
    strict: bool,
    out: Path | None,
    json_file: str | None,
) -> int:
    """Locate where a model leaves the recordings, name the physics it left out, fit it, and judge on data held out.

    \b
    Examples:
      denoc diagnose run1.csv run2.csv --model rig.urdf
      denoc diagnose log.csv --model rig.toml --map 'theta_meas=pivot.position[deg]' --out diagnosis
    """
    from harness.cli.main import COMMAND
    from harness.denoc.compiling import ahead
    from harness.diagnose.diagnose import diagnose as find
    from harness.diagnose.problem.deadline import Deadline
    from harness.report.diagnosis import print_diagnosis, write_diagnosis
    from harness.report.json_text import json_text
    from harness.system import load

    ahead.start(ahead.DIAGNOSE)
    if time_limit is None and sys.stderr.isatty():
        time_limit = USUAL_LIMIT
    deadline = Deadline(time_limit)
    with progress("diagnose") as step, answers_to_interrupt(deadline.interrupt):
        found = find(
            list(recordings),
            model=load(model, physical=False, allow=allow),
            mapping=mapping,
            holdout=holdout,
            tolerance=tolerance,
            fit_effort=fit_effort,
            effects=effects_files,
            progress=step,
            time_limit=deadline,
            actuators=actuators,
            limits=limits,
        )
        if not deadline.over:
            found = found.replayed()
    found = replace(
        found, provenance={**(found.provenance or {}), "command": click.get_current_context().meta[COMMAND]}
    )
    document = found.to_json()
    screen = console(json_file)
    say_notes(document["notes"])
    print_diagnosis(document, screen)
    if out is not None:
        for path in write_diagnosis(found, out, said=lambda line: screen.print(line, markup=False)):
            screen.print(f"wrote {path}", markup=False)
    write_json(json_text(document), json_file)
    return 1 if strict and document["verdict"] not in ("consistent", "explained") else 0
