"""Readings that begin anew at a constant step are healed and told; what could as well be motion is refused or left alone."""

import numpy as np
import pytest

from harness.errors import InputError
from harness.recording import read_recording
from harness.recording.folded import Fold, round_modulus

RATE = 200.0
TIME = np.arange(0.0, 12.0, 1.0 / RATE)


def swing(amplitude=1.2, rest=0.0):
    return rest + amplitude * np.exp(-0.08 * TIME) * np.cos(2.0 * np.pi * 0.85 * TIME)


def spin(speed=25.0):
    return 0.3 + speed * (1.0 - np.exp(-0.2 * TIME)) / 0.2


def folded(angle, modulus, low=0.0, noise=0.0, grain=0.0, seed=0):
    reading = angle + np.random.default_rng(seed).normal(0.0, noise, len(angle)) if noise else angle
    if grain:
        reading = np.round(reading / grain) * grain
    return np.mod(reading - low, modulus) + low


def read(folder, reading, header="time,pivot.position", time=TIME):
    file = folder / "run.csv"
    file.write_text(header + "\n" + "".join(f"{t:.17g},{x:.17g}\n" for t, x in zip(time, reading, strict=True)))
    return read_recording(file)


def notes(recording, *kinds):
    return [note for note in recording.quality if note.kind in kinds]


# The step of the reading: counters of 8 to 32 bits, parts of a turn behind a gear, degrees, and sizes that are none of these.
COUNTS = 2.0 * np.pi / 163840


@pytest.mark.parametrize(
    "angle", [swing(), swing(2.2), swing(0.7, 0.4), spin()], ids=["swing", "wide", "offset", "spin"]
)
@pytest.mark.parametrize(("bits", "signed"), [(16, False), (16, True), (15, False)])
def test_a_counter_that_overflows(tmp_path, angle, bits, signed):
    size = 2.0**bits
    low = -size / 2 if signed else 0.0
    counts = folded(np.round(angle / COUNTS), size, low)
    recording = read(tmp_path, counts, "time,pivot.position [2*pi/163840 rad]")
    values = recording.channels[0].values
    if np.ptp(angle) < size * COUNTS and signed and np.array_equal(counts, np.round(angle / COUNTS)):
        assert not notes(recording, "folded")  # it never comes to an end of its range
        return
    (note,) = notes(recording, "folded")
    assert note.count == np.count_nonzero(np.abs(np.diff(counts)) > size / 2)
    assert note.size == pytest.approx(size * COUNTS, rel=1e-12)  # put onto the power of two, exactly
    assert np.allclose(values - values[0], angle - angle[0], rtol=0.0, atol=1.01 * COUNTS)
    if np.ptp(angle) < 3.0 * size * COUNTS:
        # A swing around zero gets its zero back; that of a spin cannot be known.
        assert np.allclose(values, angle, rtol=0.0, atol=0.51 * COUNTS)


@pytest.mark.parametrize("modulus", [np.pi, np.pi / 2, 2 * np.pi / 3, 4 * np.pi, 1.234, 7.7])
@pytest.mark.parametrize("noise", [0.0, 1e-3])
@pytest.mark.parametrize("seed", range(3))
def test_any_step_whatever_the_noise(tmp_path, modulus, noise, seed):
    angle = swing(2.4, 0.1) if modulus < 5.0 else spin(8.0)
    recording = read(tmp_path, folded(angle, modulus, 0.17, noise, seed=seed))
    values = recording.channels[0].values
    (note,) = notes(recording, "folded")
    # A step that is no round number is estimated: noise of a jump is some three times a reading's, the mean of n jumps has less.
    error = 1e-6 if noise == 0.0 else 10.0 * noise / np.sqrt(note.count)
    assert note.size == pytest.approx(modulus, abs=max(error, 2e-3 * modulus if noise == 0.0 else 0.0))
    left = values - angle
    assert np.ptp(left[np.isfinite(left)]) < 10.0 * noise + 4.0 * abs(note.size - modulus) + 1e-9


@pytest.mark.parametrize("gear", [3.0, 7.0, 7.5, 6.43])
@pytest.mark.parametrize("seed", range(4))
def test_half_turns_behind_a_gear_keep_their_size_over_many_rounds(tmp_path, gear, seed):
    """A sensor that repeats every half turn of the motor, π over the gear, whole or not: rounds must not add up an error."""
    angle, modulus, noise = swing(2.4, 0.1), np.pi / gear, 1e-3
    values = read(tmp_path, folded(angle, modulus, 0.07, noise, seed=seed)).channels[0].values
    left = values - angle
    rounds = np.rint(np.median(left) / modulus)
    # Nothing but the noise that was put there: 2400 samples of it stay within 5 standard deviations.
    assert np.abs(left - rounds * modulus).max() < 5.0 * noise


def test_a_sensor_of_half_a_turn_in_degrees(tmp_path):
    angle = swing(1.5, 0.2)
    recording = read(tmp_path, np.degrees(folded(angle, np.pi)), "time,pivot.position [deg]")
    assert notes(recording, "folded")[0].size == pytest.approx(np.pi, rel=1e-12)
    assert np.allclose(recording.channels[0].values, angle, rtol=0.0, atol=1e-9)


def test_what_an_unwrapping_in_the_wrong_unit_leaves(tmp_path):
    # numpy.unwrap takes degrees for radians: of each jump by 360 it leaves 360 − 57 · 2π = 1.858 degrees, beyond any bound.
    degrees = np.degrees(spin(6.0))
    wrong = np.unwrap(np.mod(degrees, 360.0))
    assert np.abs(np.diff(wrong - degrees)).max() > 1.8
    recording = read(tmp_path, wrong, "time,pivot.position [deg]")
    (note,) = notes(recording, "folded")
    assert note.size == pytest.approx(np.radians(360.0 - 57.0 * 2.0 * np.pi), rel=2e-2)
    values = recording.channels[0].values
    assert np.allclose(values - values[0], np.radians(degrees - degrees[0]), rtol=0.0, atol=0.02)


def test_a_slide_whose_counter_overflows(tmp_path):
    travel = 0.3 * np.sin(2.0 * np.pi * 0.4 * TIME)
    counts = folded(np.round(travel / 5e-6), 65536.0)
    recording = read(tmp_path, counts, "time,pivot.position [0.005 mm]")
    assert np.allclose(recording.channels[0].values, travel, rtol=0.0, atol=3e-6)


@pytest.mark.parametrize("seed", range(3))
def test_noise_to_and_fro_at_the_fold(tmp_path, seed):
    # It turns round just there.
    angle = 0.5 * np.cos(2.0 * np.pi * 0.5 * TIME)
    reading = folded(angle, 1.0, -0.5 + 1e-4, 1e-3, seed=seed)
    recording = read(tmp_path, reading)
    values = recording.channels[0].values
    assert np.nanmax(np.abs(values - angle)) < 6e-3 or np.nanmax(np.abs(np.abs(values - angle) - 1.0)) < 6e-3


def test_motion_too_fast_for_its_step_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"begins anew every 1 rad, and at .* \(sample faster"):
        read(tmp_path, folded(3.0 + 70.0 * TIME, 1.0))


def test_a_fold_over_a_gap_is_refused_only_if_it_may_have_gone_round(tmp_path):
    keep = (TIME < 3.0) | (TIME > 3.1)
    with pytest.raises(InputError, match=r"in the gap at 2\.995 s it may have gone round"):
        read(tmp_path, folded(spin(25.0), np.pi)[keep], time=TIME[keep])
    angle, keep = swing(2.4), (TIME < 3.0) | (TIME > 3.03)
    recording = read(tmp_path, folded(angle, np.pi)[keep], time=TIME[keep])
    assert np.allclose(recording.channels[0].values, angle[keep], rtol=0.0, atol=1e-9)


NO_FOLD = {
    # A stepper that goes on, seen coarsely; a joint thrown between two stops; one that is flung and caught.
    "staircase": np.floor(TIME / 0.4) * 0.3,
    "servo steps": 0.8 * np.sign(np.sin(2 * np.pi * 0.3 * TIME + 0.1)) * (1 + 0.02 * np.sin(40.0 * TIME)),
    "one count": np.round(0.6 * np.sin(2.0 * np.pi * 0.4 * TIME)) * 2 * np.pi / 4096,
    "bounces": np.abs(swing(1.0)),
    "swing": swing(),
}


@pytest.mark.parametrize("name", NO_FOLD)
@pytest.mark.parametrize("noise", [0.0, 1e-4])
def test_what_moves_so_is_left_alone(tmp_path, name, noise):
    reading = NO_FOLD[name] + np.random.default_rng(1).normal(0.0, noise, len(TIME)) if noise else NO_FOLD[name]
    recording = read(tmp_path, reading)
    assert not notes(recording, "folded", "wrapped_angle")


def test_a_single_reading_far_off_is_an_outlier(tmp_path):
    reading = swing() + np.random.default_rng(2).normal(0.0, 1e-3, len(TIME))
    reading[777] = -12.0
    recording = read(tmp_path, reading)
    assert not notes(recording, "folded", "wrapped_angle")
    assert notes(recording, "outlier")[0].count == 1 and np.isnan(recording.channels[0].values[777])


def test_one_sample_a_turn_is_a_wheels_motion(tmp_path):
    # A pulse a turn of a wheel that slows down by viscous friction: θ = w T (1 − exp(−t/T)), solved for the times of whole turns.
    turns = np.arange(200)
    speed, decay = 60.0, 30.0
    time = -decay * np.log(1.0 - 2.0 * np.pi * turns / (speed * decay))
    recording = read(tmp_path, 2.0 * np.pi * turns, time=time)
    assert np.allclose(recording.channels[0].values, 2.0 * np.pi * turns, rtol=0.0, atol=1e-9)
    assert not notes(recording, "folded", "wrapped_angle", "outlier")


def test_a_jump_off_such_a_motion_is_still_refused(tmp_path):
    turns = np.arange(200.0)
    turns[120:] += 1.0
    with pytest.raises(InputError, match="not wrapped to one turn"):
        read(tmp_path, 2.0 * np.pi * turns, time=0.1 * np.arange(200.0))


@pytest.mark.parametrize(
    ("header", "mapping", "mend", "column"),
    [
        ("time,pivot.position", (), "write pivot.position [deg] in the header", "pivot.position"),
        ("time,theta", ("theta=pivot.position",), "write --map 'theta=pivot.position[deg]'", "theta"),
        ("time,theta", ("theta=pivot.position[deg]",), "the right ones?", "theta"),
    ],
)
def test_the_mend_of_jumps_is_for_the_column_as_it_is_named(tmp_path, header, mapping, mend, column):
    # No two of the jumps are alike, so that none of them is the reading's; each is beyond half a turn in either unit.
    steps = sum(
        size * (at < TIME) for size, at in ((430.0, 2.0), (-710.0, 4.1), (250.0, 6.3), (-330.0, 8.0), (610.0, 9.0))
    )
    file = tmp_path / "run.csv"
    file.write_text(
        header + "\n" + "".join(f"{t:.6g},{x:.17g}\n" for t, x in zip(TIME, np.degrees(swing()) + steps, strict=True))
    )
    with pytest.raises(InputError) as refusal:
        read_recording(file, mapping=mapping)
    assert mend in refusal.value.mend and refusal.value.column == column


def test_the_time_is_told_by_its_own_name(tmp_path):
    file = tmp_path / "run.csv"
    file.write_text("stamp,theta\n" + "".join(f"1.0,{x:.6g}\n" for x in swing()[:100]))
    with pytest.raises(InputError, match="column stamp: time does not pass"):
        read_recording(file, mapping=("stamp=time", "theta=pivot.position"))


@pytest.mark.parametrize("turns", [5.0, 3.3])
def test_a_step_of_more_than_a_turn_is_no_part_of_one(turns):
    none = np.zeros(0, dtype=np.intp)
    modulus = turns * 2.0 * np.pi
    assert round_modulus(Fold(modulus, 1e-3, 1e-4, none, none, False), 0.0, 1.0, "rad") == modulus
