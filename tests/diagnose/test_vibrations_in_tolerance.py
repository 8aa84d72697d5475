"""Flexible models off within their tolerance, whose vibrations run many cycles during a recording."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import harness
from harness.diagnose.estimation.constants import FEWEST_WINDOW_SAMPLES, VIBRATION_SLIP, WINDOW_GROWTH
from harness.diagnose.estimation.vibration_windows import stages
from harness.diagnose.problem.hypothesis import nominal_quantities, scaled
from harness.diagnose.problem.problem import Problem, Run, pose
from harness.diagnose.problem.windows import Window, cut
from harness.diagnose.selection import investigation as module
from harness.effects.bending import mounted_frequency
from harness.engines.exudyn_ancf import Ancf
from harness.recording import Channel, Recording
from harness.system import System

TIME = 0.001 * np.arange(2501)
NOISE = {"pivot.position": 5e-4, "rod.tip_deflection": 4e-5}


@pytest.fixture
def strip() -> System:
    """The flexible pendulum with three modes; the first vibrates at 37 Hz."""
    system = harness.load("models/toml/flexible_pendulum.toml")
    (link,) = system.links
    assert link.beam is not None
    return replace(system.replace_link(replace(link, beam=replace(link.beam, modes=3))), tolerance=0.01)


def recorded(system: System, angle: float, seed: int) -> Recording:
    """A release that Exudyn's beam elements computed, seen through sensors."""
    model = Ancf(elements=12).build(system)
    n = len(system.coordinate_names)
    run = model.simulate(np.eye(n)[0] * angle, np.zeros(n), TIME, step=1e-4)
    rng = np.random.default_rng(seed)
    signals = {
        "pivot.position": run.position[:, run.names.index("pivot")],
        "rod.tip_deflection": run.channels["rod.tip_deflection"],
    }
    channels = tuple(
        Channel(name, site, quantity, unit, signals[name] + NOISE[name] * rng.standard_normal(len(TIME)))
        for name, site, quantity, unit in (
            ("pivot.position", "pivot", "position", "rad"),
            ("rod.tip_deflection", "rod", "tip_deflection", "m"),
        )
    )
    return Recording(f"run{seed}", "exudyn", TIME, channels)


def problem(system: System, duration: float, interval: float) -> Problem:
    time = np.arange(0.0, duration, interval)
    run = Run("run", time, np.zeros((1, len(time))), None, interval)
    return Problem(system, (), (run,), (run,))


def test_the_finest_windows_keep_the_fastest_vibration_within_its_cycle(strip: System) -> None:
    posed = problem(strip, 3.0, 0.001)
    windows = cut(posed.runs, (0,), 1.5)
    found = stages(posed, windows)
    assert found
    slip = mounted_frequency(strip, "rod", 2) * strip.tolerance
    for window in found[0]:
        assert (
            window.size * 0.001 * slip <= VIBRATION_SLIP * 1.05 or window.size < WINDOW_GROWTH * FEWEST_WINDOW_SAMPLES
        )
    for finer, coarser in zip(found, [*found[1:], windows], strict=True):
        # Every cut of the coarser is one of the finer: states are handed on.
        assert {w.first for w in coarser} < {w.first for w in finer}
        assert sum(w.size for w in finer) == len(posed.runs[0].time)


def test_windows_keep_enough_samples_to_be_fitted(strip: System) -> None:
    posed = problem(strip, 3.0, 0.004)
    for cuts in stages(posed, cut(posed.runs, (0,), 1.5)):
        assert min(window.size for window in cuts) >= FEWEST_WINDOW_SAMPLES


def test_rigid_mechanisms_need_no_finer_windows() -> None:
    rigid = harness.load("models/urdf/double_pendulum.urdf")
    posed = problem(rigid, 3.0, 0.001)
    assert stages(posed, (Window(0, 0, 1500), Window(0, 1500, 3000))) == []


def test_a_model_within_its_tolerance_is_found_consistent(strip: System, monkeypatch: pytest.MonkeyPatch) -> None:
    quantities = nominal_quantities(strip)
    # Stiffness and mass off by two tolerances either way: after 2.5 s the 37 Hz of the first mode are out by 1.9 cycles.
    z = {"stiffness": -2.0, "mass": 2.0, "length": 0.3, "armature": 0.5}
    truth = scaled(strip, quantities, [float(np.exp(0.01 * z[q.kind])) for q in quantities])
    runs = [recorded(truth, angle, seed) for seed, angle in enumerate((2.0, -1.7))]
    found = harness.diagnose(runs, model=strip)
    assert found.verdict == "consistent"
    assert found.findings == []
    # Without the short windows the same recordings end in a wrong valley, or this test would show nothing.
    posed = pose(strip, runs)
    monkeypatch.setattr(module, "stages", lambda problem, windows: [])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "grow", lambda study, seeds, effort, progress: list(seeds))
        lost = module.investigate(posed, (), 1.1)
    assert lost.empty.score > 10.0 * lost.study.samples


def test_stiffness_beyond_its_tolerance_is_found_by_the_score_test(strip: System) -> None:
    # Stiffer by twelve tolerances, which mass and stiffness bent by six each would do. Only what the bend costs speaks for it.
    (link,) = strip.links
    assert link.beam is not None
    beam = replace(link.beam, bending_stiffness=1.12 * link.beam.bending_stiffness)
    runs = [
        recorded(strip.replace_link(replace(link, beam=beam)), angle, seed) for seed, angle in enumerate((0.9, -1.1))
    ]
    found = harness.diagnose(runs, model=strip)
    assert [f["effect"] for f in found.findings] == ["flexural_rigidity"]
    low, high = found.findings[0]["parameters"]["factor"]["ci95"]
    assert low < 1.12 < high
    # What it lost to is told in words that name the bend.
    nothing = next(row for row in found.ranking if not row["effects"])
    assert "stiffness of rod" in nothing["lost"] or "mass of rod" in nothing["lost"]
