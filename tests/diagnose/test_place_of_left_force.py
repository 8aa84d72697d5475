"""Where most of a force lies that a fit leaves out; nowhere, where the most is elsewhere and spread evenly."""

from __future__ import annotations

import numpy as np

from harness.diagnose.criticism.left_force import LeftForce, place_of, recorded
from harness.diagnose.problem.problem import ChannelInfo, Problem, Run
from harness.diagnose.problem.windows import Window
from harness.system import Joint, JointType, Link, System


def arm() -> System:
    """Two joints about the vertical, alike, so that forces at both weigh alike."""
    joints, links, below = [], [], "base"
    for name in ("first", "second"):
        joints.append(Joint(name, JointType.CONTINUOUS, below, f"{name}_link", axis=np.array([0.0, 0.0, 1.0])))
        links.append(Link(f"{name}_link", 1.0, np.zeros(3), np.diag([1e-2] * 3)))
        below = f"{name}_link"
    return System("arm", tuple(joints), tuple(links))


def left(joint: str, size: float, *, forwards_alone: bool) -> LeftForce:
    """A force of one size in a swing that was recorded for ten whole periods, or while it moves forwards."""
    time = np.arange(0.0, 10.0, 0.01)
    q, qd = np.sin(2.0 * np.pi * time), 2.0 * np.pi * np.cos(2.0 * np.pi * time)
    force = np.where((qd > 0.0) | (not forwards_alone), size, 0.0)
    return LeftForce(joint, 0, time, q, qd, force)


def test_a_place_that_holds_most_is_told() -> None:
    parts = [left("first", 1.0, forwards_alone=True), left("second", 0.1, forwards_alone=False)]
    found = place_of(arm(), ["run"], parts)
    assert found is not None
    assert (found.joint, found.where) == ("first", "moving forwards")
    assert found.share > 0.9 and abs(found.of_time - 0.5) < 0.01


def test_a_place_that_holds_less_than_its_share_of_the_time_is_not() -> None:
    parts = [left("first", 1.0, forwards_alone=True), left("second", 40.0, forwards_alone=False)]
    assert place_of(arm(), ["run"], parts) is None


def near(place: float, width: float, *, memory: float = 0.02, turns: float = 0.0) -> LeftForce:
    """A swing of half a radian (or a steady turning) past a magnet, with weak noise of a force everywhere."""
    rng = np.random.default_rng(3)
    time = np.arange(0.0, 10.0, 0.01)
    q = 2.0 * np.pi * turns * time / 10.0 if turns else 0.5 * np.sin(2.0 * np.pi * 0.7 * time)
    away = np.mod(q - place + np.pi, 2.0 * np.pi) - np.pi
    force = np.where(np.abs(away) < width, 1.0, 0.0) + 0.05 * rng.standard_normal(len(time))
    return LeftForce("first", 0, time, q, np.gradient(q, time), force, memory)


def within(text: str) -> tuple[float, float]:
    """The ends of a stretch in words."""
    low, high = text.removeprefix("within ").removesuffix(" of every turn").removesuffix(" rad").split(" … ")
    return float(low), float(high)


def test_a_magnet_beside_the_way_is_told_by_where_it_is() -> None:
    found = place_of(arm(), ["run"], [near(0.2, 0.04)])
    assert found is not None
    low, high = within(found.where)
    assert low < 0.2 < high and high - low <= 0.2
    assert found.share > 0.8 and found.of_time < 0.25


def test_a_place_of_what_turns_many_times_is_one_of_every_turn() -> None:
    found = place_of(arm(), ["run"], [near(2.2, 0.1, turns=8.0)])
    assert found is not None and found.where.endswith("rad of every turn")
    low, high = within(found.where)
    assert low < 2.2 < high and high - low < 0.7


def test_an_end_of_the_way_is_told_as_beyond() -> None:
    time = np.arange(0.0, 10.0, 0.01)
    q = np.abs(np.mod(time, 2.0) - 1.0) - 0.5  # to and fro at one speed, so that none is the end's own
    part = LeftForce("first", 0, time, q, np.gradient(q, time), np.where(q > 0.45, 1.0, 0.0), 0.02)
    found = place_of(arm(), ["run"], [part])
    assert found is not None and found.where.startswith("above 0.")


def test_what_sets_in_and_what_passes_is_told_by_when() -> None:
    rng = np.random.default_rng(5)
    time = np.arange(0.0, 10.0, 0.01)
    q, qd = np.sin(2.0 * np.pi * time), 2.0 * np.pi * np.cos(2.0 * np.pi * time)

    def part(run: int, acting: np.ndarray) -> LeftForce:
        return LeftForce("first", run, time, q, qd, acting + 0.05 * rng.standard_normal(len(time)), 0.02)

    still = np.zeros(len(time))
    off = place_of(arm(), ["a", "b"], [part(0, still), part(1, np.where(time > 5.3, 1.0, 0.0))])
    assert off is not None and off.where.startswith("after 5.") and off.where.endswith(" s of b")
    assert abs(float(off.where.split()[1]) - 5.3) < 0.2
    knock = place_of(arm(), ["a", "b"], [part(0, np.where(abs(time - 4.1) < 0.2, 1.0, 0.0)), part(1, still)])
    assert knock is not None and knock.where.endswith(" s of a")
    first, last = (float(word) for word in knock.where.split() if word[0].isdigit())
    assert first <= 3.95 and last >= 4.25 and last - first <= 1.0


def test_of_many_places_none_is_told_that_chance_makes() -> None:
    """A force that keeps long has few independent pieces, one of which is always near some place."""
    time = np.arange(0.0, 20.0, 0.01)
    q = 0.5 * np.sin(2.0 * np.pi * 0.7 * time)
    narrow = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        force = np.convolve(rng.standard_normal(len(time) + 400), np.exp(-np.arange(400) / 30.0), mode="valid")[
            : len(time)
        ]
        part = LeftForce("first", 0, time, q, np.gradient(q, time), force, 0.3)
        found = place_of(arm(), ["run"], [part])
        narrow += found is not None and ("within" in found.where or " s of run" in found.where)
    assert narrow <= 2


def problem_of(q: np.ndarray, time: np.ndarray, noise: float) -> Problem:
    """The first joint alone recorded."""
    values = (q + noise * np.random.default_rng(1).standard_normal(len(time)))[None]
    channel = ChannelInfo("first.position", "first", "position", "rad")
    return Problem(arm(), (channel,), (Run("run", time, values, None, 0.01),), ())


def test_the_motion_is_the_recorded_one() -> None:
    time = np.arange(0.0, 10.0, 0.01)
    q = 6.0 * time + 0.2 * np.sin(6.0 * time)  # a rotor that wavers and never turns back
    posed = problem_of(q, time, 1e-3)
    found = recorded(posed, Window(0, 100, 900), "first", time[100:900], 0.05)
    assert found is not None
    assert np.abs(found[0] - q[100:900]).max() < 0.01
    assert found[1].min() > 4.0
    assert recorded(posed, Window(0, 100, 900), "second", time[100:900], 0.05) is None


def test_noise_of_what_rests_is_no_motion() -> None:
    time = np.arange(0.0, 10.0, 0.01)
    found = recorded(problem_of(np.zeros(len(time)), time, 1e-3), Window(0, 0, 1000), "first", time, 0.05)
    assert found is not None
    assert np.mean(found[1] == 0.0) > 0.9
