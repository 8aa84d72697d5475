"""``denoc simulate``: one run."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path

import click

from harness.cli.options import allow_option, console, say_notes, write_json


@click.command()
@click.argument("system", metavar="SYSTEM")
@click.option("--duration", type=float, default=10.0, show_default=True, metavar="S", help="Length of the run [s].")
@click.option("--rate", type=float, default=1000.0, show_default=True, metavar="HZ", help="Samples a second.")
@click.option("--position", multiple=True, metavar="JOINT=VALUE", help="Start position, pivot=1.2 or 'pivot=70[deg]'.")
@click.option("--velocity", multiple=True, metavar="JOINT=VALUE", help="Start velocity, pivot=0.5 or 'pivot=30[rpm]'.")
@click.option("--keyframe", metavar="NAME", help="Start from a keyframe of the MJCF, or from its qpos0.")
@click.option(
    "--actuators/--no-actuators",
    default=True,
    help="Whether the MJCF's actuators act, their commands those of the keyframe or 0, where no effort is given.",
)
@click.option(
    "--limits/--no-limits",
    default=True,
    help="Whether the joints' limits act, as soft constraints, where they are reached.",
)
@click.option("--effort", metavar="FILE", help="Applied efforts: a recording with time and <joint>.effort columns.")
@click.option(
    "--hold",
    type=click.Choice(["zero", "linear"]),
    default="zero",
    show_default=True,
    help="Efforts between their samples: each holds until the next, as a command does, or they are joined by straight "
    "lines, as is right for measured ones.",
)
@click.option("--engine", default="denoc", show_default=True, help="Which engine runs it (denoc doctor lists them).")
@click.option("--step", type=float, metavar="S", help="Fixed step [s]; default: the engine's own choice.")
@click.option(
    "--effects", "effects_files", multiple=True, metavar="FILE", help="Effects of your own that SYSTEM has attached."
)
@click.option("--floating", is_flag=True, help="Let the root link of a URDF float on a free joint.")
@allow_option
@click.option("--allow-unphysical", is_flag=True, help="Run a model whose inertia no body can have all the same.")
@click.option("--plot", metavar="FILE", help="Draw the run to a .png, .svg or .pdf.")
@click.option("--out", metavar="FILE", help="The recording: .csv, .csv.gz or .parquet (a folder: run.csv in it).")
@click.option(
    "--json", "json_file", metavar="FILE", help="Write a summary for programs to FILE; '-' is standard output."
)
def simulate(
    system: str,
    duration: float,
    rate: float,
    position: tuple[str, ...],
    velocity: tuple[str, ...],
    keyframe: str | None,
    actuators: bool,
    limits: bool,
    effort: str | None,
    hold: str,
    engine: str,
    step: float | None,
    effects_files: tuple[str, ...],
    floating: bool,
    allow_unphysical: bool,
    allow: tuple[str, ...],
    plot: str | None,
    out: str | None,
    json_file: str | None,
) -> int:
    """Run SYSTEM (URDF, MJCF or TOML) once, to a recording or a plot.

    Without --out, --plot and --json the recording goes to standard output.

    \b
    Examples:
      denoc simulate models/urdf/rigid_pendulum.urdf --position pivot=1.2 --out run.csv
      denoc simulate diagnosis/augmented.toml --effects magnet.py --out rerun.csv
      denoc simulate arm.xml --keyframe home --out run.csv
      denoc simulate robot.xml --engine mujoco --duration 2 --rate 100 --plot run.png
    """
    import json

    from harness.cases.acting import idle
    from harness.cases.acting import keyframe as keyframe_of
    from harness.cases.beam_shapes import told_shapes
    from harness.cases.case import NATIVE
    from harness.cases.single_run import assignments, drive_from, run_once, sample_times
    from harness.engines.attached import check_attached
    from harness.report.run_files import csv_text, write_plot, write_recording
    from harness.system import load

    for file in effects_files:
        from harness.effects import load_user_effects

        load_user_effects(file)
    mechanism = load(system, physical=not allow_unphysical, allow=allow, floating=floating)
    check_attached(mechanism)
    if engine == NATIVE:
        from harness.denoc.compiling import ahead

        ahead.start(ahead.SIMULATE)
    time = sample_times(duration, rate)
    frame = keyframe_of(mechanism, keyframe or "qpos0")
    start = {**(frame.position if keyframe else {}), **assignments(position, "--position", "position", mechanism)}
    speed = {**(frame.velocity if keyframe else {}), **assignments(velocity, "--velocity", "velocity", mechanism)}
    drive = None if effort is None else drive_from(effort, time, mechanism, hold=hold)
    tau = None if drive is None else drive.tau
    command = (frame.command if keyframe else {}) if actuators else None
    mechanism = mechanism if actuators else idle(mechanism)
    run = run_once(
        mechanism,
        time if drive is None else drive.time,
        start,
        speed,
        engine=engine,
        tau=tau,
        hold=hold,
        step=step,
        command=command,
        limits=limits,
    ).at(time)
    driving = () if drive is None else tuple(f"{effort}: {note.words()}" for note in drive.notes)
    begins = _where(keyframe, start, speed)
    notes = (*mechanism.notes, *driving, *(frame.notes if keyframe else ()), begins, *run.notes)
    screen = console(json_file)
    shapes = told_shapes(mechanism) if engine == NATIVE else ()
    if out is not None or plot is not None:
        for line in (begins, *shapes):
            screen.print(line, markup=False)
    if out is not None:
        target = Path(out) / "run.csv" if Path(out).is_dir() else Path(out)
        screen.print(f"wrote {write_recording(run.columns, target)}", markup=False)
    if plot is not None:
        sliding = {joint.name for joint in mechanism.movable_joints if joint.prismatic}
        screen.print(
            f"wrote {write_plot(run.columns, plot, f'{mechanism.name} ({engine})', sliding=sliding)}", markup=False
        )
    if json_file is not None:
        summary = {
            "schema": "denoc.simulation/1",
            "system": mechanism.name,
            "engine": run.engine,
            "version": run.version,
            "duration": float(time[-1]),
            "samples": len(time),
            "columns": list(run.columns),
            "final": {name: float(values[-1]) for name, values in run.columns.items()},
            "energy_change": run.energy,
            "shapes": list(shapes),
            "notes": list(notes),
        }
        write_json(json.dumps(summary, indent=1, ensure_ascii=False), json_file)
    # Once the run is written: what refuses it is one line by itself.
    shown = out is not None or plot is not None
    say_notes([note for note in notes if note != begins or (keyframe and not shown)])
    if out is None and plot is None and json_file is None:
        sys.stdout.write(csv_text(run.columns))
    elif run.energy is not None:
        screen.print(f"energy is kept to {run.energy:.1e} of the largest kinetic energy")
    return 0


def _where(keyframe: str | None, position: Mapping[str, float], velocity: Mapping[str, float]) -> str:
    """One line on where the run starts."""
    said = [f"{name} = {value:.6g}" for name, value in position.items() if value]
    said += [f"d({name})/dt = {value:.6g}" for name, value in velocity.items() if value]
    origin = f"keyframe {keyframe!r}" if keyframe else "the model's zero"
    return f"starts from {origin}" + (f", {', '.join(said)}" if said else "") + "; all else at zero"
