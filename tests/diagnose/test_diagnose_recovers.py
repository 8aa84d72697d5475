"""What is hidden in recordings made by other means is found, named and measured; what is not there is not."""

from __future__ import annotations

import json

import numpy as np
import pytest
from simulated_recordings import GRAVITY, Rig, double_pendulum, nominal, recording, releases, swing

import harness
from harness.errors import InputError

NOISE = 1e-3


def names(document: dict) -> set[tuple[str, str]]:
    return {(f["effect"], f["site"]) for f in document["findings"]}


def classes(document: dict) -> list[set[str]]:
    return [{f["effect"], *(o.split("@")[0] for o in f["indistinguishable_from"])} for f in document["findings"]]


@pytest.mark.parametrize("seed", range(4))
def test_clean_recordings_stay_clean(seed: int) -> None:
    # Inertia and mass off by up to half the stated tolerance of 1 %.
    rng = np.random.default_rng(seed)
    off = 1.0 + 0.005 * rng.uniform(-1.0, 1.0, 3)
    rig = Rig(mass=0.3 * off[0], com=0.25 * off[1], inertia=0.003 * off[2])
    noise = 10.0 ** rng.uniform(-4.0, -2.3)
    angles = tuple(rng.uniform(0.4, 2.0, 2))
    document = harness.diagnose(releases(rig, angles, noise, seed), model=nominal()).to_json()
    assert document["verdict"] == "consistent", document["summary"]
    assert document["findings"] == []
    # The noise is what was put in; 5 % is three standard errors of a standard deviation over these samples and more.
    assert document["noise"][0]["std"] == pytest.approx(noise, rel=0.05)


@pytest.mark.parametrize(
    ("noise", "hidden", "effect", "parameter", "value"),
    [
        (2e-4, {"viscous": 1.5e-3}, "viscous_damping", "coefficient", 1.5e-3),
        (1e-3, {"dry": 6e-3}, "coulomb_friction", "torque", 6e-3),
        (4e-3, {"drag": 1.2e-3}, "quadratic_drag", "coefficient", 1.2e-3),
    ],
)
def test_dissipation_is_named_and_measured(
    hidden: dict, effect: str, parameter: str, value: float, noise: float
) -> None:
    seed = int(1e6 * noise) + len(effect)
    document = harness.diagnose(releases(Rig(**hidden), (1.4, 0.9, 1.1), noise, seed), model=nominal()).to_json()
    assert document["verdict"] == "explained", document["summary"]
    assert names(document) == {(effect, "pivot")}
    found = document["findings"][0]["parameters"][parameter]
    # The torque is known only relative to the inertia, which is given within 1 % a quantity; so is the parameter.
    assert abs(found["value"] - value) < 4.0 * found["std"] + 1e-12
    assert found["std"] < 0.05 * value
    assert document["fit"][0]["augmented"]["heldout_rmse"] < 1.2 * document["fit"][0]["noise_floor"]


def test_dry_and_viscous_friction_are_told_apart_and_together() -> None:
    document = harness.diagnose(
        releases(Rig(dry=4e-3, viscous=1e-3), (1.5, 0.8, 1.2), NOISE, 11), model=nominal()
    ).to_json()
    assert names(document) == {("coulomb_friction", "pivot"), ("viscous_damping", "pivot")}
    assert document["verdict"] == "explained"


def test_tilt_is_not_turned_into_friction_and_its_class_is_told() -> None:
    # A sensor that reads 0.02 rad too much and a base tilted the other way give one and the same signal.
    runs = []
    rng = np.random.default_rng(5)
    time = np.arange(0.0, 12.0, 0.01)
    for k, angle in enumerate((1.2, 0.7, 1.0)):
        q = swing(Rig(), angle, time) + 0.02 + NOISE * rng.standard_normal(len(time))
        runs.append(recording(f"run{k}", time, {"pivot.position": q}))
    document = harness.diagnose(runs, model=nominal()).to_json()
    assert len(document["findings"]) == 1
    assert {"sensor_offset", "base_tilt"} <= classes(document)[0]
    # No motion parts these two, and none is proposed for them; whether the centre of mass lies aside, a further sensor tells.
    assert document["next_experiment"]["separates"] == ["sensor_offset", "com_side_offset"]
    assert document["next_experiment"]["what"].startswith(
        "mount an accelerometer at the tip of rod, release from 0.8 rad"
    )


def test_driven_gain_error_is_on_the_input_side() -> None:
    rng = np.random.default_rng(8)
    time = np.arange(0.0, 12.0, 0.01)
    moment = 0.3 * GRAVITY * 0.25
    runs = []
    for k, frequency in enumerate((0.5, 1.3, 0.7)):

        def commanded(t: float, f: float = frequency) -> float:
            return float(0.15 * moment * np.sin(2 * np.pi * f * t))

        q = swing(Rig(), 0.2, time, lambda t, c=commanded: 0.8 * c(t))
        columns = {
            "pivot.position": q + NOISE * rng.standard_normal(len(time)),
            "pivot.effort": np.array([commanded(t) for t in time]),
        }
        runs.append(recording(f"run{k}", time, columns))
    document = harness.diagnose(runs, model=nominal()).to_json()
    assert "actuator_gain" in set().union(*classes(document))
    assert document["mismatch"][0]["side"] == "input"
    gain = next(f for f in document["findings"] if f["effect"] == "actuator_gain")["parameters"]["gain"]
    assert gain["value"] == pytest.approx(0.8, abs=0.03)


def test_the_right_joint_is_named() -> None:
    system, runs = double_pendulum(elbow_damping=4e-3, noise=NOISE, seed=2)
    document = harness.diagnose(runs, model=system).to_json()
    assert names(document) == {("viscous_damping", "elbow")}
    # MuJoCo's own damping coefficient is the truth.
    assert document["findings"][0]["parameters"]["coefficient"]["value"] == pytest.approx(4e-3, rel=0.05)


def test_a_magnet_at_one_angle_is_not_explained_away() -> None:
    # A narrow attraction at 0.5 rad is in no catalogue: a remainder must stay, or nothing be claimed.
    def magnet(t: float, q: float, v: float) -> float:
        return -0.15 * (q - 0.5) / 0.05 * float(np.exp(-(((q - 0.5) / 0.05) ** 2)))

    document = harness.diagnose(releases(Rig(torque=magnet), (1.3, 0.8, 1.0), NOISE, 4), model=nominal()).to_json()
    assert document["verdict"] in ("unexplained", "partly_explained")
    assert document["remainder"]["significant"]


def test_the_document_has_the_fields_that_programs_rely_on() -> None:
    document = harness.diagnose(releases(Rig(viscous=1.5e-3), (1.4, 0.9), NOISE, 3), model=nominal()).to_json()
    json.dumps(document, allow_nan=False)
    assert document["schema"] == "denoc.diagnosis/1"
    for key in (
        "verdict",
        "summary",
        "noise",
        "mismatch",
        "findings",
        "ranking",
        "fit",
        "remainder",
        "next_experiment",
    ):
        assert key in document
    place = document["mismatch"][0]
    assert place["channel"] == "pivot.position" and place["side"] == "dynamics" and place["site"] == "pivot"
    assert place["severity"] > 1.0
    fit = document["fit"][0]
    assert fit["augmented"]["heldout_rmse"] < fit["nominal"]["heldout_rmse"]


def test_a_recording_of_another_machine_is_refused() -> None:
    time = np.arange(0.0, 5.0, 0.01)
    with pytest.raises(InputError, match="does not have"):
        harness.diagnose([recording("x", time, {"wheel.position": np.sin(time)})], model=nominal())
