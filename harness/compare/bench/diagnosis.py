"""A diagnosis over the full catalogue against one ``mujoco.sysid`` fit of dissipation, on the same recordings.

The recordings are made by MuJoCo: a pendulum with damping and dry friction, released twice, 16 s at 250 Hz with noise. Both sides
are given both of them, and then the first one alone.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from harness.compare.bench.measure import Timing, in_child
from harness.compare.bench.peers import Options, or_skipped, peer_model
from harness.compare.bench.row import Row
from harness.denoc.compiling.ahead import everything
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant
from harness.system.write import write

RATE, DURATION, NOISE = 250.0, 16.0, 2e-3
DAMPING, FRICTION = 1.5e-3, 6e-3
# Of MuJoCo [s]: its friction turns over two steps early, which has to be lost in the noise.
STEP = 1e-4
LIMIT = 10.0
START = 1.5e-3  # of its parameters' ranges, where the peer's dissipation begins
CASES = (
    ("diagnosis", ["run1.csv", "run2.csv"], "pendulum, two recordings of 16 s at 250 Hz"),
    ("diagnosis_one_recording", ["run1.csv"], "pendulum, one recording of 16 s at 250 Hz"),
)
# Either is given up after this [s].
LONGEST = 240.0
TURNS = 3  # of both, one after the other; one where it is to be quick

_OURS = """
from time import perf_counter
import numpy as np
import harness
from harness.denoc.lanes.model import LaneModel
runs = [{folder!r} + "/" + name for name in {runs}]
start = perf_counter()
# Modules too, which the peer has loaded by the time it begins.
import harness.diagnose.diagnose
model = LaneModel(harness.load({folder!r} + "/model.toml"))
model.simulate(model.row(), np.ones((1, model.n)), np.zeros((1, model.n)), np.linspace(0.0, 0.1, 11))
loading = perf_counter() - start
start = perf_counter()
found = harness.diagnose(runs, model={folder!r} + "/model.toml")
seconds = perf_counter() - start
names = [f"{{f['effect']}}@{{f['site']}}" for f in found.findings]
answer = dict(loading=loading, seconds=seconds, verdict=str(found.verdict), found=names)
"""

# The fit that the proof asks for, from the one start nearest to a lightly damped swing: what is timed is a single fit.
_THEIRS = """
from time import perf_counter
import harness
from harness.compare.peers.runs import as_run
from harness.compare.peers.sysid import fit_sysid
from harness.recording import read_recordings
import mujoco.sysid
system = harness.load({folder!r} + "/model.toml")
recordings = read_recordings([{folder!r} + "/" + name for name in {runs}], system=system)
start = perf_counter()
found = fit_sysid(system, [as_run(system, r) for r in recordings], starts=({start!r},))
answer = dict(seconds=perf_counter() - start, fitted=[found.values["pivot:viscous"], found.values["pivot:dry"]])
"""


def pendulum() -> System:
    """The nominal model: 0.2 kg, 0.3 m to the centre of mass, no dissipation."""
    pivot = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0.0, 1.0, 0.0]))
    rod = Link("rod", 0.2, constant([0.0, 0.0, -0.15]), constant(np.diag([1.5e-3, 1.5e-3, 1e-5])))
    return System("rig", (pivot,), (rod,))


def recordings(folder: Path) -> None:
    """Nominal model and two recordings of the real one into ``folder``."""
    system = pendulum()
    write(system, folder / "model.toml")
    real = system.replace_joint(replace(system.joints[0], damping=DAMPING, friction=FRICTION))
    model = peer_model("mujoco", real)
    time = np.arange(0.0, DURATION, 1.0 / RATE)
    rng = np.random.default_rng(0)
    for k, angle in enumerate((1.4, 0.8), start=1):
        run = model.simulate(np.array([angle]), np.zeros(1), time, step=STEP)
        seen = run.position[:, 0] + NOISE * rng.normal(size=time.size)
        np.savetxt(
            folder / f"run{k}.csv",
            np.column_stack([time, seen]),
            delimiter=",",
            header="time,pivot.position",
            comments="",
        )


def run(options: Options) -> Iterator[Row]:
    """Rows against the peer with both recordings and with one, and against the limit; a note tells what loading takes."""
    yield from or_skipped("diagnosis", 1, "mujoco.sysid", partial(_rows, options))


def _rows(options: Options) -> Iterable[Row]:
    with tempfile.TemporaryDirectory() as name:
        recordings(Path(name))
        # Compiling is a row of its own.
        everything()
        for what, runs, case in CASES:
            theirs, ours = [], []
            turns = 1 if options.quick else TURNS
            for turn in range(1, turns + 1):
                options.tell(f"{what}, {turn} of {turns}: mujoco.sysid fits, up to a minute")
                theirs.append(in_child(_THEIRS.format(folder=name, runs=runs, start=START), patience=LONGEST))
                options.tell(f"{what}, {turn} of {turns}: over the full catalogue, half a minute")
                ours.append(in_child(_OURS.format(folder=name, runs=runs), patience=LONGEST))
            mine, other = (Timing.of([child.answer["seconds"] for child in side]) for side in (ours, theirs))
            told, fitted = ours[0].answer, theirs[0].answer["fitted"]
            found = ", ".join(told["found"]) or "nothing"
            yield Row.timed(
                what,
                1,
                "mujoco.sysid",
                mine,
                other,
                case=case,
                note=f"full catalogue ({told['verdict']}: {found}; loading modules and compiled code {told['loading']:.1f} s more) "
                f"against one fit of damping {fitted[0]:.2g} and friction {fitted[1]:.2g} to the same "
                f"(true {DAMPING:g}, {FRICTION:g})",
                wanted=1.0,
            )
            yield Row(
                f"{what}_memory",
                1,
                "mujoco.sysid",
                max(child.memory for child in ours),
                max(child.memory for child in theirs),
                unit="MB",
                case=case,
                note="peak memory of the same processes",
            )
            if len(runs) > 1:
                yield Row(
                    what,
                    1,
                    "limit",
                    mine.median,
                    LIMIT,
                    ours_spread=mine.spread,
                    case=case,
                    note="against the limit we set ourselves",
                    wanted=1.0,
                )
