"""Sparse regression as a peer: what is put in by SciPy is kept, and nothing where nothing is missing."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness.compare.peers.runs import Run, heldout_error
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

pytest.importorskip("pysindy")

from harness.compare.peers.torque_regression import fit_regression, thresholded

INERTIA, WEIGHT, NOISE = 6e-3, 0.2943, 1e-4


def rig() -> System:
    pivot = Joint("pivot", JointType.CONTINUOUS, "base", "rod", axis=constant([0.0, 1.0, 0.0]))
    rod = Link("rod", 0.2, constant([0.0, 0.0, -0.15]), constant(np.diag([1.5e-3, 1.5e-3, 1e-5])))
    return System("rig", (pivot,), (rod,))


def swing(angle: float, viscous: float, seed: int) -> Run:
    """J q̈ = −b sin q − viscous q̇."""
    time = np.arange(0.0, 6.0, 4e-3)

    def rate(_, y):
        return [y[1], (-WEIGHT * np.sin(y[0]) - viscous * y[1]) / INERTIA]

    q = solve_ivp(rate, (0.0, 6.0), [angle, 0.0], "DOP853", time, rtol=1e-9, atol=1e-11).y[0]
    return Run(time, (q + NOISE * np.random.default_rng(seed).standard_normal(len(time)))[:, None])


def test_its_readmes_example_comes_out_to_its_figures() -> None:
    # github.com/dynamicslab/pysindy, README.rst: x = 3 exp(-2t), y = 0.5 exp(t) over a second in a hundred samples, second-order
    # differences, polynomials of third degree and a threshold of 0.2 print x' = -2.000 x and y' = 1.000 y. Here of columns of
    # length one, and a fifth of the length of what they add up to.
    import pysindy

    t = np.linspace(0.0, 1.0, 100)
    states = np.stack([3.0 * np.exp(-2.0 * t), 0.5 * np.exp(t)], axis=-1)
    rates = np.asarray(pysindy.FiniteDifference(order=2)(states, t))
    library = pysindy.PolynomialLibrary(degree=3).fit(states)
    columns = np.asarray(library.transform(states))
    norms = np.linalg.norm(columns, axis=0)
    names = library.get_feature_names()
    for own, rate, figure in zip(("x0", "x1"), rates.T, (-2.0, 1.0), strict=True):
        found = thresholded(columns / norms, rate, 0.2) / norms
        assert [name for name, c in zip(names, found, strict=True) if c] == [own]
        assert found[names.index(own)] == pytest.approx(figure, abs=5e-4)


def test_the_law_that_acts_is_kept_alone_and_predicts() -> None:
    runs = [swing(1.3, 2e-3, 1), swing(0.9, 2e-3, 2), swing(1.1, 2e-3, 3)]
    found = fit_regression(rig(), runs[:2], runs[2:])
    assert list(found.terms["pivot"]) == ["viscous_damping"]
    assert found.terms["pivot"]["viscous_damping"] == pytest.approx(2e-3, rel=0.03)
    assert heldout_error(found.free_run, runs[2:]) < 0.01


def test_nothing_is_kept_where_nothing_is_missing() -> None:
    runs = [swing(1.3, 0.0, 1), swing(0.9, 0.0, 2), swing(1.1, 0.0, 3)]
    found = fit_regression(rig(), runs[:2], runs[2:])
    assert found.terms == {"pivot": {}}
    assert heldout_error(found.free_run, runs[2:]) == pytest.approx(NOISE, rel=0.3)


def test_commands_that_are_held_are_not_taken_for_friction() -> None:
    time = np.arange(0.0, 6.0, 1e-2)

    def driven(seed: int) -> Run:
        phase = np.random.default_rng(seed).uniform(0.0, 6.0)

        def tau(t):
            return 0.1 * np.sin(9.0 * 0.01 * np.floor(t / 0.01 + 1e-9) + phase)

        def rate(t, y):
            return [y[1], (tau(t) - WEIGHT * np.sin(y[0])) / INERTIA]

        q = solve_ivp(rate, (0.0, 6.0), [0.4, 0.0], "DOP853", time, rtol=1e-9, atol=1e-11, max_step=0.01).y[0]
        return Run(
            time, (q + NOISE * np.random.default_rng(seed).standard_normal(len(time)))[:, None], tau(time)[:, None]
        )

    found = fit_regression(rig(), [driven(1), driven(2)], [driven(3)])
    assert found.held
    assert found.terms == {"pivot": {}}
    assert heldout_error(found.free_run, [driven(3)]) < 5e-3
