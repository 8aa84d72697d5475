"""``denoc decay``: damping from the decay of a free swing."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from harness.cli.options import allow_option, console, output_options, say_notes, write_json

if TYPE_CHECKING:
    from harness.recording import Recording
    from harness.recording.recording import Channel
    from harness.system import System


@click.command()
@click.argument("recording", metavar="RECORDING")
@click.option(
    "--channel", metavar="NAME", help="Which column decays; default: the first position, else the first channel."
)
@click.option("--model", metavar="MODEL", help="URDF, MJCF or TOML: its inertia makes torques of the coefficients.")
@click.option("--map", "mapping", multiple=True, metavar="'SRC=DST[UNIT]'", help="A foreign column, as in diagnose.")
@click.option(
    "--restoring",
    type=click.Choice(["auto", "sine", "linear"]),
    default="auto",
    show_default=True,
    help="What draws it back: a pendulum's weight (sine), a spring (linear), or whichever the frequencies agree with.",
)
@click.option(
    "--bands",
    is_flag=True,
    help="Part swing and vibration first, and tell the decay of each; with --model also what of it is the joint's damping and what "
    "the link's own.",
)
@click.option(
    "--split", type=float, metavar="HZ", help="Where --bands parts them; default: between their spectral lines."
)
@click.option("--plot", metavar="FILE", help="The picture alone, to an .svg.")
@allow_option
@output_options("Write decay.json and decay.svg (bands.svg with --bands) there.")
def decay(
    recording: str,
    channel: str | None,
    model: str | None,
    mapping: tuple[str, ...],
    restoring: str,
    bands: bool,
    split: float | None,
    plot: str | None,
    allow: tuple[str, ...],
    out: Path | None,
    json_file: str | None,
) -> int:
    """Read damping off a decaying free swing: by logarithmic decrement, by the envelope of its half-swings with dry, viscous and
    quadratic damping, and by fitting the motion to every sample.

    Without a model the coefficients are over the joint's inertia, which is all that a free swing can tell.

    \b
    Examples:
      denoc decay swing.csv --model rig.urdf --out decay
      denoc decay run.csv --channel rod.root_strain --bands --model rig.toml --plot bands.svg
    """
    from harness.compare.decay.document import apart_document, bands_document, document
    from harness.errors import InputError
    from harness.json_text import json_text
    from harness.recording import read_recording
    from harness.recording.units import written
    from harness.system import load
    from harness.system.lowering import freed, one_degree
    from harness.whole_files import write_folder, write_whole

    if plot is not None and not plot.lower().endswith(".svg"):
        raise InputError(f"unknown ending {Path(plot).suffix!r}", source=plot, mend="name an .svg file")
    system = None if model is None else one_degree(freed(load(model, physical=False, allow=allow)), "a decay")
    if system is not None:
        say_notes(system.notes)
    read = read_recording(recording, mapping=mapping, system=system)
    chosen = _channel(read, channel)
    good = chosen.values == chosen.values
    time, signal = read.time[good], chosen.values[good]
    screen = console(json_file)
    try:
        if bands:
            from harness.compare.decay.bands import bands as part
            from harness.report.decay import bands_picture, print_apart, print_bands

            parts = part(time, signal, split=split)
            whole: dict[str, Any] = {
                "schema": "denoc.bands/1",
                "source": recording,
                "channel": chosen.name,
                "bands": bands_document(parts),
            }
            print_bands(whole["bands"], chosen.unit, screen)
            if system is not None:
                from harness.compare.decay.apart import apart

                told = apart(read, system, parts[1])
                whole["apart"] = apart_document(told)
                print_apart(whole["apart"], screen)
            label = f"{chosen.name} [{written(chosen.unit)}]"
            picture, name = bands_picture(parts, (time, signal), label), "bands"
        else:
            from harness.compare.decay import estimate
            from harness.report.decay import decay_picture, print_decay

            angle = chosen.quantity == "position" and chosen.unit == "rad"
            sine = {"sine": True, "linear": False}.get(restoring, None if angle else False)
            found = estimate(time, signal, sine=sine)
            whole = document(found, source=recording, channel=chosen.name, inertia=_inertia(system, chosen))
            print_decay(whole, screen)
            picture, name = decay_picture(found, chosen.name, written(chosen.unit)), "decay"
    except InputError as error:
        raise InputError(error.what, source=recording, column=chosen.column or chosen.name, mend=error.mend) from error
    if out is not None:
        for path in write_folder(out, {f"{name}.json": json_text(whole), f"{name}.svg": picture}):
            screen.print(f"wrote {path}", markup=False)
    if plot is not None:
        screen.print(f"wrote {write_whole(plot, picture)}", markup=False)
    write_json(json_text(whole), json_file)
    return 0


def _channel(read: Recording, name: str | None) -> Channel:
    from harness.errors import InputError
    from harness.system.suggest import did_you_mean

    if name is not None:
        for channel in read.channels:
            if channel.name == name:
                return channel
        raise InputError(
            f"no channel is named {name!r}", source=read.source, mend=did_you_mean(name, list(read.channel_names))
        )
    return next((c for c in read.channels if c.quantity == "position"), read.channels[0])


def _inertia(system: System | None, channel: Channel) -> float | None:
    """Inertia about the channel's joint with every other coordinate held [kg·m²], None without a model."""
    from harness.denoc import Denoc
    from harness.errors import InputError

    if system is None:
        return None
    if channel.site not in system.joint_names:
        raise InputError(
            f"{channel.name} is not at a joint, so that its inertia is not known", mend="leave out --model"
        )
    import numpy as np

    place = system.coordinate_names.index(channel.site)
    return float(Denoc(system).mass_matrix(np.zeros(len(system.coordinate_names)))[place, place])
