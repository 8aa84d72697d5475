"""The end of a diagnosis, of its stages, and of shares of these."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from harness.diagnose.problem import deadline as module
from harness.diagnose.problem.constants import STAGE_SHARES, STAGE_TIMES_AT_INTERRUPT
from harness.diagnose.problem.deadline import Deadline, Stage, TimeUp
from harness.errors import InputError


@dataclass
class Clock:
    """What deadlines take the time from. now: [s]."""

    now: float = 0.0


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(module, "monotonic", lambda: clock.now)
    return clock


def test_every_stage_has_its_share_of_the_time(clock: Clock) -> None:
    clock.now = 100.0
    end = Deadline(10.0)
    for stage, share in zip(Stage, STAGE_SHARES, strict=True):
        end.begin(stage)
        clock.now = 100.0 + 10.0 * share - 0.01
        end.check()
        clock.now += 0.02
        with pytest.raises(TimeUp):
            end.check()
        with end.spared():
            end.check()


def test_what_is_left_is_noted_once_and_what_there_is_taken(clock: Clock) -> None:
    end = Deadline(1.0)
    clock.now = 2.0

    def work() -> str:
        end.check()
        return "all"

    with end.spared():
        assert work() == "all"
        # What is attempted is not spared, wherever it is begun.
        assert [end.attempt("rivals", "nothing", work, lambda: "some") for _ in range(2)] == ["some", "some"]
    assert [(n.what, n.may_change) for n in end.not_tried] == [("rivals", "nothing")]


def test_work_may_take_a_share_of_its_stage(clock: Clock) -> None:
    end = Deadline(10.0)
    half = 5.0 * STAGE_SHARES[Stage.SEARCH]

    def until(moment: float) -> str:
        clock.now = moment
        end.check()
        return "all"

    note = "few effects", "another answer"
    assert end.within(0.5, *note, lambda: until(half - 0.01), lambda: "some") == "all"
    clock.now = 0.0
    # What is spared goes on, and so does what comes afterwards.
    with end.spared():
        assert end.within(0.5, *note, lambda: until(half + 0.01), lambda: "some") == "all"
    clock.now = 0.0
    assert end.within(0.5, *note, lambda: until(half + 0.01), lambda: "some") == "some"
    assert end.attempt(*note, lambda: until(half + 0.02), lambda: "some") == "all"
    assert end.attempt(*note, lambda: until(2.0 * half - 0.01), lambda: "some", share=0.5) == "some"
    assert len(end.not_tried) == 1
    with pytest.raises(TimeUp):
        end.within(0.5, *note, lambda: until(2.0 * half + 0.01), lambda: "some")


def test_what_there_is_otherwise_is_done_to_its_end(clock: Clock) -> None:
    end = Deadline(1.0)
    clock.now = 100.0

    def work() -> str:
        end.check()
        return "told"

    with end.spared(), pytest.raises(TimeUp):
        work()
    assert end.attempt("errors", "nothing", work, work) == "told"
    with end.spared(module.Spared.TO_ITS_END):
        assert work() == "told"


def test_an_interrupt_brings_every_stage_to_its_end_soon(clock: Clock) -> None:
    end = Deadline()
    clock.now = 1e6
    end.check()
    end.interrupt()
    assert end.over
    end.begin(Stage.TELLING)
    assert not end.over
    clock.now += STAGE_TIMES_AT_INTERRUPT[-1]
    assert end.over


def test_no_time_at_all_is_refused() -> None:
    for limit in (0.0, -1.0, float("nan")):
        with pytest.raises(InputError, match="more than 0 seconds"):
            Deadline(limit)
