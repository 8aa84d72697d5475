"""Sets that leave a force out are weighed with it integrated out as a function of the state.

Recordings by SciPy's integration of a pendulum with a weight at its end that
the model does not have and a force that no law of the catalogue is.
"""

from collections.abc import Sequence

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from simulated_recordings import ARM

import harness
from harness.cli.main import status_of
from harness.effects.catalogue import catalogue
from harness.recording import Channel, Recording
from harness.report.diagnosis.write import write_diagnosis
from harness.system.description import constant

ADDED = 0.3  # kg at the end
ONE_HEIGHT = (-1.4, -1.4, -1.4, -1.4)  # rad
HEIGHTS = (-1.4, -0.6, -1.0, -1.2)


LEFT_OUT = 0.03  # N·m, standard deviation


def motion(added: float, random: np.random.Generator):
    """Slope of (q, q̇) with an added weight [kg], the stated friction, and a force over angle and speed, a draw of random waves
    (Rahimi and Recht, NIPS 20 (2007) 1177)."""
    about = 0.01 + 1e-3 + 0.55 * 0.14**2 + added * 0.15**2
    weight = 9.81 * (0.55 * 0.14 + added * 0.15)
    waves, phases = random.normal(size=(40, 2)) / [0.6, 4.0], random.uniform(0.0, 2.0 * np.pi, 40)

    def slope(_, y):
        q, qd = y
        left_out = LEFT_OUT * np.sqrt(2.0 / 40) * np.sum(np.cos(waves @ y + phases))
        return qd, (-weight * np.sin(q) - 0.05 * qd - 0.02 * np.tanh(qd / 0.01) + left_out) / about

    return slope


def run(slope, angle: float):
    time = np.arange(0.0, 2.5, 0.01)
    return time, solve_ivp(slope, (0.0, 2.5), (angle, 0.0), t_eval=time, rtol=1e-8, atol=1e-10).y[0]


def drops(starts: Sequence[float], added: float) -> list[Recording]:
    """Free drops from about these angles [rad]; the force is the same in all of them."""
    random = np.random.default_rng(8)
    slope, out = motion(added, random), []
    for k, angle in enumerate(starts):
        time, exact = run(slope, angle + 0.01 * random.normal())
        read = exact + 1e-3 * random.normal(size=len(time))
        channel = Channel("servo.position", "servo", "position", "rad", constant(read))
        out.append(Recording(f"drop{k}", f"drop{k}", constant(time), (channel,)))
    return out


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    model = tmp_path_factory.mktemp("model") / "arm.toml"
    model.write_text(ARM)
    return harness.diagnose(drops(HEIGHTS, ADDED), model)


def test_a_weight_is_told_beside_a_force_that_no_law_describes_and_nothing_curious_is(found):
    told = {f["effect"]: f for f in found.findings if f["grade"] != "possible"}
    assert "payload_mass" in told
    low, high = told["payload_mass"]["parameters"]["mass"]["ci95"]
    assert low < ADDED < high
    assert all(catalogue()[name].plain for name in told), sorted(told)
    assert found.verdict == "partly_explained"
    # With the force as a law of its own the run held out is foretold to its sensor's noise.
    assert "unnamed_force@servo" in found.predicting
    (row,) = found.fit
    assert row["predictive"]["heldout_rmse"] < 2e-3 < 5e-3 < row["augmented"]["heldout_rmse"]


def test_the_force_is_written_as_a_law_that_runs_again(found, tmp_path):
    written = {path.name for path in write_diagnosis(found, tmp_path / "out")}
    assert {"predictive.toml", "predictive_force.py"} <= written
    time, exact = run(motion(ADDED, np.random.default_rng(8)), -0.8)
    command = [
        "simulate", str(tmp_path / "out" / "predictive.toml"), "--effects", str(tmp_path / "out" / "predictive_force.py"),
        "--position", "servo=-0.8", "--duration", "2.49", "--rate", "100", "--out", str(tmp_path / "again.csv"),
    ]  # fmt: skip
    assert status_of(command) == 0
    again = np.loadtxt(tmp_path / "again.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(again[:, 0], time, atol=1e-9)
    assert np.sqrt(np.mean((again[:, 1] - exact) ** 2)) < 5e-3


def test_drops_from_one_height_may_not_tell_for_certain_and_tell_nothing_else(tmp_path):
    model = tmp_path / "arm.toml"
    model.write_text(ARM)
    told = {f["effect"]: f for f in harness.diagnose(drops(ONE_HEIGHT, ADDED), model).findings}
    low, high = told["payload_mass"]["parameters"]["mass"]["ci95"]
    assert low < ADDED < high
    assert {name for name, f in told.items() if f["grade"] != "possible"} <= {"payload_mass"}


def test_beside_such_a_force_alone_nothing_is_told_for_certain(tmp_path):
    model = tmp_path / "arm.toml"
    model.write_text(ARM)
    found = harness.diagnose(drops(ONE_HEIGHT, 0.0), model)
    assert [f["effect"] for f in found.findings if f["grade"] != "possible"] == []
    assert found.verdict in ("partly_explained", "unexplained")


def test_nor_is_it_from_several_heights(tmp_path):
    model = tmp_path / "arm.toml"
    model.write_text(ARM)
    found = harness.diagnose(drops(HEIGHTS, 0.0), model)
    assert [f["effect"] for f in found.findings if f["grade"] != "possible"] == []


def test_nor_is_anything_for_certain_that_there_was_no_time_to_weigh(tmp_path):
    model = tmp_path / "arm.toml"
    model.write_text(ARM)
    found = harness.diagnose(drops(HEIGHTS, ADDED), model, time_limit=3.0)
    assert not found.complete
    told = {f["effect"] for f in found.findings if f["grade"] != "possible"}
    assert told <= {"payload_mass"}
