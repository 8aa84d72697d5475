"""From when on two motions differ, and whether by their models or by how they are integrated, as a finer run of each tells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.system import Trajectory

Array = NDArray[np.float64]

# A difference is the model's where it is this many times what finer integration changes.
CLEAR = 5.0
# Finer integration mends a difference of which it leaves no more than this: half the step of a method of order one leaves half.
MENDED = 0.75
# Share of the motion that rounding makes.
ROUNDING = 1e-13


@dataclass(frozen=True, eq=False)
class Finer:
    """A motion integrated once more, finer.

    how: what was done, as the subject of a sentence. position: shape (T, n), None where the engine answers to no step, and what
    its integration errs by is not known.
    """

    how: str
    position: Array | None


@dataclass(frozen=True, eq=False)
class Motion:
    """An engine's motion, shape (T, n), and a finer run of it; without one it is taken for exact."""

    engine: str
    position: Array
    finer: Finer | None = None

    @classmethod
    def of(cls, engine: str, run: Trajectory, finer: Finer | None, names: Sequence[str]) -> Motion:
        """The coordinates that are named."""
        columns = [run.position_names.index(name) for name in names]
        if finer is not None and finer.position is not None:
            finer = replace(finer, position=finer.position[:, columns])
        return cls(engine, run.position[:, columns], finer)

    @property
    def finest(self) -> Array:
        """The finer run, where there is one."""
        return self.position if self.finer is None or self.finer.position is None else self.finer.position

    def until(self, kept: NDArray[np.bool_]) -> Motion:
        """The samples that are kept."""
        finer = self.finer
        if finer is not None and finer.position is not None:
            finer = replace(finer, position=finer.position[kept])
        return Motion(self.engine, self.position[kept], finer)


@dataclass(frozen=True)
class Parting:
    """How two motions part.

    begins: first sample at which they differ by clearly more than integration makes, None where they never do or it is not known.
    cause: ``model``; ``run`` where the equations agree and no finer integration mends the motion; ``solver`` where it does; or
    nothing, where that cannot be told. words: the same as a sentence.
    """

    begins: int | None
    cause: str
    words: str

    def place(self, time: Array) -> dict[str, object]:
        """``begins`` [s] and ``cause``, where they are known, as a row's first divergence has them."""
        begins = {} if self.begins is None else {"begins": float(time[self.begins])}
        return begins | ({"cause": self.cause} if self.cause else {})


def parting(time: Array, first: Motion, second: Motion, allowed: float, *, one_equation: bool = False) -> Parting:
    """Of two motions that leave the line ``allowed`` [rad or m]; one_equation: whether their accelerations are known to agree."""
    motions = (first, second)
    apart = _reached(first.position, second.position)
    left = ~(apart <= allowed)
    if not left.any():
        return Parting(None, "", "")
    at = int(np.argmax(left))
    if not np.isfinite(apart[at]):
        return _no_number(time, motions, at)
    moved = {
        m.engine: (m.finer.how, _reached(m.position, m.finer.position))
        for m in motions
        if m.finer is not None and m.finer.position is not None
    }
    floor = np.max([course for _, course in moved.values()], axis=0, initial=0.0) + np.zeros(len(time))
    beyond = np.flatnonzero(left & np.isfinite(apart))
    with np.errstate(divide="ignore", invalid="ignore"):
        clearest = beyond[np.argmax(apart[beyond] / floor[beyond])]
    clear = bool(apart[clearest] > CLEAR * floor[clearest])
    # At the end if it is clear there, where the difference is largest: chaos makes both as large as the motion.
    shown = -1 if not clear or apart[-1] > CLEAR * floor[-1] else int(clearest)
    said = _said({name: (how, float(course[shown])) for name, (how, course) in moved.items()})
    if said and shown >= 0:
        said += f" up to {time[shown]:.4g} s"
    deaf = [m.engine for m in motions if m.finer is not None and m.finer.position is None]
    if deaf:
        verdict = "" if one_equation else ", and without what its integration errs by there is no verdict on the model"
        return Parting(None, "", "; ".join(filter(None, [said, f"{deaf[0]} answers to no step{verdict}"])))
    if clear:
        rounding = ROUNDING * (1.0 + float(np.nanmax(np.abs(first.position), initial=0.0)))
        begins = int(np.argmax(apart > np.maximum(CLEAR * floor, rounding)))
        cause = "run" if one_equation else "model"
        verdict = "no finer integration mends it" if one_equation else "it is the model, not the integration"
        return Parting(begins, cause, f"{said}: {verdict}" if said else "")
    mended = float(_reached(first.finest, second.finest)[at])
    if mended <= MENDED * apart[at]:
        brings = f"of {apart[at]:.1e} at {time[at]:.4g} s leaves {mended:.1e}"
        return Parting(None, "solver", f"{said}, and {brings}: it is the integration, and the model is not judged")
    return Parting(None, "", f"{said}: below that there is no verdict, the integration may be all of it")


def _reached(first: Array, second: Array) -> Array:
    """Largest difference so far, at each sample; what is not finite differs infinitely."""
    apart = np.abs(first - second).max(axis=1, initial=0.0)
    return np.asarray(np.maximum.accumulate(np.where(np.isfinite(apart), apart, np.inf)))


def _no_number(time: Array, motions: Sequence[Motion], at: int) -> Parting:
    broken = [m for m in motions if not np.isfinite(m.position[at]).all()]
    said, mended = [], True
    for motion in broken:
        words = f"{motion.engine} gives no finite number at {time[at]:.4g} s"
        if motion.finer is None or motion.finer.position is None:
            mended = False
        elif np.isfinite(motion.finer.position).all():
            words += f", and does with {motion.finer.how}"
        else:
            words, mended = f"{words}, nor with {motion.finer.how}", False
        said.append(words)
    return Parting(at, "solver" if mended else "", "; ".join(said))


def _said(moved: dict[str, tuple[str, float]]) -> str:
    """What finer integration changes in each engine: ``half the step moves a by 1e-9, b by 1e-6``."""
    parts: list[str] = []
    before = ""
    for name, (how, size) in moved.items():
        parts.append((f"{how} moves " if how != before else "") + f"{name} by {size:.1e}")
        before = how
    return ", ".join(parts)
