"""``denoc diagnose``: what did the model leave out?"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from harness.cli.interrupt import answers_to_interrupt
from harness.cli.options import (
    allow_option,
    console,
    output_options,
    progress,
    say_notes,
    wide_options,
    write_json,
)

if TYPE_CHECKING:
    from harness.diagnose.problem.deadline import Deadline
    from harness.diagnose.problem.tolerances import Tolerance
    from harness.system import System

USUAL_LIMIT = 120.0  # s, on a terminal: somebody waits there


@click.command()
@click.argument("recordings", nargs=-1, metavar="RECORDING …")
@click.option(
    "--model",
    "models",
    multiple=True,
    metavar="MODEL",
    help="The nominal model: URDF, MJCF or TOML. Repeat it, one for each recording in their order, where known payloads differ.",
)
@click.option(
    "--compare",
    nargs=2,
    metavar="MODEL_A MODEL_B",
    help="Hold two identified models against the recordings: which predicts better where, in what they agree, what is open.",
)
@click.option(
    "--transfer",
    "published",
    metavar="MODEL",
    help="Parameters published for one unit on recordings of another: which carry over, which do not.",
)
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
@click.option("--floating", is_flag=True, help="Let the root links of URDF models float on a free joint, root_joint.")
@click.option(
    "--tolerance",
    "tolerances",
    multiple=True,
    metavar="[QUANTITY=]X",
    help="Relative 1σ of nominal masses, lengths, inertias, stiffnesses; servo.armature=X: of one of them. Repeatable.",
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
    "--engine",
    metavar="NAME",
    help="Doubt the equations of motion of this engine instead of the model: which of their terms, held against the native ones, "
    "does the recording ask to be mended?",
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
@click.option(
    "--fleet",
    metavar="DIR",
    help="Diagnose every unit of a fleet, in place of recordings: each file in DIR is one, and each folder of recordings, with its "
    "own model.toml if it has one. --time-limit is for each unit; the same command goes on where it was stopped.",
)
@output_options(
    "Write diagnosis.json, report.html and the augmented model there; of --compare and --transfer JSON and page; of --fleet "
    "one JSON a unit as they come, and fleet.json, fleet.csv, report.html (default: denoc-fleet)."
)
@wide_options(beside="--fleet")
def diagnose(
    recordings: tuple[str, ...],
    models: tuple[str, ...],
    compare: tuple[str, str] | None,
    published: str | None,
    mapping: tuple[str, ...],
    holdout: str | None,
    allow: tuple[str, ...],
    floating: bool,
    tolerances: tuple[str, ...],
    fit_effort: bool,
    effects_files: tuple[str, ...],
    time_limit: float | None,
    engine: str | None,
    actuators: bool,
    limits: bool,
    strict: bool,
    fleet: str | None,
    out: Path | None,
    json_file: str | None,
    workers: int | None,
    dask: str | None,
) -> int:
    """Locate where a model leaves the recordings, name the physics it left out, fit it, and judge on data held out.

    \b
    Examples:
      denoc diagnose run1.csv run2.csv --model rig.urdf
      denoc diagnose log.csv --model rig.toml --map 'theta_meas=pivot.position[deg]' --out diagnosis
      denoc diagnose empty.csv 1kg.csv 2kg.csv --model empty.urdf --model 1kg.urdf --model 2kg.urdf
      denoc diagnose run*.csv --compare toolbox_a.urdf toolbox_b.urdf --out compared
      denoc diagnose run*.csv --transfer published.urdf
      denoc diagnose throw*.csv --model quadruped.urdf --floating
      denoc diagnose ancf.csv --model examples/paper/one_mode.toml --engine as_printed
      denoc diagnose --fleet recordings --model rig.urdf --out fleet --dask tcp://head:8786

    --compare and --transfer ask for no search and need no --model; with one, the diagnosis comes first.
    """
    from harness.cli.held_against import held_against, tell
    from harness.errors import InputError

    tolerance = _told(tolerances)
    if fleet is not None:
        from harness.cli.fleet import diagnose_all

        apart: dict[str, Any] = {
            "--holdout": holdout,
            "--compare": compare,
            "--transfer": published,
            "--engine": engine,
        }
        _refuse(apart, "does not go with --fleet", "leave it out, or diagnose one unit by itself")
        if recordings or len(models) > 1:
            what = "recordings are given" if recordings else f"{len(models)} models are given"
            raise InputError(f"{what} beside --fleet", mend="put them into the fleet's folder, a folder for each unit")
        return diagnose_all(
            fleet, models[0] if models else None, out or Path("denoc-fleet"), json_file, strict=strict, mapping=mapping,
            tolerance=tolerance, fit_effort=fit_effort, effects=effects_files, time_limit=time_limit, actuators=actuators,
            limits=limits, allow=allow, floating=floating, workers=workers, dask=dask,
        )  # fmt: skip
    _refuse({"--workers": workers, "--dask": dask}, "is for --fleet", "leave it out: one diagnosis runs in one process")
    if not recordings:
        raise InputError("no recording given", mend="name the recordings of one rig, or --fleet DIR")
    if engine is not None:
        from harness.cli.balance import diagnose_engine

        others: dict[str, Any] = {"--holdout": holdout, "--tolerance": tolerance, "--fit-effort": fit_effort or None,
                  "--effects": effects_files or None, "--time-limit": time_limit, "--compare": compare,
                  "--transfer": published}  # fmt: skip
        _refuse(others, "does not go with --engine", "leave it out: nothing is fitted to the model")
        if len(models) != 1:
            raise InputError("--engine is doubted beside one --model", mend="give the model that the recordings are of")
        return diagnose_engine(
            recordings, models[0], engine, mapping, allow, out, json_file, strict=strict, floating=floating
        )
    from harness.cli.main import COMMAND
    from harness.denoc.compiling import ahead
    from harness.diagnose.problem.deadline import Deadline
    from harness.engines.readers.register import floating_among
    from harness.json_text import json_text
    from harness.system import load

    identified = compare is not None or published is not None
    if not models:
        if not identified:
            raise InputError("no --model given", mend="give the nominal model, or --compare or --transfer")
        asked_of_a_search = {"--tolerance": tolerance, "--fit-effort": fit_effort or None, "--effects": effects_files or None,
                             "--strict": strict or None}  # fmt: skip
        _refuse(asked_of_a_search, "is for a diagnosis, which needs a --model", "give --model, or leave it away")
    named = [*models, *(compare or ()), *([published] if published else [])]
    floats = floating_among(map(Path, named)) if floating else set()

    def read(model: str) -> System:
        return load(model, physical=False, allow=allow, floating=Path(model) in floats)

    ahead.start(ahead.DIAGNOSE)
    if time_limit is None and sys.stderr.isatty():
        time_limit = USUAL_LIMIT
    document: dict[str, Any] | None = None
    if models:
        systems = [read(m) for m in models]
        document = _searched(
            recordings, systems, mapping=mapping, holdout=holdout, tolerance=tolerance,
            fit_effort=fit_effort, effects=effects_files, deadline=Deadline(time_limit), out=out, json_file=json_file,
            command=click.get_current_context().meta[COMMAND], actuators=actuators, limits=limits,
        )  # fmt: skip
    if identified:
        deadline = Deadline(time_limit)
        with progress("compare") as step, answers_to_interrupt(deadline.interrupt):
            found = held_against(
                recordings, compare, published, read, holdout=holdout, mapping=mapping,
                step=step, deadline=deadline,
            )  # fmt: skip
        plain = tell(found, out, json_file)
        if document is not None:
            document |= plain
        else:
            first, *further = plain.values()
            document = {**first, **({"transfer": further[0]} if further else {})}
    assert document is not None
    write_json(json_text(document), json_file)
    return 1 if strict and document["verdict"] not in ("consistent", "explained") else 0


def _told(words: tuple[str, ...]) -> Tolerance | None:
    """What is said of tolerances."""
    if not words:
        return None
    from harness.diagnose.problem.tolerances import told

    return told(words)


def _refuse(options: dict[str, Any], why: str, mend: str) -> None:
    """InputError for the first of these options that is given (is not None)."""
    from harness.errors import InputError

    for option, given in options.items():
        if given is not None:
            raise InputError(f"{option} {why}", mend=mend)


def _searched(
    recordings: tuple[str, ...],
    systems: list[System],
    *,
    mapping: tuple[str, ...],
    holdout: str | None,
    tolerance: Tolerance | None,
    fit_effort: bool,
    effects: tuple[str, ...],
    deadline: Deadline,
    out: Path | None,
    json_file: str | None,
    command: str,
    actuators: bool,
    limits: bool,
) -> dict[str, Any]:
    """The diagnosis, printed and written; its document."""
    from harness.diagnose.diagnose import diagnose as find
    from harness.report.diagnosis import print_diagnosis, write_diagnosis

    with progress("diagnose") as step, answers_to_interrupt(deadline.interrupt):
        found = find(
            list(recordings), model=systems, mapping=mapping, holdout=holdout, tolerance=tolerance, fit_effort=fit_effort,
            effects=effects, progress=step, time_limit=deadline, actuators=actuators, limits=limits,
        )  # fmt: skip
        if not deadline.over:
            found = found.replayed()
    found = replace(found, provenance={**(found.provenance or {}), "command": command})
    document = found.to_json()
    screen = console(json_file)
    say_notes(document["notes"])
    # Files first: what took minutes to find is kept whatever becomes of the terminal.
    lines: list[str] = []
    if out is not None:
        lines += [f"wrote {path}" for path in write_diagnosis(found, out, said=lines.append)]
    print_diagnosis(document, screen)
    for line in lines:
        screen.print(line, markup=False)
    return document
