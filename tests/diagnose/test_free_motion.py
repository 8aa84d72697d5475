"""Where free motion begins and ends: a hand that carries, holds or stops the mechanism, and none."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness.diagnose.conditioning.free_motion import carried_end, carried_start, free_parts
from harness.recording import Recording
from harness.recording.recording import Channel
from harness.system import System
from harness.system.description import Joint, JointType, Link, constant

LENGTH, MASS = 0.2, 0.1
NOISE = 3e-4
RATE = 500.0


def pendulum(inertia: float = 0.0) -> System:
    """A point mass on a massless rod, with further inertia about its centre."""
    joint = Joint("pivot", JointType.CONTINUOUS, "base", "arm", axis=constant([0.0, 1.0, 0.0]))
    link = Link("arm", MASS, constant([0.0, 0.0, -LENGTH]), constant(np.diag([inertia, inertia, 0.0])))
    return System("pendulum", (joint,), (link,))


def recording(
    time: np.ndarray, angle: np.ndarray, *, seed: int = 1, effort: np.ndarray | None = None, loud: float = NOISE
) -> Recording:
    noise = np.random.default_rng(seed).normal(0.0, loud, len(time))
    channel = Channel("pivot.position", "pivot", "position", "rad", angle + noise)
    efforts = () if effort is None else (Channel("pivot.effort", "pivot", "effort", "N*m", effort),)
    return Recording("swing", "", time, (channel,), efforts)


def free_swing(angle: float, speed: float, time: np.ndarray, *, dry: float = 0.0, drag: float = 0.0) -> np.ndarray:
    """q'' = −g/l sin q − dry sign q' − drag q' |q'|, by scipy's integrator."""

    def slope(_: float, y: np.ndarray) -> list[float]:
        grip = np.tanh(y[1] / 1e-2)
        return [y[1], -9.81 / LENGTH * np.sin(y[0]) - dry * grip - drag * y[1] * abs(y[1])]

    return solve_ivp(slope, (time[0], time[-1]), [angle, speed], t_eval=time, rtol=1e-9, atol=1e-10).y[0]


def carried(until: float, *, dry: float = 0.8) -> tuple[np.ndarray, np.ndarray]:
    """A hand moves the pendulum at constant speed from −1 rad to −1 − 1.5 · until, then lets go."""
    time = np.arange(0.0, 6.0, 1.0 / RATE)
    by_hand = time < until
    angle = np.empty_like(time)
    angle[by_hand] = -1.0 - 1.5 * time[by_hand]
    rest = time[~by_hand]
    angle[~by_hand] = free_swing(-1.0 - 1.5 * rest[0], -1.5, rest, dry=dry)
    return time, angle


@pytest.mark.parametrize("until", [0.15, 0.3, 0.6])
def test_a_carrying_hand_is_cut_off(until: float) -> None:
    # The hand cancels gravity altogether: its force is g/l sin 1 … sin 1.9, all of what the model has there.
    found = carried_start(pendulum(), recording(*carried(until)))
    assert found is not None
    assert found.joint == "pivot"
    period = 2.0 * np.pi * np.sqrt(LENGTH / 9.81)
    assert until - 0.02 <= found.time <= until + 0.15 * period
    assert 0.5 < found.share < 1.5


def test_what_is_left_is_free_motion_and_a_note_tells() -> None:
    time, angle = carried(0.3)
    cut = free_parts(pendulum(), [recording(time, angle)])[0]
    assert cut.time[0] == 0.0
    assert cut.start == pytest.approx(cut.quality[-1].size, abs=1.0 / RATE)
    assert cut.quality[-1].kind == "carried_start"
    assert len(cut.channels[0].values) == len(cut.time) == len(time) - cut.quality[-1].count
    assert carried_start(pendulum(), cut) is None


@pytest.mark.parametrize(
    ("dry", "drag", "inertia"),
    [(0.0, 0.0, 0.0), (1.5, 0.0, 0.0), (0.0, 0.05, 0.0), (0.5, 0.02, 0.0), (0.3, 0.0, 0.3 * MASS * LENGTH**2)],
)
def test_free_motion_is_left_alone_whatever_the_model_lacks(dry: float, drag: float, inertia: float) -> None:
    time = np.arange(0.0, 6.0, 1.0 / RATE)
    for seed, (angle, speed) in enumerate([(1.5, 0.0), (-0.4, 0.0), (0.3, 6.0), (2.6, -1.0)]):
        swing = recording(time, free_swing(angle, speed, time, dry=dry, drag=drag), seed=seed)
        assert carried_start(pendulum(inertia), swing) is None
        assert free_parts(pendulum(inertia), [swing]) == [swing]


def test_a_hand_that_only_holds_is_not_cut_off() -> None:
    # Standing still until the release is an effect of the catalogue, with a time to be fitted.
    time = np.arange(0.0, 6.0, 1.0 / RATE)
    held = time < 0.4
    angle = np.full_like(time, 1.2)
    angle[~held] = free_swing(1.2, 0.0, time[~held], dry=0.3)
    assert carried_start(pendulum(), recording(time, angle)) is None


@pytest.mark.parametrize("held_for", [0.1, 0.15, 0.2, 0.3])
def test_noise_of_what_is_held_does_not_pass_for_its_speed(held_for: float) -> None:
    time = np.arange(0.0, 6.0, 1.0 / RATE)
    held = time < held_for
    angle = np.full_like(time, -0.3)
    angle[~held] = free_swing(-0.3, 0.0, time[~held])
    for seed in range(6):
        assert carried_start(pendulum(), recording(time, angle, seed=seed, loud=4e-3)) is None


def test_a_reading_cut_off_at_every_turn_is_no_hand() -> None:
    # At the first turn it lasts for one window of forces only, and what comes after is the next turn and no knock.
    time = np.arange(0.0, 12.0, 1.0 / RATE)
    angle = np.minimum(free_swing(1.45, 0.0, time, drag=0.03), 1.434)
    for seed in range(6):
        assert carried_start(pendulum(), recording(time, angle, seed=seed, loud=3.3e-3)) is None


def taken_up(still: float, *, held: float = 0.0) -> tuple[np.ndarray, np.ndarray, float]:
    """It hangs at rest for ``still`` seconds, a hand lifts it by 1.1 rad in 0.6 s and lets go after ``held`` seconds more."""
    time = np.arange(0.0, 12.0, 1.0 / RATE)
    lifted = np.clip((time - still) / 0.6, 0.0, 1.0)
    angle = 1.1 * (10.0 * lifted**3 - 15.0 * lifted**4 + 6.0 * lifted**5)
    release = still + 0.6 + held
    angle[time >= release] = free_swing(1.1, 0.0, time[time >= release], dry=0.3)
    return time, angle, release


@pytest.mark.parametrize("held", [0.0, 0.7])
@pytest.mark.parametrize("still", [0.5, 2.5])
def test_a_hand_that_takes_up_what_hangs_at_rest_is_cut_off(still: float, held: float) -> None:
    # Nothing that hangs in balance begins to move by itself; the logger ran before the experimenter was ready.
    time, angle, release = taken_up(still, held=held)
    found = carried_start(pendulum(), recording(time, angle))
    assert found is not None
    period = 2.0 * np.pi * np.sqrt(LENGTH / 9.81)
    assert release - 0.02 <= found.time <= release + 0.2 * period
    assert still <= found.rested <= still + 0.2
    cut = free_parts(pendulum(), [recording(time, angle)])[0]
    assert "hangs at rest" in cut.quality[-1].what
    assert carried_start(pendulum(), cut) is None


def test_a_knock_that_ends_a_rest_is_cut_off() -> None:
    time = np.arange(0.0, 8.0, 1.0 / RATE)
    angle = np.where(time < 1.0, 0.0, np.nan)
    angle[time >= 1.0] = free_swing(0.0, 4.0, time[time >= 1.0], dry=0.3)
    found = carried_start(pendulum(), recording(time, angle))
    assert found is not None
    assert 1.0 <= found.time <= 1.2


def test_what_falls_from_upright_by_itself_is_not_cut_off() -> None:
    time = np.arange(0.0, 10.0, 1.0 / RATE)
    assert carried_start(pendulum(), recording(time, free_swing(np.pi - 1e-5, 0.0, time, dry=0.0, drag=0.02))) is None


def test_driven_recordings_are_not_judged() -> None:
    time, angle = carried(0.3)
    driven = recording(time, angle, effort=np.sin(time))
    assert carried_start(pendulum(), driven) is None
    idle = recording(time, angle, effort=np.zeros_like(time))
    assert carried_start(pendulum(), idle) is not None


def test_a_joint_that_is_not_measured_leaves_the_recording_alone() -> None:
    time, angle = carried(0.3)
    swing = recording(time, angle)
    other = Recording(
        "swing", "", time, (Channel("pivot.velocity", "pivot", "velocity", "rad/s", np.gradient(angle, time)),)
    )
    assert carried_start(pendulum(), swing) is not None
    assert carried_start(pendulum(), other) is None


def stopped(at: float, *, carried_to: float | None = None, seed: int = 1) -> Recording:
    """A swing that a hand stops within a tenth of a second, and then carries to another angle if one is given."""
    time = np.arange(0.0, 9.0, 1.0 / RATE)
    angle = free_swing(1.4, 0.0, time, dry=0.8)
    after = time >= at
    since, first = time[after] - at, int(np.argmax(after))
    speed = (angle[first] - angle[first - 1]) * RATE
    angle[after] = angle[first] + 0.04 * speed * (1.0 - np.exp(-since / 0.04))
    if carried_to is not None:
        angle[after] += (carried_to - angle[after]) * (0.5 - 0.5 * np.cos(np.pi * np.clip(since, 0.0, 1.0)))
    return recording(time, angle, seed=seed)


@pytest.mark.parametrize("carried_to", [None, 0.7])
@pytest.mark.parametrize("at", [6.13, 7.4])
def test_a_hand_that_stops_it_is_cut_off(at: float, carried_to: float | None) -> None:
    whole = stopped(at, carried_to=carried_to)
    found = carried_end(pendulum(), whole)
    assert found is not None
    period = 2.0 * np.pi * np.sqrt(LENGTH / 9.81)
    assert at - 0.2 * period <= found.time <= at + 0.02
    (cut,) = free_parts(pendulum(), [whole])
    assert cut.time[0] == 0.0
    assert cut.time[-1] == pytest.approx(found.time, abs=1.0 / RATE)
    assert cut.quality[-1].kind == "carried_end"
    assert cut.quality[-1].count == whole.samples - cut.samples
    assert carried_end(pendulum(), cut) is None


@pytest.mark.parametrize("dry", [2.0, 6.0, 12.0])
def test_what_friction_stops_is_not_cut_off(dry: float) -> None:
    # It may stand a quarter of gravity's torque off its lowest place.
    time = np.arange(0.0, 6.0, 1.0 / RATE)
    for seed, angle in enumerate((1.5, 1.1, 0.9, 0.7)):
        assert carried_end(pendulum(), recording(time, free_swing(angle, 0.0, time, dry=dry), seed=seed)) is None


def test_what_lies_against_a_stop_is_not_cut_off() -> None:
    # Nothing goes beyond the stop, here or in another recording; a hand would have stopped it where it had been before.
    whole = stopped(6.5, carried_to=0.7)
    held = np.minimum(whole.channels[0].values, 0.7)
    before_stop = recording(whole.time, np.where(whole.time < 0.15, 0.7, held), loud=0.0)
    assert carried_end(pendulum(), before_stop) is None
    other = recording(whole.time, free_swing(1.3, 0.0, whole.time), seed=2)
    assert carried_end(pendulum(), before_stop, [other]) is not None
