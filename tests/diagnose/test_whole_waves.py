"""Cogging is more than possible where whole waves of it were seen, and little is left beside it: by efforts, and by free runs."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.claims import grades
from harness.diagnose.claims.grades import no_firmer_than_its_law, no_smooth_force
from harness.diagnose.diagnose import diagnose
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.inverse.effort_grades import waves_seen
from harness.diagnose.problem.hypothesis import Candidate
from harness.effects.catalogue import effect
from harness.effects.scale import References


@pytest.mark.parametrize(("periods", "span", "waves"), [(11.0, 1.3, 2.26), (11.0, 0.4, 0.69), (6.0, 1.3, 1.22)])
def test_waves_are_counted_over_the_angle_that_was_passed(periods: float, span: float, waves: float) -> None:
    """periods · span / 2π, of the fewest periods that there may be."""
    q = np.linspace(-0.5 * span, 0.5 * span, 50)[:, None]
    run = SimpleNamespace(q=q, usable=np.ones(50, dtype=bool))
    model = SimpleNamespace(system=SimpleNamespace(joint_names=("wrist",)), runs=(run,))
    data: Any = SimpleNamespace(model=model)
    member = Candidate(effect("cogging_torque"), "wrist", References())
    values = {"periods": Estimate(periods, 0.05, periods - 0.1, periods + 0.1)}
    assert waves_seen(data, member, values) == pytest.approx(waves, abs=0.02)


@pytest.mark.parametrize(
    ("waves", "gain", "whole"),
    [(2.3, 200.0, True), (1.9, 1e6, False), (2.3, 50.0, False), (4.1, 50.0, True), (7.0, 15.0, False)],
)
def test_a_piece_of_a_wave_is_any_smooth_force(waves: float, gain: float, whole: bool) -> None:
    """Of Gaussian processes one in thousands looks like two waves that explain a hundred times what is left, or four that explain
    twenty times as much (``claims.constants.WAVE_RATIO``, where they were drawn)."""
    assert no_smooth_force(waves, gain, 1.0) is whole


@pytest.mark.parametrize(("law", "told"), [("possible", "possible"), ("likely", "likely"), ("", "established")])
def test_how_a_law_acts_is_no_firmer_than_the_law(law: str, told: str) -> None:
    """A stop's inertia without a stop is nothing; beside a stop that the model states it stands by itself."""
    claims: Any = {
        f"{name}@wrist": SimpleNamespace(candidate=Candidate(effect(name), "wrist", References()))
        for name in ("end_stop", "stop_inertia")
    }
    each = {"end_stop@wrist": law, "stop_inertia@wrist": "established"}
    if not law:
        del each["end_stop@wrist"], claims["end_stop@wrist"]
    assert no_firmer_than_its_law(claims, each)["stop_inertia@wrist"] == told


@pytest.mark.parametrize(
    ("name", "waves", "any_force"),
    [
        ("cogging_torque", 0.9, True),
        ("cogging_torque", 4.5, False),
        ("encoder_interpolation", 0.9, False),
        ("cubic_stiffness", 0.0, False),
    ],
)
def test_a_piece_of_a_wave_beside_a_remainder_is_any_force(
    monkeypatch: pytest.MonkeyPatch, name: str, waves: float, any_force: bool
) -> None:
    """An arm dropped under a draw of a smooth force was told cogging of two periods a turn, of which it had seen less than one."""
    monkeypatch.setattr(grades, "waves_seen", lambda study, fitted, k: waves)
    claim: Any = SimpleNamespace(candidate=SimpleNamespace(effect=effect(name)), index=0, gain=100.0)
    conclusion: Any = SimpleNamespace(best=None, remains=SimpleNamespace(excess=1.0))
    assert grades._any_smooth_force(cast(Any, SimpleNamespace(study=None)), conclusion, claim) is any_force


@pytest.mark.slow
def test_cogging_beside_a_force_that_is_left_out() -> None:
    """Free swings over seven waves, with friction, damping and a further wave that no law of the catalogue has together with them:
    all three are named with their numbers, by SciPy's integration."""
    rig = Rig(
        viscous=1.7e-3, dry=1e-3,
        torque=lambda t, q, v: 9e-3 * np.sin(14.0 * q + 0.9) + 1.5e-3 * np.sin(28.0 * q - 0.3),
    )  # fmt: skip
    runs = releases(rig, (1.6, 1.3, 1.5), 2e-4, seed=4, duration=9.0, rate=200.0)
    found = diagnose(runs, nominal(), time_limit=200.0)
    told = {f["effect"]: f for f in found.findings if f["grade"] != "possible"}
    assert (
        {"viscous_damping", "cogging_torque"} <= set(told) <= {"viscous_damping", "cogging_torque", "coulomb_friction"}
    )
    numbers = told["cogging_torque"]["parameters"]
    assert numbers["periods"]["value"] == 14.0
    assert numbers["periods"]["ci95"] == [14.0, 14.0]
    assert numbers["amplitude"]["value"] == pytest.approx(9e-3, rel=0.1)
    low, high = told["viscous_damping"]["parameters"]["coefficient"]["ci95"]
    assert low < 1.7e-3 < high
