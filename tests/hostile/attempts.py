"""A hostile file read as a command would; what came of it."""

from __future__ import annotations

import time
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from damage import MODEL_FILES, OTHERS, RECORDINGS, hostile

import harness
from harness.cases.gate import read_accepted
from harness.cases.results import read_results
from harness.errors import InputError
from harness.recording import read_recording
from harness.recording.columns import rules_beside
from harness.recording.units import factor_to_si
from harness.system import audit

KINDS = (*RECORDINGS, *MODEL_FILES, *OTHERS)
# Of a message, the name of the file left out; and what one small file may take on a busy machine.
LONGEST_LINE, LONGEST = 1100, 120.0
PENDULUM = harness.load(Path(__file__).resolve().parents[2] / "models" / "urdf" / "rigid_pendulum.urdf")


@dataclass(frozen=True)
class Attempt:
    """outcome: ``read``, ``refused``, or what must not be: ``defect``. told: the line, or the exception."""

    outcome: str
    told: str
    seconds: float


def _recording(path: Path) -> str:
    read_recording(path, system=PENDULUM)
    return ""


def _model(path: Path) -> str:
    """A model that is taken must have an acceleration."""
    system = harness.load(path)
    rest = np.zeros(len(system.coordinate_names))
    acceleration = harness.Denoc(system).forward_dynamics(rest, rest, rest)
    return "" if np.isfinite(acceleration).all() else f"acceleration {acceleration} of what was taken"


def _table(path: Path) -> str:
    audit(path)
    return _model(path)


def _gate(path: Path) -> str:
    read_accepted(path)
    return ""


def _results(path: Path) -> str:
    read_results(path).to_text()
    return ""


def _unit(path: Path) -> str:
    factor, _ = factor_to_si(path.read_bytes().decode("latin-1"), "position", prismatic=False)
    return "" if np.isfinite(factor) else f"factor {factor}"


def _mapping(path: Path) -> str:
    rules_beside(path.with_name("run.csv"))
    return ""


READ = {
    **{name: _table if name.endswith(".toml") else _model for name in MODEL_FILES},
    "results.json": _results, "accepted.json": _gate, "unit": _unit, "columns.toml": _mapping,
}  # fmt: skip


def valid_file(kind: str, folder: Path) -> bytes:
    """A valid file of a kind."""
    if kind in MODEL_FILES:
        return MODEL_FILES[kind].read_bytes()
    path = folder / f"valid.{kind}"
    {**RECORDINGS, **OTHERS}[kind](path)
    return path.read_bytes()


def attempt(kind: str, content: bytes, folder: Path) -> Attempt:
    """Read it; nothing but InputError in one line may be raised, and in a short time."""
    path = folder / (f"hostile.{kind}" if kind in RECORDINGS else kind)
    path.write_bytes(content)
    begin = time.perf_counter()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)  # an overflow that nobody tells is no answer
            wrong = READ.get(kind, _recording)(path)
        outcome, told = ("defect", wrong) if wrong else ("read", "")
    except InputError as error:
        told = str(error)
        outcome = "refused" if "\n" not in told and len(told) < LONGEST_LINE else "defect"
    except Exception as error:
        outcome, told = "defect", f"{type(error).__name__}: {error}"
    seconds = time.perf_counter() - begin
    if seconds > LONGEST:
        outcome, told = "defect", f"took {seconds:.0f} s: {told}"
    return Attempt(outcome, told, seconds)


def tried(kind: str, seed: int, valid: bytes, folder: Path) -> Attempt:
    """The hostile file of a kind and seed, read."""
    return attempt(kind, hostile(kind, valid, seed), folder)
