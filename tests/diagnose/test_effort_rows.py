"""Rows put together of columns are those of a whole inverse dynamics of the changed mechanism, smoothed and whitened."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import sosfiltfilt
from simulated_recordings import recording

from harness.denoc.batch.model import BatchModel
from harness.denoc.model import Denoc
from harness.diagnose.inverse.constants import NOISE_LAGS
from harness.diagnose.inverse.effort_fit import EffortData
from harness.diagnose.inverse.effort_model import KNOWN, EffortModel
from harness.diagnose.inverse.effort_motion import ZeroPhase, effort_run, low_pass
from harness.diagnose.inverse.effort_noise import effort_noise, grid_of
from harness.diagnose.inverse.nominal_torque import NominalRows
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis, nominal_quantities, scaled
from harness.system import Joint, JointType, Link, System

TIME = np.arange(0.0, 12.0, 0.004)
ANGLES = [0.7 * np.sin((1.3 + 0.6 * k) * TIME + k) + 0.2 * np.sin((3.0 + k) * TIME) for k in range(3)]
EFFORTS = [0.5 * np.sin((1.3 + 0.6 * k) * TIME + 0.4) for k in range(3)]


def arm(kind: JointType = JointType.REVOLUTE) -> System:
    """Three joints in different directions, a link that is welded on, damping, dry friction, a spring and an armature."""

    def body(name: str, mass: float, com: tuple[float, float, float]) -> Link:
        return Link(name, mass=mass, com=np.array(com), inertia=np.diag([0.02, 0.03, 0.015]) * mass)

    axes = ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    places = ([0.0, 0.0, 0.1], [0.05, 0.02, 0.3], [0.25, 0.0, 0.03])
    joints = [
        Joint(f"j{k}", kind if k == 1 else JointType.REVOLUTE, "base" if k == 0 else f"l{k - 1}", f"l{k}", xyz=np.array(places[k]),
              axis=np.array(axes[k]), damping=0.05 * k, friction=0.03, armature=0.01 * (k == 2), stiffness=0.2 * (k == 1))
        for k in range(3)
    ]  # fmt: skip
    links = [body("l0", 2.0, (0.01, 0.0, 0.1)), body("l1", 1.2, (0.1, 0.03, 0.0)), body("l2", 0.6, (0.0, 0.05, 0.1))]
    joints.append(Joint("weld", JointType.FIXED, "l2", "tool", xyz=np.array([0.0, 0.02, 0.2])))
    links.append(body("tool", 0.3, (0.0, 0.01, 0.04)))
    return System(name="arm", joints=tuple(joints), links=tuple(links), tolerance=0.05)


SYSTEM = arm()
RECORDED = recording(
    "run", TIME, {f"j{k}.position": ANGLES[k] for k in range(3)} | {f"j{k}.effort": EFFORTS[k] for k in range(3)}
)
RUN = effort_run(SYSTEM, RECORDED, 3.0)
FOUND = {c.key: c for c in candidates(SYSTEM, [RECORDED], only=KNOWN)}


def data() -> EffortData:
    # Two stretches, with a sample between them that cannot be used.
    run = RUN.without(np.arange(len(RUN.time)) == len(RUN.time) // 2)
    noises = tuple(
        effort_noise([np.convolve(np.random.default_rng(k).standard_normal(300), [1.0, 0.5])]) for k in range(3)
    )
    return EffortData(EffortModel(SYSTEM, [run]), (grid_of(run),), noises)


def whole(own: EffortData, hypothesis: Hypothesis, x: np.ndarray) -> np.ndarray:
    """Residuals of the whole motion, whitened one stretch and joint at a time."""
    out = []
    (residual,) = own.model.residuals(hypothesis, x)
    for stretch in own.grids[0].stretches:
        for j, noise in enumerate(own.noises):
            values = residual[stretch, j]
            ahead = np.convolve(values, [1.0, *-noise.ahead])[: len(values)] / noise.innovation
            ahead[:NOISE_LAGS] = values[:NOISE_LAGS] / noise.std
            out.append(ahead)
    return np.concatenate(out)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("beside", [(), ("sensor_offset@j1.position", "actuator_gain@j0", "payload_mass@tool")])
def test_rows_are_those_of_whole_residuals(sign, beside):
    own = data()
    nominal = np.linspace(-2.0, 1.5, len(own.model.nominal))
    for key, candidate in FOUND.items():
        hypothesis = Hypothesis((candidate, *(FOUND[k] for k in beside if k != key)))
        values = [np.clip(0.5 * sign * m.scales + 0.01, m.effect.lower, m.effect.upper) for m in hypothesis.members]
        x = np.concatenate([nominal, *values])
        expected = whole(own, hypothesis, x)
        # Rounding through the filter and back, of rows up to some hundred.
        assert np.abs(own.rows(hypothesis, x) - expected).max() < 1e-10 * np.abs(expected).max(), key


@pytest.mark.parametrize("kind", [JointType.REVOLUTE, JointType.PRISMATIC])
def test_products_of_factors_give_the_torque_of_the_scaled_mechanism(kind):
    """Against the recursion over one state at a time, of a mechanism that is built anew."""
    system = arm(kind)
    nominal = nominal_quantities(system)
    rows = NominalRows(system, nominal)
    rng = np.random.default_rng(5)
    factors = np.exp(0.4 * rng.standard_normal(len(nominal)))
    q, qd, qdd = rng.standard_normal((3, 16, 3))
    changed = Denoc(scaled(system, nominal, list(factors)))
    expected = np.array([changed.inverse_dynamics(*state) for state in zip(q, qd, qdd, strict=True)])
    direct = rows.model.with_row(rows.row(factors)).inverse_dynamics(q, qd, qdd)
    terms = rows.terms()
    apart = np.array([rows.model.with_row(row).inverse_dynamics(q, qd, qdd) for row in terms.rows])
    products = np.prod(np.append(factors, 1.0)[terms.factors], axis=1)
    summed = np.tensordot(products @ terms.weights, apart, axes=1)
    # Rounding of torques of some ten newton metres.
    assert np.abs(direct - expected).max() < 1e-12
    assert np.abs(summed - expected).max() < 1e-11


def test_another_row_is_another_mechanism():
    other = replace(SYSTEM, gravity=np.array([1.0, -2.0, -9.0]))
    model = BatchModel(SYSTEM)
    q, qd, qdd = np.random.default_rng(2).standard_normal((3, 11, 3))
    changed = model.with_row(model.lanes.row(other))
    np.testing.assert_array_equal(changed.inverse_dynamics(q, qd, qdd), BatchModel(other).inverse_dynamics(q, qd, qdd))
    np.testing.assert_array_equal(model.inverse_dynamics(q, qd, qdd), BatchModel(SYSTEM).inverse_dynamics(q, qd, qdd))


@pytest.mark.parametrize("shape", [(300,), (300, 4)])
def test_low_pass_is_that_of_scipy(shape):
    sections = low_pass(1.1, 1.0 / 66.0)
    values = np.random.default_rng(1).standard_normal(shape)
    np.testing.assert_array_equal(ZeroPhase(sections)(values), sosfiltfilt(sections, values, axis=0))


def test_what_the_low_pass_takes_of_every_sample():
    sections = low_pass(1.1, 1.0 / 66.0)
    own = ZeroPhase(sections)
    samples = np.array([0, 3, 150, 298])
    # The low-pass of the identity has in its rows what it takes of each sample.
    expected = own(np.eye(299))[samples]
    assert np.abs(own.at(samples, 299) - expected).max() < 1e-13
