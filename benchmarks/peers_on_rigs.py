"""Peers on real rigs: what each fits to the training recordings, judged as free runs over recordings held out; one table.

``python benchmarks/peers_on_rigs.py [RIG …] [--peers NAME …] [--recordings DIR] [--json FILE] [--window SECONDS]
[--limit SECONDS]``

Rigs and their division are those of ``afternoon.py``. Errors are root mean squares [rad or m] over windows as there, from the
first sample and with the initial state fitted; ``kept`` are the laws that a peer keeps, with 95 % intervals where it has them.
A peer that is not made for a rig says so, and one that takes more of the processor than the limit is ended, which the file says
too; a machine that others use does not count against it. What a file
has already is not made again, so that a run that was ended goes on; what was ended at a lower limit is.
"""

from __future__ import annotations

import json
import signal
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from harness.compare.peers.figaroh import fit_figaroh
from harness.compare.peers.runs import NotForIt, Run, as_run
from harness.compare.peers.servo_friction import LADDER, climb
from harness.compare.peers.sysid import REAL, WHAT, fit_sysid
from harness.compare.peers.torque_regression import fit_regression
from harness.effects.scale import swings
from harness.proof.peers.servo_friction import arm_of
from harness.recording import Recording

from afternoon import WINDOW, Case, fit  # isort: skip
from real_recordings import asked_rigs, judge, piece  # isort: skip
from real_recordings_free_run import Simulate, native  # isort: skip

Found = tuple[Simulate, dict[str, Any]]

NOTE = "seconds of the clock beside other work"


class TooLong(BaseException):
    """A peer's time is over; no exception of the kind that a peer may catch."""


@contextmanager
def limited(seconds: float | None) -> Iterator[None]:
    """Raise ``TooLong`` within it after so many seconds of the processor."""

    def over(*_: Any) -> None:
        raise TooLong

    before = signal.signal(signal.SIGPROF, over)
    signal.setitimer(signal.ITIMER_PROF, seconds or 0.0)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


class Asked(Case):
    """One rig as peers are given it."""

    def runs(self, recordings: Sequence[Recording]) -> list[Run]:
        """As peers are given them."""
        return [as_run(self.system, r) for r in recordings]

    def windows(self, recordings: Sequence[Recording]) -> list[Run]:
        """The same in windows of the length that is judged, those with a push left out."""
        cut = [
            r.cut(self.window, self.left_out.get(n.name, ()))
            for n, r in zip(recordings, self.runs(recordings), strict=True)
        ]
        return [w.thinned() for part in cut for w in part]

    def free_of_pushes(self, recordings: Sequence[Recording]) -> list[Run]:
        """The same as long as nothing outside pushes."""
        return [
            piece
            for n, r in zip(recordings, self.runs(recordings), strict=True)
            for piece in r.between(self.left_out.get(n.name, ()))
        ]

    def folds(self) -> tuple[list[Recording], list[Recording]]:
        """Training recordings to fit and to choose on; the ones held out have no say.

        The end of a single one is nearly at rest, which a model without any friction predicts well: there the whole of it decides.
        """
        if len(self.train) > 1:
            return self.train[:-1], self.train[-1:]
        return [piece(self.train[0], 0.0, 0.7)], [self.train[0]]


def published(case: Asked) -> Found:
    """The model as its authors published it."""
    return native(case.system), {}


def practitioner(case: Asked) -> Found:
    """Least squares with choice by data held out within the training recordings."""
    _, chosen = fit(case.system, case.train, case.window, case.left_out)
    half = {k: 1.96 * v for k, v in chosen.std.items()}
    return chosen.free_run, {"kept": chosen.laws, "values": chosen.values, "half95": half}


def sysid(case: Asked) -> Found:
    """``mujoco.sysid``; its armature, centre of mass or mass freed, whichever fits better."""
    runs = case.runs(case.train)
    gaps = [case.left_out.get(r.name, ()) for r in case.train]
    found = fit_sysid(case.system, runs, window=case.window, left_out=gaps, inertial=REAL[any(r.driven for r in runs)])
    half = {k: v if np.isfinite(v) else None for k, v in found.half.items()}
    kept = [WHAT[name.split(":")[-1]] for name in found.beyond()]
    return found.free_run, {"kept": kept, "values": dict(found.values), "half95": half}


def ladder(case: Asked) -> Found:
    """BAM's M1 to M6 and what is below, the step chosen by a training recording that is not fitted to."""
    if len(case.system.joint_names) != 1 or case.system.movable_joints[0].prismatic:
        raise NotForIt("it is for one joint that turns")
    known, tried = case.folds()
    found, errors = climb(arm_of(case.system), case.windows(known), case.windows(tried))
    return found.free_run, {
        "kept": LADDER[found.model],
        "model": found.model,
        "values": dict(found.values),
        "ladder": errors,
    }


def figaroh(case: Asked) -> Found:
    """FIGAROH on the effort, pushes from outside left out; with how it predicts the effort held out, and its numbers where efforts
    are taken as sampled, as those who published numbers of emps took them."""
    runs, held = case.free_of_pushes(case.train), case.free_of_pushes(case.heldout)
    frequency = max(swings(case.system)) / (2.0 * np.pi)
    found = fit_figaroh(case.system, runs, held, frequency)
    sampled = fit_figaroh(case.system, runs, held, frequency, held=False)
    half = {k: 1.96 * v for k, v in found.std.items()}
    kept = [k for k, v in found.values.items() if k[:3] in ("fv_", "fs_", "off") and abs(v) > half[k]]
    told: dict[str, Any] = {
        "effort_rmse": found.effort_rmse,
        "effort_held_out": found.prediction,
        "physical_fit": found.physical,
    }
    told |= {"efforts_held": found.held, "as_sampled": dict(sampled.values)}
    return found.free_run, {"kept": kept, "values": dict(found.values), "half95": half, **told}


def pysindy(case: Asked) -> Found:
    """Sparse regression on the torque left over, its threshold chosen by a training recording that is not fitted to."""
    known, tried = case.folds()
    found = fit_regression(case.system, case.free_of_pushes(known), case.free_of_pushes(tried))
    kept = sorted({name for terms in found.terms.values() for name in terms})
    return found.free_run, {"kept": kept, "values": {j: dict(terms) for j, terms in found.terms.items()}}


PEERS: Mapping[str, Callable[[Asked], Found]] = {
    "published": published,
    "practitioner": practitioner,
    "mujoco.sysid": sysid,
    "BAM's ladder": ladder,
    "FIGAROH": figaroh,
    "pysindy": pysindy,
}


def ask(peer: str, case: Asked, limit: float | None = None) -> dict[str, Any]:
    """One cell of the table; limit: of the processor [s], for what is fitted."""
    began, worked = time.perf_counter(), time.process_time()
    try:
        with limited(limit):
            simulate, told = PEERS[peer](case)
        seconds, processor = time.perf_counter() - began, time.process_time() - worked
        errors = judge(simulate, case.system, case.train, case.heldout, case.window, case.left_out)
    except NotForIt as error:
        return {"not_for_it": str(error)}
    except TooLong:
        return {"ended_after_processor_s": limit, "seconds": round(time.perf_counter() - began, 1)}
    except Exception as error:  # a peer may fail in any way; the table says so
        return {"error": f"{type(error).__name__}: {error}"}
    return {**told, **errors, "seconds": round(seconds, 1), "processor_seconds": round(processor, 1)}


def made(cell: Mapping[str, Any] | None, limit: float | None) -> bool:
    """Whether a cell stands; one that was ended does where the limit is no higher now."""
    if cell is None:
        return False
    ended = cell.get("ended_after_processor_s")
    return ended is None or (limit is not None and limit <= ended)


def main() -> None:
    arguments, folder = asked_rigs(
        __doc__ or "",
        peers={"nargs": "+", "choices": PEERS, "default": list(PEERS), "help": "default: all"},
        window=WINDOW,
        limit={"type": float, "help": "end a peer after so many seconds of the processor; default: never"},
    )
    target = Path(arguments.json) if arguments.json else None
    rows: dict[str, Any] = json.loads(target.read_text(encoding="utf-8"))["rigs"] if target and target.exists() else {}
    for rig in arguments.rigs or sorted(p.name for p in folder.iterdir() if (p / "model.urdf").exists()):
        case: Asked | None = None
        for peer in arguments.peers:
            if made(rows.get(rig, {}).get(peer), arguments.limit):
                continue
            case = case or Asked(rig, folder, Path(arguments.work), arguments.window)
            row = rows.setdefault(rig, {"unit": case.system.movable_joints[0].position_unit, "window_s": case.window})
            row[peer] = cell = ask(peer, case, arguments.limit)
            held = cell.get("heldout")
            errors = f"{held['first_sample']:.4g} / {held['state_fitted']:.4g} {row['unit']}" if held else str(cell)
            print(f"{rig:22s} {peer:14s} {errors}  {cell.get('seconds', '')}", flush=True)
            if target:
                table = {"schema": "denoc.peers_on_rigs/1", "note": NOTE, "rigs": {k: rows[k] for k in sorted(rows)}}
                target.write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
