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


class Spared(IntEnum):
    """What work is left in peace when its time is over: nothing; for a while; to its end."""

    NOT = 0
    FOR_LONG = 1
    TO_ITS_END = 2


_spared: ContextVar[Spared] = ContextVar("spared", default=Spared.NOT)


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
        self._shared = float("inf")
        self._parts: list[Deadline] = []
        self.interrupted = False

    @property
    def limited(self) -> bool:
        """Whether there is an end to it from the beginning."""
        return self._ends[-1] < float("inf")

    def part(self, share: float) -> Deadline:
        """A deadline of its own for something that may take a share of what is left; interrupted with this one."""
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
        spared = _spared.get() is not Spared.NOT
        later = self._stage < Stage.TELLING and spared
        end = self._ends[self._stage + 1 if later else self._stage]
        return monotonic() >= (end if spared else min(end, self._shared))

    def begin(self, stage: Stage) -> None:
        """Go on to a stage."""
        self._stage = stage

    def interrupt(self) -> None:
        """Come to an end now, with the best answer so far."""
        now = monotonic()
        self.interrupted = True
        for part in self._parts:
            part.interrupt()
        self._ends = [
            min(end, now + further) for end, further in zip(self._ends, STAGE_TIMES_AT_INTERRUPT, strict=True)
        ]

    def check(self) -> None:
        """Raise TimeUp if the time is over; of what is spared, if it has been for long, or never."""
        spared = _spared.get()
        if spared is Spared.TO_ITS_END:
            return
        if self.over if spared is Spared.NOT else monotonic() >= self._ends[-1] + GRACE_TIME:
            raise TimeUp

    @contextmanager
    def spared(self, how: Spared = Spared.FOR_LONG) -> Iterator[None]:
        """Inside, work goes on though its time is over: what no answer should do without. Fits end there as soon as they may.

        how: for a while; or to its end, where that is near and nothing could be told without.
        """
        token = _spared.set(how)
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
        self,
        what: str,
        may_change: str,
        work: Callable[[], R],
        otherwise: Callable[[], R],
        *,
        spared: bool = False,
        share: float = 1.0,
    ) -> R:
        """The result of some work, or what there is otherwise if its time is over; that is then noted.

        spared: whether the work is, for a while; what there is otherwise is, to its end. share: of what is left of the stage, that
        the work may take.
        """
        token = _spared.set(Spared.FOR_LONG if spared else Spared.NOT)
        try:
            with self._sharing(share):
                return work()
        except TimeUp:
            self.leave(what, may_change)
        finally:
            _spared.reset(token)
        with self.spared(Spared.TO_ITS_END):
            return otherwise()

    def within(self, share: float, what: str, may_change: str, work: Callable[[], R], otherwise: Callable[[], R]) -> R:
        """The same where what is otherwise takes time, too: raises TimeUp where the stage is over as well."""
        try:
            with self._sharing(share):
                return work()
        except TimeUp:
            self.check()
        self.leave(what, may_change)
        return otherwise()

    @contextmanager
    def _sharing(self, share: float) -> Iterator[None]:
        """Inside, time is over after a share of what is left of the stage."""
        now, before = monotonic(), self._shared
        if share < 1.0:
            self._shared = min(before, now + share * (self._ends[self._stage] - now))
        try:
            yield
        finally:
            self._shared = before


def deadline_of(limit: float | Deadline | None) -> Deadline:
    """A deadline as users state it: seconds from now on, none, or one that they can interrupt.

    Raises InputError unless it is positive.
    """
    return limit if isinstance(limit, Deadline) else Deadline(limit)
