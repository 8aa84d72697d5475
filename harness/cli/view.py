"""``denoc view``: a mechanism in motion."""

from __future__ import annotations

from pathlib import Path

import click

from harness.cli.options import allow_option, console, say_notes, write_json


@click.command()
@click.argument("system", metavar="SYSTEM")
@click.argument("recording", required=False, metavar="[RECORDING]")
@click.option(
    "--map", "mapping", multiple=True, metavar="'SRC=DST[UNIT]'", help="A foreign column of the recording; repeatable."
)
@click.option("--position", multiple=True, metavar="JOINT=VALUE", help="Start position, pivot=1.2 or 'pivot=70[deg]'.")
@click.option("--velocity", multiple=True, metavar="JOINT=VALUE", help="Start velocity, pivot=0.5 or 'pivot=30[rpm]'.")
@click.option("--duration", type=float, metavar="S", help="How much is shown [s]; default: the recording, or 10.")
@click.option("--engine", default="denoc", show_default=True, help="Which engine simulates (denoc doctor lists them).")
@allow_option
@click.option("--out", metavar="FILE", help="Write a page (.html) that opens anywhere, and open no window.")
@click.option(
    "--json",
    "json_file",
    metavar="FILE",
    help="Write the motions for programs to FILE, and open no window; '-' is standard output.",
)
def view(
    system: str,
    recording: str | None,
    mapping: tuple[str, ...],
    position: tuple[str, ...],
    velocity: tuple[str, ...],
    duration: float | None,
    engine: str,
    allow: tuple[str, ...],
    out: str | None,
    json_file: str | None,
) -> int:
    """Show SYSTEM in motion in MuJoCo's viewer, or as a page: simulated, and beside a RECORDING if one is given.

    The simulation starts as the recording does, and is driven by its efforts.

    \b
    Examples:
      denoc view robot.xml run1.csv
      denoc view rig.urdf run1.csv --out view.html
      denoc view models/urdf/double_pendulum.urdf --position shoulder=2 --out view.html
    """
    from harness.cases.single_run import assignments, sample_times
    from harness.engines.attached import check_attached
    from harness.errors import InputError
    from harness.json_text import json_text
    from harness.report.animation.beside import beside, simulated
    from harness.report.animation.page import animation_html
    from harness.report.animation.scene import scene
    from harness.system import load
    from harness.system.lowering import freed, one_degree
    from harness.whole_files import write_whole

    if out is not None and Path(out).suffix.lower() not in (".html", ".htm"):
        raise InputError(f"unknown ending {Path(out).suffix!r}", source=out, mend="use .html")
    mechanism = load(system, physical=False, allow=allow)
    check_attached(mechanism)
    mechanism = one_degree(freed(mechanism), "a view")
    start = assignments(position, "--position", "position", mechanism)
    speed = assignments(velocity, "--velocity", "velocity", mechanism)
    told: tuple[str, ...] = ()
    if recording is None:
        time, motions = simulated(mechanism, sample_times(duration or 10.0, 200.0), start, speed, engine)
        title = mechanism.name
    else:
        from harness.recording import read_recording

        read = read_recording(recording, mapping=mapping, system=mechanism)
        time, motions, told = beside(mechanism, read, start, speed, duration, engine)
        title = f"{mechanism.name}: {read.name}"
    screen = console(json_file)
    say_notes(mechanism.notes)
    for line in told:
        screen.print(line, markup=False)
    if json_file is not None:
        document = {
            "schema": "denoc.view/1",
            "system": mechanism.name,
            "time": time.tolist(),
            "motions": [
                {"label": m.label, "positions": {joint: values.tolist() for joint, values in m.positions.items()}}
                for m in motions
            ],
            "notes": [*mechanism.notes, *told],
        }
        write_json(json_text(document), json_file)
    if out is None and json_file is not None:
        return 0
    if out is None:
        from harness.report.animation.viewer import view as play

        play(mechanism, time, motions)
        return 0
    written = write_whole(out, animation_html(scene(mechanism, time, motions, title), " ".join(told)))
    screen.print(f"wrote {written}", markup=False)
    return 0
