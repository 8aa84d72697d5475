"""Runs of elastic mechanisms in long steps, against those whose steps resolve the vibration."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from simulated_recordings import nominal

from harness.compare.bench.flexible import pendulum, start
from harness.denoc.lanes.model import LaneModel
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.linear_response import TOGETHER, channels_moved, respond, responsive, to_channels
from harness.diagnose.estimation.linearisation import Linearisation
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.prediction.predictor import Predictor, Request
from harness.diagnose.prediction.stiff_runs import StiffRuns
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import ChannelInfo, Problem, Run
from harness.diagnose.problem.windows import Window
from harness.effects import apply
from harness.effects.lanes import lane_model, lane_row
from harness.recording.sensors import observe
from harness.system import Attachment

CHANNELS = (
    ChannelInfo("pivot.position", "pivot", "position", "rad"),
    ChannelInfo("rod.tip_deflection", "rod", "tip_deflection", "m"),
)
NOISE = np.array([1e-4, 1e-5])
TIME = 0.004 * np.arange(257)


@pytest.fixture
def model() -> LaneModel:
    """A strip of spring steel with three modes, the third at 186 Hz."""
    return LaneModel(pendulum(3))


def begun(model: LaneModel, copies: int) -> np.ndarray:
    q0, qd0 = start(model.n)
    return np.tile(np.concatenate([q0, qd0]), (copies, 1))


def off(model: LaneModel, rows: np.ndarray, found: tuple, wanted: tuple) -> np.ndarray:
    """Sum of squares of the difference in the channels, in variances of the noise, of every copy."""
    total = np.zeros(len(rows))
    for channel, noise in zip(CHANNELS, NOISE, strict=True):
        a, b = (observe(model, rows, channel.site, channel.quantity, states) for states in (found, wanted))
        total += (((a - b) / noise) ** 2).sum(axis=1)
    return total


def resolved(model: LaneModel, rows: np.ndarray, states: np.ndarray) -> tuple:
    q, qd = np.split(states, 2, axis=1)
    return model.simulate(rows, q, qd, TIME, tolerance=1e-11)


def test_what_the_long_steps_change_cannot_be_seen(model: LaneModel, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = np.repeat(model.row()[None], 5, axis=0)
    rows[:, model.slot("rod", "payload")] = np.linspace(0.0, 0.01, 5)
    states = begun(model, 5)
    wanted = resolved(model, rows, states)
    # The runs must not come from the method that they are held against.
    simulate = LaneModel.simulate
    asked: list[int] = []

    def counted(self: LaneModel, rows: np.ndarray, q0: np.ndarray, qd0: np.ndarray, time: np.ndarray, **how: object):
        asked.append(len(time))
        return simulate(self, rows, q0, qd0, time, **how)

    monkeypatch.setattr(LaneModel, "simulate", counted)
    found = StiffRuns(CHANNELS, NOISE).run(model, rows, states, TIME, None, np.arange(5), 1e-10, "linear", 1)
    assert max(asked) <= 4  # points of the linearization and of the first steps only
    assert off(model, rows, found, wanted).max() < 0.05


def test_a_vibration_that_every_step_of_an_effort_excites_is_followed_to_the_end() -> None:
    """Held efforts set a link of 60 Hz ringing at every sample, and its second shape with it; a stop leaves no long steps."""
    hit = apply(nominal(), Attachment("end_stop", "pivot", {"angle": 0.7, "stiffness": 0.04, "damping": 3e-4}))
    model = lane_model(apply(hit, Attachment("link_flexibility", "rod", {"frequency": 60.0, "damping_ratio": 0.02})))
    row, time = lane_row(model, model.system)[None], 0.004 * np.arange(3000)
    tau = np.zeros((1, len(time), model.n))
    tau[0, :, 0] = np.sin(40.0 * time) + 0.3 * np.sin(71.0 * time)
    state = np.zeros((1, 2 * model.n))
    state[0, 0] = 0.44
    q, qd = np.split(state, 2, axis=1)
    asked = model.simulate(row, q, qd, time, tau=tau, hold="zero", tolerance=1e-10)
    assert not np.isfinite(asked[0]).all()
    # Pieces that are each short enough to be followed, to a finer tolerance.
    at, wanted = state, []
    for first in range(0, len(time) - 1, 500):
        piece = slice(first, first + 501)
        q, qd = np.split(at, 2, axis=1)
        part = model.simulate(row, q, qd, time[piece], tau=tau[:, piece], hold="zero", tolerance=1e-9)
        at = np.hstack([part[0][:, -1], part[1][:, -1]])
        wanted.append(part[0][0, :-1] if first + 501 < len(time) else part[0][0])
    runs = StiffRuns(CHANNELS[:1], NOISE[:1])
    for _ in range(2):
        found = runs.run(model, row, state, time, tau, np.zeros(1, int), 1e-10, "zero", 1)
        assert found[0][0] == pytest.approx(np.concatenate(wanted), abs=1e-6)


def test_one_rough_run_lets_its_whole_request_be_resolved(model: LaneModel) -> None:
    rows = np.repeat(model.row()[None], 4, axis=0)
    rows[1, model.slot("pivot", "coulomb_torque")] = 1e-3
    states = begun(model, 4)
    found = StiffRuns(CHANNELS, NOISE).run(model, rows, states, TIME, None, np.array([0, 0, 1, 1]), 1e-11, "linear", 1)
    wanted = resolved(model, rows, states)
    for array, other in zip(found, wanted, strict=True):
        assert np.array_equal(array[:2], other[:2])
        assert not np.array_equal(array[2:], other[2:])
    assert off(model, rows, found, wanted).max() < 0.05


def test_less_noise_asks_for_shorter_steps(model: LaneModel) -> None:
    rows, states = model.row()[None], begun(model, 1)
    wanted = resolved(model, rows, states)
    sizes = []
    for factor in (1.0, 1e-2, 1e-9):
        found = StiffRuns(CHANNELS, factor * NOISE).run(
            model, rows, states, TIME, None, np.zeros(1), 1e-11, "linear", 1
        )
        sizes.append(float(off(model, rows, found, wanted)[0]))
        assert sizes[-1] < 0.05 * factor**2
    assert sizes[2] == 0.0  # no step is short enough, so the vibration is resolved


def test_derivatives_are_those_of_resolved_runs(model: LaneModel) -> None:
    change = 1e-6
    rows = np.repeat(model.row()[None], 2, axis=0)
    rows[1, model.slot("rod", "stiffness_factor")] *= 1.0 + change
    states = begun(model, 2)
    found = StiffRuns(CHANNELS, NOISE).run(model, rows, states, TIME, None, np.zeros(2), 1e-10, "linear", 1)
    wanted = resolved(model, rows, states)
    for channel in CHANNELS:
        slow, quick = (
            np.diff(observe(model, rows, channel.site, channel.quantity, motion), axis=0)[0]
            for motion in (wanted, found)
        )
        assert np.linalg.norm(quick - slow) < 0.02 * np.linalg.norm(slow)


def test_small_forces_show_in_the_deflection_as_the_linear_response_says() -> None:
    system = pendulum(2)
    run = Run("run", TIME, np.zeros((2, len(TIME))), None, float(TIME[1]))
    problem = Problem(system, CHANNELS, (run,), (run,), steps=(0.0, 0.0))
    predictor = Predictor(problem)
    window, empty = Window(0, 0, len(TIME)), Hypothesis()
    x, state = np.zeros(len(predictor.nominal)), begun(LaneModel(system), 1)[0]
    nothing = Linearisation(0.0, (), (), np.zeros((0, len(x))), np.zeros(0), (), ())
    fitted = Fit(empty, (window,), x, {window: state}, nothing, 0.0, True, np.ones(len(x), dtype=bool))
    likelihood = Likelihood(problem, tuple(Colour(noise, interval=float(TIME[1])) for noise in NOISE))
    assert responsive(predictor)
    torque = 1e-3
    found = respond(predictor, fitted, window, torque)
    force = torque * np.exp(-(((found.time - 0.4) / 0.05) ** 2))[None]
    linear = to_channels(predictor, likelihood, fitted, found, found.by_force(0, force))[0]
    # Of many, some are propagated at a time.
    sizes = np.linspace(0.1, 2.0, 2 * TOGETHER + 3)[:, None]
    propagated = partial(found.by_force, 0)
    many = channels_moved(predictor, likelihood, fitted, found, propagated, len(sizes), lambda own: sizes[own] * force)
    assert np.allclose(many, sizes * linear, rtol=1e-9, atol=1e-12 * np.abs(linear).max())
    # The same push in a simulation of its own, a thousandth as strong.
    grid = predictor.grid(window)
    extra = np.zeros((2, len(grid.time), len(found.q[0])))
    extra[1, : len(found.time), 0] = 1e-3 * force[0]
    pushed = predictor.predict_all([Request(empty, x[None], [(0, window, state)] * 2, extra)])[0]
    plain, with_it = likelihood.whiten(window, pushed)
    assert np.linalg.norm((with_it - plain) / 1e-3 - linear) < 0.01 * np.linalg.norm(linear)
