"""Plots of a page: what is thinned, binned and packed is what was there."""

from __future__ import annotations

import base64

import numpy as np
import pytest
from lxml import html as lxml_html

from harness.diagnose.answer.curves import ForceMap, Residuals
from harness.report.diagnosis.curves import binned, force_over, motion, residuals, shown
from harness.report.plots import Line, Plot, thinned
from harness.report.plots.plot import packed


def test_thinning_keeps_what_stands_out_and_the_gaps():
    time = np.linspace(0.0, 10.0, 20001)
    quiet, spiked = np.sin(time), np.zeros(20001)
    spiked[7777] = 5.0
    quiet[9000:9500] = np.nan
    pick = thinned(600, quiet, spiked)
    assert len(pick) < 1200 and pick[0] == 0 and pick[-1] == 20000
    assert 7777 in pick
    assert np.isnan(quiet[pick]).any()
    # The crest of the sine lies at π/2; a stretch of the thinned curve is 10/150 s, over which a cosine loses 2e-3 at most.
    assert abs(time[pick][np.nanargmax(quiet[pick][time[pick] < 3.0])] - np.pi / 2) < 1e-3
    assert (thinned(600, quiet[:100]) == np.arange(100)).all()


def test_bins_have_the_mean_and_the_spread_of_what_lies_in_them():
    x = np.repeat(np.linspace(-1.0, 1.0, 300), 2)
    y = 3.0 * np.sign(x) + np.tile([-0.5, 0.5], 300)  # two branches, 0.5 either side of ±3
    centre, mean, deviation = binned(x, y)
    assert np.allclose(mean, 3.0 * np.sign(centre), atol=1e-12)
    assert np.allclose(deviation, 0.5, atol=1e-12)
    assert len(binned(np.array([0.0, 1.0]), np.array([1.0, 2.0]))[0]) == 0  # too few to speak of


def test_a_mean_stands_for_samples_and_no_line_bridges_what_is_sparse():
    """Dense at the ends and sparse between, as a fast swing is: a line through y = x², which the ends alone would put at one."""
    between = np.linspace(-0.9, 0.9, 19)
    x = np.concatenate([np.full(50, -1.0), between, np.full(50, 1.0)])
    centre, mean, _ = binned(x, x**2)
    inner = np.abs(centre) < 0.75
    assert np.count_nonzero(inner) == 3  # of nineteen samples, five in each; four go to the end
    # The mean of x² in a bin is the square of the mean of x and their variance: (n² − 1)/12 steps squared, of five at 0.1.
    assert np.allclose((mean - centre**2)[inner], 24.0 / 12.0 * 0.01, atol=1e-12)
    # No sample is left out: the ends are those of the motion.
    assert centre[0] == pytest.approx(-1.0) and centre[-1] == pytest.approx(1.0, abs=0.02)


def test_numbers_are_packed_in_single_precision_and_gaps_stay():
    values = np.array([0.1, np.nan, -1e-9, 12345.678])
    back = np.frombuffer(base64.b64decode(packed(values)), dtype="<f4")
    assert np.isnan(back[1])
    # Half a unit in the last of 24 bits.
    assert np.allclose(back[[0, 2, 3]], values[[0, 2, 3]], rtol=2.0**-24, atol=0.0)


def test_motion_is_measured_less_what_a_model_leaves():
    time = np.linspace(0.0, 1.0, 50)
    measured = np.sin(time)
    run = Residuals("pivot.position", "rad", "a", True, 0.01, time, measured, measured - 2.0, measured - np.cos(time))
    (plot,) = motion([run])
    lines = {line.label: line.values for line in plot.lines}
    assert np.allclose(lines["nominal"], 2.0) and np.allclose(lines["augmented"], np.cos(time))
    assert (lines["measured"] == measured).all()
    assert "held out" in plot.title


def test_a_model_that_runs_away_does_not_flatten_the_recording():
    time = np.linspace(0.0, 1.0, 50)
    run = Residuals("pivot.position", "rad", "a", False, 0.01, time, np.sin(time), np.full(50, 1e6), np.zeros(50))
    (plot,) = motion([run])
    assert plot.limits is not None and plot.limits[1] < 2.0
    (left,) = residuals([run])
    assert left.linear > 0.0  # both can be seen


def test_what_is_held_out_is_always_shown_and_comes_first():
    def run(name: str, held: bool) -> Residuals:
        return Residuals("p", "rad", name, held, 0.01, np.arange(3.0), np.zeros(3), np.zeros(3), np.zeros(3))

    kept, others = shown([*(run(f"r{k}", False) for k in range(9)), run("last", True)])
    assert [r.recording for r in kept] == ["last", "r0", "r1", "r2"] and others == 6


def test_a_plot_has_data_picture_and_words_for_all_readers():
    plot = Plot("p", "a <b>", "x", "y", np.arange(3.0), [Line("one", np.arange(3.0), "ink")], 'what "it" shows')
    figure = lxml_html.fromstring(str(plot.html()))
    assert figure.find(".//figcaption").text == "a <b>"
    assert figure.find(".//div[@class='live']").get("aria-label") == 'what "it" shows'
    picture = figure.find(".//svg")
    assert picture.get("role") == "img" and picture.find("title").text == 'what "it" shows'


def test_missing_force_has_its_mean_in_place():
    rng = np.random.default_rng(5)
    velocity = rng.uniform(-2.0, 2.0, 4000)
    f = ForceMap("pivot", ("rad", "N*m"), rng.uniform(-1, 1, 4000), velocity, -0.3 * velocity)
    plot = force_over(f, "velocity")
    samples, mean = plot.lines
    known = np.isfinite(mean.values)
    # Of a straight line the mean over a bin is its value at the bin's centre, as far as the samples are evenly spread over it:
    # to the standard error of a uniform bin (width 4/30, about 130 samples), four times.
    assert np.abs(mean.values[known] + 0.3 * plot.x[known]).max() < 4 * 0.3 * (4 / 30) / np.sqrt(12 * 100)
    assert np.isfinite(samples.values).sum() == 4000
    assert plot.y_label == "missing force [N·m]"
