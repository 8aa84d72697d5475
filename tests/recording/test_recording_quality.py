"""Degraded recordings: each fault is mended and told, or refused by name."""

import numpy as np
import pytest

from harness.errors import InputError
from harness.recording import read_recording

RATE = 250.0
TIME = np.arange(0.0, 8.0, 1.0 / RATE)


def swing(time, amplitude=0.8):
    return amplitude * np.exp(-0.05 * time) * np.cos(2 * np.pi * 1.1 * time)


def noisy(seed=0, sigma=1e-3):
    return swing(TIME) + np.random.default_rng(seed).normal(0.0, sigma, len(TIME))


def write(folder, time, *columns, header="time,pivot.position"):
    file = folder / "run.csv"
    rows = [",".join("" if np.isnan(v) else repr(float(v)) for v in row) for row in zip(time, *columns, strict=True)]
    file.write_text(header + "\n" + "\n".join(rows) + "\n")
    return file


def read(folder, time, *columns, **options):
    return read_recording(write(folder, time, *columns, **options))


def notes(recording, kind):
    return [note for note in recording.quality if note.kind == kind]


@pytest.mark.parametrize("seed", range(5))
def test_a_clean_recording_has_no_notes(tmp_path, seed):
    recording = read(tmp_path, TIME, noisy(seed))
    assert recording.quality == ()
    assert np.array_equal(recording.channels[0].values, noisy(seed))


def test_a_swing_that_comes_to_rest_has_no_notes_of_saturation(tmp_path):
    # Quantised turning points and rest are plateaus too, but not run into with speed.
    step = 2 * np.pi / 4096
    still = np.where(TIME > 5.0, 0.03, swing(TIME, 1.2))
    recording = read(tmp_path, TIME, np.round(still / step) * step)
    assert not notes(recording, "saturation")
    assert notes(recording, "quantisation")[0].size == pytest.approx(step, rel=1e-6)


@pytest.mark.parametrize("step", [2 * np.pi / 4096, 2 * np.pi / 1024, 0.01])
def test_quantisation_is_found(tmp_path, step):
    recording = read(tmp_path, TIME, np.round(noisy(1, 1e-5) / step) * step)
    assert notes(recording, "quantisation")[0].size == pytest.approx(step, rel=1e-3)


def test_uneven_sampling_is_told_and_kept(tmp_path):
    jitter = TIME + np.random.default_rng(3).uniform(-0.3, 0.3, len(TIME)) / RATE
    recording = read(tmp_path, jitter, swing(jitter))
    assert notes(recording, "uneven_sampling")
    assert np.allclose(recording.time, jitter - jitter[0], rtol=0, atol=1e-12)


def test_gaps_are_told_and_left_open(tmp_path):
    keep = (TIME < 2.0) | (TIME > 2.5)
    recording = read(tmp_path, TIME[keep], noisy()[keep])
    (gap,) = notes(recording, "gap")
    assert gap.where[0] == pytest.approx((2.0, 2.5), abs=2.0 / RATE)
    assert recording.samples == keep.sum()


def test_samples_out_of_order_are_put_in_order(tmp_path):
    order = np.arange(len(TIME))
    order[[100, 101]] = order[[101, 100]]
    recording = read(tmp_path, TIME[order], noisy()[order])
    assert notes(recording, "unordered_time")[0].count == 1
    assert np.array_equal(recording.channels[0].values, noisy())


@pytest.mark.parametrize(
    ("stamps", "words"),
    [
        (np.where(TIME < 4.0, TIME, TIME - 4.0), "time jumps back by"),
        (TIME[::-1], "time runs backwards"),
        (np.full(len(TIME), 3.0), "time does not pass"),
        (np.random.default_rng(1).permutation(TIME), "time jumps back by"),
    ],
)
def test_a_clock_that_is_none_is_refused(tmp_path, stamps, words):
    with pytest.raises(InputError, match=words):
        read(tmp_path, stamps, noisy())


def test_a_reset_clock_is_named_with_its_line(tmp_path):
    with pytest.raises(InputError, match=r"run\.csv:1002"):  # header, then 1000 samples of the first 4 s
        read(tmp_path, np.where(TIME < 4.0 - 1e-9, TIME, TIME - 4.0), noisy())


def test_repeated_stamps_are_joined(tmp_path):
    stamps = TIME.copy()
    stamps[301] = stamps[300]
    values = noisy()
    recording = read(tmp_path, stamps, values)
    assert notes(recording, "repeated_time")[0].count == 1
    assert recording.samples == len(TIME) - 1
    assert recording.channels[0].values[300] == pytest.approx(0.5 * (values[300] + values[301]))


def test_a_rounded_clock_is_made_even(tmp_path):
    recording = read(tmp_path, np.round(TIME, 2), noisy())
    assert notes(recording, "rounded_time")[0].size == pytest.approx(0.01, rel=1e-6)
    assert np.abs(recording.time - TIME).max() < 0.01


def test_missing_cells_stay_missing(tmp_path):
    values, speed = noisy(), np.gradient(swing(TIME), TIME)
    values[50:60] = np.nan
    speed[200] = np.nan
    recording = read(tmp_path, TIME, values, speed, header="time,pivot.position,pivot.velocity")
    assert recording.samples == len(TIME)
    assert {note.channel: note.count for note in notes(recording, "missing")} == {
        "pivot.position": 10,
        "pivot.velocity": 1,
    }
    assert np.isnan(recording.channel("pivot.position").values[50:60]).all()


def test_rows_without_any_measurement_are_left_out(tmp_path):
    values = noisy()
    values[:5] = np.nan
    recording = read(tmp_path, TIME, values)
    assert recording.samples == len(TIME) - 5
    assert recording.time[0] == 0.0 and recording.start == pytest.approx(5 / RATE)


@pytest.mark.parametrize("kind", ["symmetric", "positive", "degrees"])
def test_wrapped_angles_are_made_continuous(tmp_path, kind):
    turning = 2.0 + 3.0 * TIME + 0.3 * np.sin(5 * TIME)
    wrapped = np.mod(turning, 2 * np.pi)
    header = "time,pivot.position"
    if kind == "symmetric":
        wrapped = np.angle(np.exp(1j * turning))
    if kind == "degrees":
        wrapped, header = np.degrees(wrapped), "time,pivot.position [deg]"
    recording = read(tmp_path, TIME, wrapped, header=header)
    (note,) = notes(recording, "wrapped_angle")
    assert note.count == len(np.flatnonzero(np.abs(np.diff(np.mod(turning, 2 * np.pi))) > np.pi)) or kind == "symmetric"
    values = recording.channels[0].values
    assert np.allclose(values - values[0], turning - turning[0], rtol=0, atol=1e-9)


def test_an_angle_wrapped_too_fast_is_refused(tmp_path):
    fast = np.mod(0.7 * np.pi * np.arange(len(TIME)), 2 * np.pi)
    with pytest.raises(InputError, match="or a turn less that from one sample to the next"):
        read(tmp_path, TIME, fast)


def test_a_wrapped_angle_over_a_gap_is_refused(tmp_path):
    turning = np.mod(12.0 * TIME, 2 * np.pi)
    keep = (TIME < 2.0) | (TIME > 2.6)
    with pytest.raises(InputError, match="it may have gone round"):
        read(tmp_path, TIME[keep], turning[keep])


def test_a_jump_that_is_no_wrap_is_refused(tmp_path):
    turning = 3.0 * TIME
    turning[1000:] += 4.0
    with pytest.raises(InputError, match="not wrapped to one turn"):
        read(tmp_path, TIME, turning)


@pytest.mark.parametrize("seed", range(5))
def test_single_outliers_are_left_out(tmp_path, seed):
    rng = np.random.default_rng(seed)
    values = noisy(seed)
    where = rng.choice(np.arange(20, len(TIME) - 20, 40), 6, replace=False)
    values[where] += rng.choice([-1.0, 1.0], 6) * rng.uniform(0.2, 1.0, 6)
    recording = read(tmp_path, TIME, values)
    (note,) = notes(recording, "outlier")
    assert note.count == 6
    assert np.array_equal(np.flatnonzero(np.isnan(recording.channels[0].values)), np.sort(where))


@pytest.mark.parametrize("seed", range(3))
def test_a_hard_stop_is_no_outlier(tmp_path, seed):
    # A bounce changes the velocity in one sample; no position is off the line of its neighbours.
    values = np.abs(swing(TIME, 1.2)) + np.random.default_rng(seed).normal(0, 1e-4, len(TIME))
    assert not notes(read(tmp_path, TIME, values), "outlier")


@pytest.mark.parametrize("grain", [0.0, 1e-4])
@pytest.mark.parametrize("seed", range(3))
def test_noise_that_is_cut_off_flat_tells_saturation(tmp_path, seed, grain):
    # The converter adds noise before it clips, and reads its end again and again between smaller values.
    values = np.clip(
        np.clip(swing(TIME), -0.5, 0.5) + np.random.default_rng(seed).normal(0.0, 1e-3, len(TIME)), -0.5, 0.5
    )
    values = np.round(values / grain) * grain if grain else values
    (note,) = notes(read(tmp_path, TIME, values), "saturation")
    assert note.size == pytest.approx(0.5)
    assert not notes(read(tmp_path, TIME, np.round(noisy(seed) / 1e-4) * 1e-4), "saturation")


@pytest.mark.parametrize("header", ["time,pivot.position", "time,pivot.velocity"])
@pytest.mark.parametrize("seed", range(3))
def test_bursts_are_left_out(tmp_path, seed, header):
    # Wild samples, and a reading that drops to nothing for a while.
    values = noisy(seed)
    values[300:308] += np.array([1.0, -0.7, 0.9, 0.3, -1.1, 0.8, -0.4, 0.6])
    values[905:917] -= 1.0
    recording = read(tmp_path, TIME, values, header=header)
    (note,) = notes(recording, "outlier")
    assert note.count == 20
    assert np.array_equal(np.flatnonzero(np.isnan(recording.channels[0].values)), [*range(300, 308), *range(905, 917)])


@pytest.mark.parametrize("seed", range(5))
def test_a_velocity_that_bounces_is_no_burst(tmp_path, seed):
    # Between two walls 0.02 rad apart it turns round every few samples, a tenth slower each time; then it swings free.
    rng = np.random.default_rng(seed)
    position, speed, read_off = 0.0, 1.5, []
    for _ in TIME:
        position += speed / RATE
        if abs(position) > 0.01 and speed * position > 0.0:
            speed *= -0.9
        read_off.append(speed)
    values = np.array(read_off) + swing(TIME) + rng.normal(0.0, 1e-3, len(TIME))
    assert not notes(read(tmp_path, TIME, values, header="time,pivot.velocity"), "outlier")


@pytest.mark.parametrize("seed", range(5))
def test_the_slow_velocity_of_a_coarse_encoder_is_no_outlier(tmp_path, seed):
    # Differences of counts: now and then one, by far most of the time none.
    rng = np.random.default_rng(seed)
    angle = np.round(swing(TIME, 0.02) / 1e-3 + rng.uniform()) * 1e-3
    values = np.diff(angle, prepend=angle[0]) * RATE
    assert not notes(read(tmp_path, TIME, values, header="time,pivot.velocity"), "outlier")


def test_stale_readings_are_left_out(tmp_path):
    values = noisy()
    for first, last in ((100, 104), (555, 557), (1200, 1206)):
        values[first:last] = values[first]
    recording = read(tmp_path, TIME, values)
    (note,) = notes(recording, "stale")
    assert note.count == 3 + 1 + 5
    kept = recording.channels[0].values
    assert np.isnan(kept[[101, 102, 103, 556, *range(1201, 1206)]]).all()
    assert np.isfinite(kept).sum() == len(TIME) - 9


def test_what_stands_still_without_noise_or_in_steps_is_not_stale(tmp_path):
    computed = swing(TIME)
    computed[1500:] = computed[1500]
    assert not notes(read(tmp_path, TIME, computed), "stale")
    assert not notes(read(tmp_path, TIME, np.round(noisy() / 2e-3) * 2e-3), "stale")


@pytest.mark.parametrize("seed", [153, 189, 278])
def test_a_coarse_encoder_that_is_stamped_late_is_not_cut_off(tmp_path, seed):
    """Of 400 such readings these three had a turn that looked so."""
    rng, step = np.random.default_rng(seed), 2 * np.pi / 1024
    time = np.sort(np.arange(2000) / 200 + rng.normal(0.0, 1.5e-3, 2000))
    (a, b), (f, g) = rng.uniform(0.3, 1.0, 2), rng.uniform(0.5, 2.5, 2)
    angle = a * np.cos(2 * np.pi * f * time) + b * np.cos(2 * np.pi * g * time + 1)
    stamps, first = np.unique(np.round((time + rng.exponential(1e-3, 2000)) * 1e3) / 1e3, return_index=True)
    assert not notes(read(tmp_path, stamps, (np.round(angle / step) * step)[first]), "saturation")


@pytest.mark.parametrize(("limits", "count"), [((-0.5, 0.5), 2), ((-2.0, 0.5), 1)])
def test_saturation_is_told_and_kept(tmp_path, limits, count):
    cut = np.clip(noisy(), *limits)
    recording = read(tmp_path, TIME, cut)
    (note,) = notes(recording, "saturation")
    assert note.size == pytest.approx(0.5, abs=1e-9)
    assert note.what.count("0.5") == count
    assert np.array_equal(recording.channels[0].values, cut)


def test_constant_channels(tmp_path):
    flat = np.full(len(TIME), 0.25)
    recording = read(tmp_path, TIME, noisy(), flat, header="time,pivot.position,elbow.position")
    assert [note.channel for note in notes(recording, "constant")] == ["elbow.position"]
    with pytest.raises(InputError, match="nothing moves"):
        read(tmp_path, TIME, flat)


def test_holes_of_an_effort(tmp_path):
    effort = np.sin(TIME)
    effort[100:103] = np.nan
    header = "time,pivot.position,pivot.effort"
    recording = read(tmp_path, TIME, noisy(), effort, header=header)
    assert np.allclose(recording.efforts[0].values[100:103], np.sin(TIME[100:103]), atol=1e-4)
    assert notes(recording, "missing")[0].channel == "pivot.effort"
    effort[100:150] = np.nan
    with pytest.raises(InputError, match="missing for 50 samples in a row"):
        read(tmp_path, TIME, noisy(), effort, header=header)


def test_too_short_and_nothing_measured(tmp_path):
    with pytest.raises(InputError, match="too short"):
        read(tmp_path, TIME[:19], noisy()[:19])
    with pytest.raises(InputError, match="nothing is measured"):
        read(tmp_path, TIME, noisy(), header="time,pivot.effort")
    with pytest.raises(InputError, match="holds no number"):
        read(tmp_path, TIME, np.full(len(TIME), np.nan), np.sin(TIME), header="time,pivot.position,pivot.effort")


@pytest.mark.parametrize("other", ["pivot.velocity", "pivot.effort", "elbow.position"])
def test_columns_without_a_number_are_left_out_and_told(tmp_path, other):
    # Drivers fill what they do not measure with nan.
    recording = read(tmp_path, TIME, noisy(), np.full(len(TIME), np.nan), header=f"time,pivot.position,{other}")
    assert recording.channel_names == ("pivot.position",) and not recording.efforts
    assert [note.channel for note in notes(recording, "empty_column")] == [other]
