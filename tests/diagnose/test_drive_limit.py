"""A drive that is asked for more than it can give: no push from outside, and its limit is told from efforts alone."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from simulated_recordings import recording

from harness.diagnose.diagnose import diagnose
from harness.diagnose.inverse.effort_fit import EffortData, fit_effort
from harness.diagnose.inverse.effort_model import EffortModel
from harness.diagnose.inverse.effort_motion import effort_run
from harness.diagnose.inverse.effort_noise import effort_noise, grid_of
from harness.diagnose.inverse.pushes import Push, still_pushing
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.recording import Recording
from harness.system import Attachment, Joint, JointType, Link, System
from harness.system.description import constant

MASS, LENGTH, SLENDER, DAMPING, GRAVITY = 2.0, 0.3, 0.02, 0.3, 9.81  # kg, m, kg·m², N·m·s/rad, m/s²
NOISE = 0.03  # N·m


def arm() -> System:
    joint = Joint("joint", JointType.REVOLUTE, "base", "arm", axis=constant([0.0, 1.0, 0.0]), damping=DAMPING)
    link = Link("arm", MASS, constant([0.0, 0.0, -LENGTH]), constant(np.diag([SLENDER, SLENDER, 1e-3])))
    return System("arm", (joint,), (link,), tolerance=0.01)


def commanded(seed: int, limit: float, pushed: float = 0.0) -> Recording:
    """An arm under five sines of its command, of which the drive gives no more than ``limit``; pushed for 0.3 s at 6 s."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 10.0, 0.004)
    rate, phase = 2.0 * np.pi * np.geomspace(0.3, 2.0, 5), rng.uniform(0.0, 2.0 * np.pi, 5)

    def command(t: float | np.ndarray) -> np.ndarray:
        return np.sin(np.multiply.outer(t, rate) + phase) @ np.array([3.0, 2.5, 2.0, 2.0, 1.5])

    def change(t: float, y: np.ndarray) -> list[float]:
        given = np.clip(command(t), -limit, limit) + pushed * (6.0 <= t < 6.3)
        weight = MASS * GRAVITY * LENGTH * np.sin(y[0])
        return [y[1], (given - weight - DAMPING * y[1]) / (SLENDER + MASS * LENGTH**2)]

    q = solve_ivp(change, (0.0, time[-1]), [0.0, 0.0], t_eval=time, rtol=1e-9, atol=1e-10, max_step=4e-3).y[0]
    q, asked = q + 2e-4 * rng.standard_normal(len(time)), command(time) + NOISE * rng.standard_normal(len(time))
    return recording(f"run{seed}", time, {"joint.position": q, "joint.effort": asked})


def test_a_drives_limit_is_no_push() -> None:
    told = diagnose([commanded(seed, 5.0) for seed in (1, 2, 3)], arm(), fit_effort=True)
    (found,) = told.findings
    low, high = found["parameters"]["limit"]["ci95"]
    assert (found["effect"], found["grade"]) == ("actuator_saturation", "established")
    assert low - 0.02 <= 5.0 <= high + 0.02  # efforts are taken straight from sample to sample, over corners too
    assert not [note for note in told.quality if note["kind"] == "outside_push"]


@pytest.mark.parametrize("limit", [5.0, np.inf])
def test_a_push_beside_it_is_one(limit: float) -> None:
    runs = [commanded(1, limit), commanded(2, limit, 4.0), commanded(3, limit)]
    told = diagnose(runs, arm(), fit_effort=True, only=("actuator_saturation",))
    pushes = [note for note in told.quality if note["kind"] == "outside_push"]
    assert [note["recording"] for note in pushes] == ["run2"]
    assert bool(told.findings) == np.isfinite(limit)


def test_what_a_set_explains_is_no_push_beside_it() -> None:
    runs = [effort_run(arm(), commanded(seed, np.inf, push), 6.0) for seed, push in ((1, 0.0), (2, 4.0))]
    model = EffortModel(arm(), runs)
    grids = tuple(grid_of(run) for run in runs)
    data = EffortData(model, grids, (effort_noise([NOISE * np.random.default_rng(0).standard_normal(500)]),))
    nothing = fit_effort(data, Hypothesis(), np.zeros(len(model.nominal)))
    taken, pushed = Push(0, 0, 3.0, 3.4, 2.0), Push(1, 0, 5.95, 6.35, -4.0)
    assert still_pushing(arm(), runs, (taken, pushed), nothing) == (pushed,)


def test_a_reading_of_the_wrong_sign_is_taken_back_whole() -> None:
    """The motion behind a reading of gain g is the reading over g, whatever g is; to first order it would be 2 − g times it."""
    run = effort_run(arm(), commanded(1, np.inf), 6.0)
    model = EffortModel(arm(), [run])
    for gain in (-1.0, 0.5, 1.02):
        (moved,) = model.moved([Attachment("sensor_gain", "joint.position", {"gain": gain})])
        assert moved.q == pytest.approx(run.q / gain, abs=1e-9)
