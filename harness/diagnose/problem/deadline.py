"""How long a diagnosis may take: when the time is up, what is left is told and the best answer so far is given.

Work asks its deadline wherever motions are computed, and is left by ``TimeUp`` once its share of the time is over. Whoever began it
says what has not been tried, and goes on with what there is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from enum import IntEnum
from time import monotonic
from typing import TypeVar

from harness.diagnose.problem.constants import GRACE_TIME, STAGE_SHARES, STAGE_TIMES_AT_INTERRUPT
from harness.errors import InputError

R = TypeVar("R")


class TimeUp(Exception):
    """The time of what is being done is over."""


class Stage(IntEnum):
    """What a diagnosis does, one after the other."""

    SEARCH = 0
    RIVALS = 1
    CRITICISM = 2
    TELLING = 3


@dataclass(frozen=True)
class NotTried:
    """What was left when the time was up, and what it may change."""

    what: str
    may_change: str


_spared: ContextVar[bool] = ContextVar("spared", default=False)


class Deadline:
    """The end of one diagnosis, of each of its stages, and what was left for it."""

    def __init__(self, limit: float | None = None) -> None:
        """limit: time from now on [s]; None for as long as it takes. Raises InputError unless it is positive."""
        if limit is not None and not limit > 0.0:
            raise InputError(f"a time limit of {limit:g} s", mend="give more than 0 seconds, or none")
        self._begun = monotonic()
        self._ends = [float("inf") if limit is None else self._begun + share * limit for share in STAGE_SHARES]
        self._stage = Stage.SEARCH
        self._left: list[NotTried] = []
        self._parts: list[Deadline] = []

    @property
    def limited(self) -> bool:
        """Whether there is an end to it from the beginning."""
        return self._ends[-1] < float("inf")

    def part(self, share: float) -> Deadline:
        """A deadline of its own for something that comes first and may take a share of what is left; interrupted with this one."""
        part = Deadline(max(share * (self._ends[-1] - monotonic()), 1e-3))
        self._parts.append(part)
        return part

    @property
    def not_tried(self) -> tuple[NotTried, ...]:
        """What was left so far."""
        return tuple(self._left)

    @property
    def over(self) -> bool:
        """Whether the stage's time is over; of what is spared, whether the next one's is."""
        later = self._stage < Stage.TELLING and _spared.get()
        return monotonic() >= self._ends[self._stage + 1 if later else self._stage]

    def begin(self, stage: Stage) -> None:
        """Go on to a stage."""
        self._stage = stage

    def interrupt(self) -> None:
        """Come to an end now, with the best answer so far."""
        now = monotonic()
        for part in self._parts:
            part.interrupt()
        self._ends = [
            min(end, now + further) for end, further in zip(self._ends, STAGE_TIMES_AT_INTERRUPT, strict=True)
        ]

    def check(self) -> None:
        """Raise TimeUp if the time is over, or of what is spared, if it has been for long."""
        if monotonic() >= self._ends[-1] + GRACE_TIME if _spared.get() else self.over:
            raise TimeUp

    @contextmanager
    def spared(self) -> Iterator[None]:
        """Inside, work goes on though its time is over, if not for long: what no answer should do without. Fits end there as soon
        as they may."""
        token = _spared.set(True)
        try:
            yield
        finally:
            _spared.reset(token)

    def leave(self, what: str, may_change: str) -> None:
        """Note what was left, once."""
        note = NotTried(what, may_change)
        if note not in self._left:
            self._left.append(note)

    def attempt(
        self, what: str, may_change: str, work: Callable[[], R], otherwise: Callable[[], R], *, spared: bool = False
    ) -> R:
        """The result of some work, or what there is otherwise if its time is over; that is then noted.

        spared: whether the work is; what there is otherwise always is.
        """
        token = _spared.set(spared)
        try:
            return work()
        except TimeUp:
            self.leave(what, may_change)
        finally:
            _spared.reset(token)
        with self.spared():
            return otherwise()


def deadline_of(limit: float | Deadline | None) -> Deadline:
    """A deadline as users state it: seconds from now on, none, or one that they can interrupt.

    Raises InputError unless it is positive.
    """
    return limit if isinstance(limit, Deadline) else Deadline(limit)
