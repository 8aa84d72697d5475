"""One unit's diagnosis, on whichever machine it is."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.diagnose.diagnose import diagnose
from harness.engines.readers.register import root_of
from harness.errors import InputError, one_line, unforeseen
from harness.fleet.kept import keep
from harness.fleet.question import Question
from harness.fleet.units import Unit
from harness.journal import code_digest
from harness.system import load


@dataclass(frozen=True)
class Told:
    """That a unit's answer is kept. verdict: "failed" where there is none; code: of who gave it."""

    unit: str
    verdict: str
    code: str


def ask(unit: Unit, question: Question, folder: Path) -> Told:
    """Diagnose a unit and keep its answer in the fleet's folder, before anybody else has to be there to take it.

    What the recordings or the model are to blame for is an answer too; what else goes wrong is tried again by the next run.
    """
    files: list[list[str | int]] = []
    try:
        files = unit.files()
        document = _diagnosed(unit, question)
    except InputError as error:
        keep(folder, unit.name, files, failed=str(error))
        return Told(unit.name, "failed", code_digest())
    except MemoryError:
        return not_done(folder, unit, "not enough memory (fewer samples or more memory for each worker will do)")
    except Exception as error:
        # One unit must not end thousands of others: it is told as failed, and asked again by the next run.
        if os.environ.get("DENOC_TRACEBACK"):
            raise
        return not_done(folder, unit, unforeseen(error))
    keep(folder, unit.name, files, diagnosis=document)
    return Told(unit.name, document["verdict"], code_digest())


def not_done(folder: Path, unit: Unit, why: str) -> Told:
    """Keep why a unit has no answer this time."""
    keep(folder, unit.name, [], failed=one_line(f"{unit.name}: {why}"), again=True)
    return Told(unit.name, "failed", code_digest())


def _diagnosed(unit: Unit, question: Question) -> dict[str, Any]:
    model = unit.model or question.model
    if model is None:
        raise InputError(
            "has no model of its own", source=unit.name, mend="give --model, or put model.toml into each unit's folder"
        )
    if not unit.recordings:
        raise InputError("holds no recording", source=unit.name, mend="put recordings there, such as run1.csv")
    # Units with files of other formats say themselves what floats.
    floating = question.floating and (model == question.model or root_of(Path(model)) == "robot")
    system = load(model, physical=False, allow=question.allow, floating=floating)
    return diagnose(
        list(unit.recordings), system, mapping=question.mapping,
        tolerance=question.tolerance, fit_effort=question.fit_effort, effects=question.effects,
        time_limit=question.time_limit, actuators=question.actuators, limits=question.limits,
    ).to_json()  # fmt: skip
