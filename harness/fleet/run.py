"""``diagnose_fleet``: every unit of a folder diagnosed, what is done kept as it comes, one table at the end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from harness.diagnose.problem.tolerances import Tolerance
from harness.errors import InputError
from harness.fleet.ask import Told, ask, not_done
from harness.fleet.fleet import Fleet
from harness.fleet.kept import answer_file, answers, begin, done
from harness.fleet.question import Question
from harness.fleet.table import Table
from harness.fleet.units import units_in
from harness.journal import code_digest
from harness.parallel import stream

Progress = Callable[[int, int, str], None]


def diagnose_fleet(
    folder: str | Path,
    model: str | Path | None = None,
    *,
    out: str | Path = "denoc-fleet",
    mapping: Sequence[str] = (),
    tolerance: Tolerance | None = None,
    fit_effort: bool = False,
    effects: Sequence[str | Path] = (),
    time_limit: float | None = None,
    actuators: bool = True,
    limits: bool = True,
    allow: Sequence[str | Path] = (),
    floating: bool = False,
    workers: int | None = None,
    dask: str | None = None,
    progress: Progress | None = None,
) -> Fleet:
    """Diagnose every unit of a fleet, and say which units have which effect, how numbers spread, and which are outliers.

    folder: one recording, or one subfolder of recordings, for each unit (see ``units_in``). model: file of the nominal model, for
    units without one of their own. out: folder that keeps one answer a unit; the same call goes on behind what is done there.
    workers: processes on this machine, default all cores. dask: address of a scheduler, whose workers read ``folder`` and
    write ``out`` under the same paths. time_limit: for each unit [s]. progress: called with (done, total, verdict of a unit).
    floating: let the roots of URDF models float on a free joint. Others as in ``diagnose``.
    Raises InputError for a folder without units, options that differ from those of the answers kept, and a cluster that is gone.
    """
    home, kept = Path(folder), Path(out).resolve()
    units, others = units_in(home, but=kept)
    inside = kept.parent.resolve() / kept.name
    if home.resolve() in inside.parents and inside.parent != home.resolve():
        raise InputError("lies in the folder of a unit", source=out, mend="give --out a folder outside of the fleet's")
    question = Question(
        None if model is None else str(Path(model).resolve()), tuple(mapping), tolerance, fit_effort,
        tuple(str(Path(file).resolve()) for file in effects), time_limit, actuators, limits,
        tuple(str(Path(place).resolve()) for place in allow), floating,
    )  # fmt: skip
    begin(kept, question)
    left = [unit for unit in units if not done(kept, unit)]
    count = len(units) - len(left)
    if progress is not None:
        progress(count, len(units), "")
    asking = partial(ask, question=question, folder=kept)

    def lost(index: int, why: str) -> Told:
        return not_done(kept, left[index], why)

    for _, told in stream(asking, left, workers=workers, dask=dask, lost=lost):
        if told.code != code_digest():
            raise InputError(
                "the workers run another version of the code", mend="install this one there, and start them again"
            )
        if not answer_file(kept, told.unit).exists():
            raise InputError(
                f"the workers' answers are not there (that of {told.unit} is the first)", source=kept,
                mend="give --out a folder that all machines share",
            )  # fmt: skip
        count += 1
        if progress is not None:
            progress(count, len(units), told.verdict)
    table = Table()
    for name, answer in answers(kept, units):
        table.add(name, answer)
    return Fleet({**table.document(), "source": str(home), "model": None if model is None else str(model), "others": others},
                 kept, tuple(units))  # fmt: skip
