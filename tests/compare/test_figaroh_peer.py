"""FIGAROH as a peer: a driven pendulum's numbers, put in by SciPy, come out of its own workflow."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness.compare.peers.runs import Run, heldout_error
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

pytest.importorskip("figaroh")

from harness.compare.peers.figaroh import fit_figaroh

MASS, COM, ABOUT_COM = 0.2, 0.15, 1.5e-3
INERTIA, WEIGHT = ABOUT_COM + MASS * COM**2, MASS * 9.81 * COM
VISCOUS, DRY, NOISE = 2e-3, 6e-3, 2e-4


def rig() -> System:
    pivot = Joint("pivot", JointType.CONTINUOUS, "base", "rod", axis=constant([0.0, 1.0, 0.0]))
    rod = Link("rod", MASS, constant([0.0, 0.0, -COM]), constant(np.diag([ABOUT_COM, ABOUT_COM, 1e-5])))
    return System("rig", (pivot,), (rod,))


def driven(seed: int, held: float = 0.0) -> Run:
    """J q̈ = τ − b sin q − viscous q̇ − dry tanh(q̇ / 0.01).

    held: for how long a command is kept [s], and how often it is then sampled.
    """
    rng = np.random.default_rng(seed)
    phase = rng.uniform(0.0, 6.0, 3)

    def tau(t):
        t = held * np.floor(t / held + 1e-9) if held else t
        return 0.1 * np.sin(3.0 * t + phase[0]) + 0.15 * np.sin(13.0 * t + phase[1]) + 0.05 * np.sin(2.1 * t + phase[2])

    def rate(t, y):
        return [y[1], (tau(t) - WEIGHT * np.sin(y[0]) - VISCOUS * y[1] - DRY * np.tanh(y[1] / 0.01)) / INERTIA]

    time = np.arange(0.0, 8.0, held or 2e-3)
    q = solve_ivp(rate, (0.0, 8.0), [0.3, 0.0], t_eval=time, rtol=1e-8, atol=1e-10, max_step=held or np.inf).y[0]
    return Run(time, (q + NOISE * rng.standard_normal(len(time)))[:, None], tau(time)[:, None])


def test_numbers_put_in_come_out_and_predict() -> None:
    runs = [driven(1), driven(2), driven(3)]
    found = fit_figaroh(rig(), runs[:2], runs[2:], np.sqrt(WEIGHT / INERTIA) / (2.0 * np.pi))
    assert found.inertia == pytest.approx(INERTIA, rel=0.02)
    assert found.gravity[1] == pytest.approx(WEIGHT, rel=0.02)
    assert found.viscous == pytest.approx(VISCOUS, rel=0.05)
    assert found.dry == pytest.approx(DRY, rel=0.05)
    assert found.prediction < 0.02  # N·m, of a drive of 0.1
    assert found.physical
    assert heldout_error(found.free_run, runs[2:]) < 0.1


def test_commands_that_are_held_are_not_taken_for_friction() -> None:
    # 10 ms between commands, of which half looks like a delay: taken so, a third of the damping is left, and free runs are off
    # by 0.04 rad. Damping and dry friction take each other's place; what both are at 1 rad/s does not.
    runs = [driven(seed, 1e-2) for seed in (1, 2, 3)]
    found = fit_figaroh(rig(), runs[:2], runs[2:], np.sqrt(WEIGHT / INERTIA) / (2.0 * np.pi))
    assert found.held
    assert found.viscous + found.dry == pytest.approx(VISCOUS + DRY, rel=0.1)
    assert heldout_error(found.free_run, runs[2:]) < 5e-3


def test_a_free_swing_is_not_for_it() -> None:
    time = np.arange(0.0, 1.0, 0.01)
    with pytest.raises(ValueError, match="known effort"):
        fit_figaroh(rig(), [Run(time, np.cos(time)[:, None])], [Run(time, np.cos(time)[:, None])], 1.0)


def test_what_is_left_between_pushes_are_whole_pieces() -> None:
    time = np.arange(10.0)
    pieces = Run(time, time[:, None], 2.0 * time[:, None]).between([(2.5, 4.2), (8.5, 20.0)])
    assert [list(p.time) for p in pieces] == [[0.0, 1.0, 2.0], [5.0, 6.0, 7.0, 8.0]]
    assert pieces[1].efforts is not None and list(pieces[1].efforts[:, 0]) == [10.0, 12.0, 14.0, 16.0]
    assert len(Run(time, time[:, None]).between([])) == 1
