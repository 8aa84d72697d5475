"""Sets that leave a force out are weighed with it integrated out as a function of the state.

Likelihoods from SciPy's multivariate normal; recordings by SciPy's integration of a pendulum with a weight at its end that
the model does not have and a force that no law of the catalogue is.
"""

from collections.abc import Sequence

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.stats import multivariate_normal

import harness
from harness.diagnose.estimation.discrepancy import Profiled
from harness.diagnose.estimation.state_force import USUAL, Force, StateForce
from harness.diagnose.problem.windows import Window
from harness.effects.catalogue import catalogue
from harness.recording import Channel, Recording
from harness.system.description import constant


@pytest.fixture
def two_windows() -> tuple[StateForce, list[Window], list[Profiled]]:
    """Six nodes of two joints, two channels of 30 readings in each of two windows, no initial state to fit."""
    random = np.random.default_rng(5)
    windows = [Window(0, 0, 30), Window(1, 0, 30)]
    answers = {window: random.normal(size=(60, 6)) for window in windows}
    at = random.normal(size=(6, 2))
    force = StateForce(np.array([0, 0, 0, 1, 1, 1]), at, answers, 2, np.ones(2))
    free = [Profiled(random.normal(size=60), np.zeros((60, 0)), 60) for _ in windows]
    return force, windows, free


def test_how_likely_residuals_are_is_that_of_one_gaussian_over_all_recordings(two_windows):
    force, windows, free = two_windows
    sums = force.sums(windows, free)
    residual = np.concatenate([own.residual for own in free])
    answers = np.vstack([force.answers[window] for window in windows])

    def dense(own: Force) -> float:
        root = force.prior_root(own)
        loud = np.tile(np.repeat(own.louder, 30), 2)
        covariance = answers @ root @ root.T @ answers.T + np.diag(loud)
        usual = 2.0 * np.sum(np.log1p((own.sizes / USUAL) ** 2))
        return -2.0 * multivariate_normal(cov=covariance).logpdf(residual) + usual

    one = Force(np.array([0.3, 0.05]), np.array([0.5, 1.5]), np.array([1.2, 2.0]))
    two = Force(np.array([1.0, 0.4]), np.array([2.0, 0.3]), np.array([1.0, 1.1]))
    difference = force.surprise(sums, one) - force.surprise(sums, two)
    assert difference == pytest.approx(dense(one) - dense(two), rel=1e-9)


ARM = """
name = "arm"
gravity = [0.0, 0.0, -9.81]
tolerance = 0.01
[[joint]]
name = "servo"
type = "revolute"
parent = "base"
child = "arm"
axis = [0, 1, 0]
armature = 0.01
damping = 0.05
friction = 0.02
[[link]]
name = "arm"
mass = 0.55
com = [0.0, 0.0, -0.14]
inertia = [1e-3, 1e-3, 1e-3, 0, 0, 0]
end = [0.0, 0.0, -0.15]
"""
ADDED = 0.3  # kg at the end
ONE_HEIGHT = (-1.4, -1.4, -1.4, -1.4)  # rad
HEIGHTS = (-1.4, -0.6, -1.0, -1.2)


LEFT_OUT = 0.03  # N·m, standard deviation


def drops(starts: Sequence[float], added: float) -> list[Recording]:
    """Free drops from about these angles [rad], with an added weight [kg], the stated friction, and a force over angle and speed.

    It is the same in all of them, a draw of random waves (Rahimi and Recht, NIPS 20 (2007) 1177).
    """
    about = 0.01 + 1e-3 + 0.55 * 0.14**2 + added * 0.15**2
    weight = 9.81 * (0.55 * 0.14 + added * 0.15)
    random = np.random.default_rng(8)
    waves, phases = random.normal(size=(40, 2)) / [0.6, 4.0], random.uniform(0.0, 2.0 * np.pi, 40)

    def slope(_, y):
        q, qd = y
        left_out = LEFT_OUT * np.sqrt(2.0 / 40) * np.sum(np.cos(waves @ y + phases))
        return qd, (-weight * np.sin(q) - 0.05 * qd - 0.02 * np.tanh(qd / 0.01) + left_out) / about

    out = []
    for k, angle in enumerate(starts):
        time = np.arange(0.0, 2.5, 0.01)
        start = angle + 0.01 * random.normal()
        found = solve_ivp(slope, (0.0, 2.5), (start, 0.0), t_eval=time, rtol=1e-8, atol=1e-10)
        read = found.y[0] + 1e-3 * random.normal(size=len(time))
        channel = Channel("servo.position", "servo", "position", "rad", constant(read))
        out.append(Recording(f"drop{k}", f"drop{k}", constant(time), (channel,)))
    return out


def test_a_weight_is_told_beside_a_force_that_no_law_describes_and_nothing_curious_is(tmp_path):
    model = tmp_path / "arm.toml"
    model.write_text(ARM)
    found = harness.diagnose(drops(HEIGHTS, ADDED), model)
    told = {f["effect"]: f for f in found.findings if f["grade"] != "possible"}
    assert "payload_mass" in told
    low, high = told["payload_mass"]["parameters"]["mass"]["ci95"]
    assert low < ADDED < high
    assert all(catalogue()[name].plain for name in told), sorted(told)
    assert found.verdict == "partly_explained"


def test_drops_from_one_height_may_not_tell_for_certain_and_tell_nothing_else(tmp_path):
    model = tmp_path / "arm.toml"
    model.write_text(ARM)
    (found,) = harness.diagnose(drops(ONE_HEIGHT, ADDED), model).findings
    low, high = found["parameters"]["mass"]["ci95"]
    assert found["effect"] == "payload_mass" and low < ADDED < high


def test_beside_such_a_force_alone_nothing_is_told_for_certain(tmp_path):
    model = tmp_path / "arm.toml"
    model.write_text(ARM)
    found = harness.diagnose(drops(ONE_HEIGHT, 0.0), model)
    assert [f["effect"] for f in found.findings if f["grade"] != "possible"] == []
    assert found.verdict in ("partly_explained", "unexplained")


@pytest.mark.xfail(
    strict=True,
    reason="what is constant of the force is told as a tilt of the base",
)
def test_nor_is_it_from_several_heights(tmp_path):
    model = tmp_path / "arm.toml"
    model.write_text(ARM)
    found = harness.diagnose(drops(HEIGHTS, 0.0), model)
    assert [f["effect"] for f in found.findings if f["grade"] != "possible"] == []
