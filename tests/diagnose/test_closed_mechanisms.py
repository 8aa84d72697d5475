"""What a closed mechanism lacks is found from one recorded angle; the truth is MuJoCo's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from mechanisms_by_mujoco import (
    CLOSED,
    FIVE_BAR,
    FOUR_BAR,
    NOTHING,
    ROPE,
    SLIDER_CRANK,
    STARTS,
    five_bar,
    four_bar,
    four_bar_cut_elsewhere,
    model_file,
    motion,
    mounted,
    recording,
)

from harness import diagnose
from harness.system import load


@pytest.fixture
def model(tmp_path: Path):
    return load(model_file(tmp_path, FOUR_BAR.format(**NOTHING, closing=CLOSED)))


@pytest.mark.parametrize(
    ("hidden", "key", "parameter"),
    [
        ({"pin": 0.01}, "viscous_damping@pin", "coefficient"),
        ({"dry": 0.02}, "coulomb_friction@rocker", "torque"),
        ({"spring": 0.4}, "joint_stiffness@pin", "stiffness"),
    ],
)
def test_what_acts_at_a_joint_that_nobody_recorded_is_found(model, hidden, key, parameter) -> None:
    found = diagnose(four_bar(**hidden), model)
    assert found.verdict == "explained"
    assert [f"{f['effect']}@{f['site']}" for f in found.findings] == [key]
    (value,) = hidden.values()
    told = found.findings[0]["parameters"][parameter]
    assert told["ci95"][0] <= value <= told["ci95"][1]


def test_what_acts_where_the_model_is_cut_is_found_there(model) -> None:
    # MuJoCo's file is cut elsewhere and has a joint there. The whole catalogue, at the three joints that the model has and its cut.
    found = diagnose(four_bar_cut_elsewhere(0.01), model)
    assert found.verdict == "explained"
    assert [f"{f['effect']}@{f['site']}" for f in found.findings] == ["viscous_damping@knee"]
    told = found.findings[0]["parameters"]["coefficient"]
    assert told["ci95"][0] <= 0.01 <= told["ci95"][1]
    assert told["unit"] == "N*m*s/rad"


def test_a_clean_four_bar_lacks_nothing(model) -> None:
    found = diagnose(four_bar(), model)
    assert found.verdict == "consistent"
    assert found.findings == []


@pytest.mark.parametrize(("starts", "elsewhere"), [((0.07, 0.77), False), (STARTS, True)])
def test_the_rocker_alone_tells_as_well(model, starts, elsewhere) -> None:
    # A rocker's angle leaves two places of the crank, 0.07 or -0.90 rad and 0.77 or -2.30 rad here; the model's is at 0.
    recordings = four_bar(seen="rocker", pin=0.01, starts=starts)
    found = diagnose(recordings, model, only=("viscous_damping", "coulomb_friction"))
    assert [f"{f['effect']}@{f['site']}" for f in found.findings] == ["viscous_damping@pin"]
    low, high = found.findings[0]["parameters"]["coefficient"]["ci95"]
    assert low <= 0.01 <= high
    (note,) = (note for note in found.notes if "more than one way" in note)
    assert note.count("not where the model places it") == (2 if elsewhere else 0)
    assert "cannot be told apart" not in note


def test_the_slide_of_a_slider_crank_tells_where_it_is_damped(tmp_path) -> None:
    # The model stands stretched, at the slide's dead point. Damping at the pin could do nearly all that the slide's does.
    nothing = {"crank": 0.0, "pin": 0.0, "slide": 0.0, "gravity": "0 0 -9.81"}
    recordings = []
    for k, crank in enumerate((1.0, 2.2)):
        time, q = motion(SLIDER_CRANK.format(**nothing | {"slide": 2.0}), mounted(crank), np.zeros(3), 4.0)
        recordings.append(recording(f"run{k}", time, {("slide", "position"): q[:, 2]}, 5e-4, k))
    model = load(model_file(tmp_path, SLIDER_CRANK.format(**nothing)))
    found = diagnose(recordings, model, only=("viscous_damping", "coulomb_friction", "quadratic_drag"))
    assert found.verdict == "explained"
    assert [f"{f['effect']}@{f['site']}" for f in found.findings] == ["viscous_damping@slide"]
    low, high = found.findings[0]["parameters"]["coefficient"]["ci95"]
    assert low <= 2.0 <= high


def test_a_gap_is_found_where_the_loop_is_closed(model) -> None:
    gap = 0.002
    recordings = four_bar(closing=ROPE.format(gap=gap), step="0.00005")
    # Contacts are stiff, and the whole catalogue beside one takes far longer.
    found = diagnose(recordings, model, only=("loop_clearance", "viscous_damping", "coulomb_friction"))
    assert "loop_clearance@knee" in [f"{f['effect']}@{f['site']}" for f in found.findings]
    told = next(f for f in found.findings if f["effect"] == "loop_clearance")["parameters"]["gap"]
    assert told["value"] == pytest.approx(gap, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("hidden", "key", "parameter"),
    [({"elbow": 0.01}, "viscous_damping@elbow", "coefficient"), ({"dry": 0.02}, "coulomb_friction@elbow", "torque")],
)
def test_a_five_bar_that_hangs_on_its_cranks_tells_which_elbow_rubs(tmp_path, hidden, key, parameter) -> None:
    """The whole catalogue, at four joints of which two are recorded."""
    found = diagnose(five_bar(**hidden), load(model_file(tmp_path, FIVE_BAR.format(elbow=0.0, dry=0.0))))
    assert found.verdict == "explained"
    assert [f"{f['effect']}@{f['site']}" for f in found.findings] == [key]
    (value,) = hidden.values()
    told = found.findings[0]["parameters"][parameter]
    assert told["ci95"][0] <= value <= told["ci95"][1]
