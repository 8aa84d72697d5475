"""A single recording is divided where it moves: what has come to rest predicts itself."""

from __future__ import annotations

import numpy as np

from harness.diagnose.problem.problem import pose
from harness.recording import Recording
from harness.recording.recording import Channel
from harness.system import System
from harness.system.description import Joint, JointType, Link, constant

TIME = np.arange(0.0, 10.0, 0.01)


def model() -> System:
    joint = Joint("pivot", JointType.CONTINUOUS, "base", "arm", axis=constant([0.0, 1.0, 0.0]))
    link = Link("arm", 0.1, constant([0.0, 0.0, -0.2]), constant(np.diag([1e-5, 1e-5, 1e-6])))
    return System("pendulum", (joint,), (link,))


def recording(angle: np.ndarray, effort: np.ndarray | None = None) -> Recording:
    noise = 1e-4 * np.random.default_rng(1).normal(size=len(TIME))
    efforts = () if effort is None else (Channel("pivot.effort", "pivot", "effort", "N*m", effort),)
    return Recording("one", "", TIME, (Channel("pivot.position", "pivot", "position", "rad", angle + noise),), efforts)


def stopping(until: float) -> np.ndarray:
    """A straight envelope that ends at ``until`` seconds."""
    return np.where(until > TIME, (1.0 - TIME / until) * np.cos(7.0 * TIME), 0.0)


def test_rest_is_not_what_is_judged_on() -> None:
    problem = pose(model(), [recording(stopping(4.0))])
    divided = problem.heldout[0].time[0]
    # 70 % of the 4 s of motion; below 2 % of the extent (0.038 rad, an envelope reached at 3.85 s, and up to half a swing of
    # π/7 s before) it counts as rest.
    assert 0.7 * (3.85 - 0.5 * np.pi / 7.0) < divided <= 0.7 * 4.0
    assert np.ptp(problem.heldout[0].values[0]) > 0.2


def test_motion_to_the_end_is_divided_by_time() -> None:
    problem = pose(model(), [recording(np.exp(-0.05 * TIME) * np.cos(7.0 * TIME))])
    assert abs(problem.heldout[0].time[0] - 7.0) < 0.06


def test_a_driven_recording_is_divided_by_time() -> None:
    problem = pose(model(), [recording(stopping(4.0), effort=np.where(TIME < 9.0, 0.01, 0.0))])
    assert abs(problem.heldout[0].time[0] - 7.0) < 0.02
