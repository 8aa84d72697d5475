"""A slide that is moved and stopped again and again: what rests hide, and what breaking loose is not."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from simulated_recordings import recording

from harness.diagnose.inverse.band import band, cutoff_for, pace
from harness.diagnose.inverse.effort import diagnose_effort
from harness.diagnose.inverse.effort_motion import effort_run
from harness.diagnose.inverse.effort_noise import grid_of
from harness.diagnose.inverse.pushes import find_pushes
from harness.recording import Recording
from harness.system import Joint, Link, System
from harness.system.description import JointType

MASS, VISCOUS, DRY, BREAKAWAY, SPEED = 2.0, 2.0, 3.0, 5.0, 0.01  # kg, N·s/m, N, N, m/s
RATE, STEP = 250, 2e-4  # Hz, s


@cache
def _slide() -> System:
    joint = Joint("slide", JointType.PRISMATIC, "base", "carriage", axis=np.array([1.0, 0.0, 0.0]))
    link = Link("carriage", MASS, inertia=np.diag([0.01, 0.01, 0.01]))
    return System("slide", (joint,), (link,))


@cache
def _moved(seed: int, rest: float, breakaway: float = DRY) -> Recording:
    """Half a second of motion and a rest, again and again: m a = u − b v − friction by steps of 0.2 ms, at rest exactly."""
    rng = np.random.default_rng(seed)
    each, moving, every = round((0.5 + rest) / STEP), round(0.5 / STEP), round(1.0 / (RATE * STEP))
    s = np.linspace(0.0, 1.0, moving)
    asked, place = [], 0.0
    for goal in np.cumsum(rng.choice([-1.0, 1.0], 12) * rng.uniform(0.03, 0.1, 12)):
        asked += [place + (goal - place) * s * s * (3.0 - 2.0 * s), np.full(each - moving, goal)]
        place = goal
    reference = np.concatenate(asked)
    x = v = total = u = 0.0
    position, effort = np.empty(len(reference)), np.empty(len(reference))
    for k, goal in enumerate(reference):
        if k % every == 0:
            total += (goal - x) * every * STEP
            u = 900.0 * (goal - x) - 40.0 * v + 600.0 * total
        position[k], effort[k] = x, u
        if v == 0.0 and abs(u) <= breakaway:
            continue
        way = np.sign(v) if v else np.sign(u)
        level = DRY + (breakaway - DRY) * np.exp(-((v / SPEED) ** 2))
        after = v + STEP * (u - VISCOUS * v - way * level) / MASS
        v = 0.0 if v * after < 0.0 else after
        x += STEP * v
    q = position[::every] + rng.normal(0.0, 5e-6, len(position[::every]))
    f = effort[::every] + rng.normal(0.0, 0.02, len(q))
    return recording(f"run{seed}", np.arange(len(q)) / RATE, {"slide.position": q, "slide.effort": f}, linear=True)


def test_short_moves_between_rests_can_be_compared() -> None:
    runs = [_moved(seed, 0.5) for seed in (1, 2)]
    low = cutoff_for(_slide(), runs[0], pace(_slide(), runs[0]))
    assert not grid_of(effort_run(_slide(), runs[0], low)).samples  # which was all that was looked at
    wide = band(_slide(), runs)
    assert wide > 2.0 * low
    assert all(grid_of(effort_run(_slide(), run, wide)).samples > 50 for run in runs)


def test_breaking_loose_is_no_push() -> None:
    runs = [effort_run(_slide(), _moved(seed, 1.5, BREAKAWAY), 12.0) for seed in (1, 2, 3)]
    assert find_pushes(_slide(), runs) == ()
    # Twice as much as holds it at rest, while it moves: nothing but a push.
    k = int(np.argmax(np.abs(runs[0].qd[:, 0])))
    pushed = runs[0].raw.copy()
    pushed[k - 60 : k + 60] += 2.0 * BREAKAWAY
    seen = [effort_run(_slide(), _moved(1, 1.5, BREAKAWAY), 12.0), *runs[1:]]
    object.__setattr__(seen[0], "raw", pushed)
    object.__setattr__(seen[0], "effort", seen[0].smooth(pushed))
    (push,) = find_pushes(_slide(), seen)
    assert push.run == 0
    assert push.first < runs[0].time[k] < push.last


@pytest.mark.slow
def test_friction_of_short_moves_is_told() -> None:
    told = diagnose_effort(_slide(), [_moved(seed, 0.5) for seed in (1, 2)], _moved(3, 0.5))
    found = {f["effect"]: f["parameters"] for f in told.findings}
    assert set(found) == {"coulomb_friction", "viscous_damping"}
    assert found["coulomb_friction"]["torque"]["value"] == pytest.approx(DRY, abs=0.02)
    assert found["viscous_damping"]["coefficient"]["value"] == pytest.approx(VISCOUS, abs=0.08)
