"""The audit finds what is wrong with a parameter table by itself, and leaves sound tables alone."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.errors import InputError
from harness.system import audit
from harness.system.slips import slips
from harness.system.strip_frequency import strip_frequencies

MODELS = Path(__file__).resolve().parents[2] / "models"
PRINTED = MODELS / "toml/flexible_pendulum_as_printed.toml"


def printed(**changes: float) -> dict[str, Any]:
    """The published table of the flexible pendulum, some numbers changed."""
    raw = tomllib.loads(PRINTED.read_text(encoding="utf-8"))
    joint, link = raw["joint"][0], raw["link"][0]
    for key, value in changes.items():
        place = {"armature": joint, "youngs_modulus": link["material"], "density": link["material"]}.get(key, link)
        place = link["section"] if key in ("width", "thickness") else place
        if value == 0.0:
            place.pop(key)
        else:
            place[key] = value
    return raw


# Roots βl of uniform beams: R. D. Blevins, Formulas for Natural Frequency and Mode Shape, 1979, table 8-1. On a hub of
# 2e-5 kg·m²: Exudyn's ANCF beam of 16 elements has 37.540 Hz.
STRIP = {"bending_stiffness": 2.0e11 * 0.025 * 0.001**3 / 12, "mass": 7850 * 0.30 * 0.025 * 0.001, "length": 0.30}


def test_strip_frequencies_are_the_closed_forms() -> None:
    unit = np.sqrt(STRIP["bending_stiffness"] / (STRIP["mass"] * STRIP["length"] ** 3)) / (2 * np.pi)
    clamped = np.array([1.87510407, 4.69409113, 7.85475744]) ** 2 * unit
    np.testing.assert_allclose(strip_frequencies(**STRIP, clamped=True, count=3), clamped, rtol=1e-8)
    pinned = np.array([3.92660231, 7.06858275]) ** 2 * unit
    np.testing.assert_allclose(strip_frequencies(**STRIP, count=2), pinned, rtol=1e-8)
    hub = strip_frequencies(**STRIP, hub_inertia=2e-5, count=3)
    np.testing.assert_allclose(hub, [37.540, 103.08, 186.29], atol=5e-3)


def test_tip_mass_equal_to_the_beams() -> None:
    """(βl)² = 1.557298, 16.25009, 50.89584, 105.1983, 179.2320 for a cantilever with its own mass at the tip."""
    frequencies = strip_frequencies(1.0, 1.0, 1.0, payload=1.0, clamped=True, count=5) * 2 * np.pi
    np.testing.assert_allclose(frequencies, [1.557298, 16.25009, 50.89584, 105.1983, 179.2320], rtol=1e-6)


def test_the_published_table_is_impossible_and_the_audit_finds_why() -> None:
    """Hammer test 37 Hz: a 1 mm strip of 0.060 kg, 8000 kg/m³, is at 37.2 Hz; no other simple slip comes near."""
    result = audit(PRINTED, measured={"rod": [37.0]})
    assert not result.possible
    worst = result.findings[0]
    assert worst.severity == "impossible" and "40000 kg/m³" in worst.what
    best = result.corrections[0]
    assert {change.quantity: change.corrected for change in best.changes} == pytest.approx(
        {"thickness": 0.001, "mass": 0.060}
    )
    assert best.agrees
    assert best.density == pytest.approx(8000.0)
    assert "steel" in best.material
    assert best.frequencies[0] == pytest.approx(37.2, abs=0.05)
    assert best.probability > 0.9
    scores = [correction.score for correction in result.corrections]
    assert scores == sorted(scores)
    assert "thickness 0.002 → 0.001 m" in str(best)
    assert result.to_json()["corrections"][0]["changes"][0]["stated"] in (0.002, 0.60)


def test_without_a_measurement_many_slips_explain_it_and_none_is_certain() -> None:
    result = audit(PRINTED)
    assert sum(c.agrees for c in result.corrections) > 3
    told = [{change.quantity: change.corrected for change in c.changes} for c in result.corrections]
    assert pytest.approx({"thickness": 0.001, "mass": 0.060}) in told


def test_corrections_as_good_as_one_another_share_a_rank_and_none_is_cut_off() -> None:
    """Half of the thickness and a tenth of the mass is one of many ways to a fortieth: the slips and the density are the same."""
    result = audit(PRINTED)
    (tie,) = (t for t in result.ties if any({x.quantity for x in c.changes} == {"thickness", "mass"} for c in t))
    assert len({c.rank for c in tie}) == 1 and np.ptp([c.score for c in tie]) < 1e-6
    halved, tenth = 0.5, 0.1
    ways = {frozenset(x.quantity for x in c.changes) for c in tie}
    # By hand: density is mass / (length width thickness), 40000 of 8000; a fifth is a half of one over ten of another.
    for quantity in ("length", "width", "thickness"):
        assert frozenset({quantity, "mass"}) in ways
        others = {"length", "width", "thickness"} - {quantity}
        assert all(frozenset({quantity, other}) in ways for other in others)
    for c in tie:
        factors = sorted(x.corrected / x.stated for x in c.changes)
        assert factors == pytest.approx([tenth, halved]) or factors == pytest.approx([halved, 10.0])


def test_hub_inertia_with_the_wrong_sign_of_its_exponent() -> None:
    """2×10⁵ kg·m² as printed, in the otherwise sound table, and in the printed one where it makes a third error."""
    alone = audit(printed(armature=2e5, mass=0.060, thickness=0.001))
    assert [f.severity for f in alone.findings] == ["implausible", "note"]
    (change,) = alone.corrections[0].changes
    assert (change.quantity, change.slip) == ("armature", "sign of the exponent")
    assert change.corrected == pytest.approx(2e-5)
    together = audit(printed(armature=2e5), measured={"rod": [37.0]}).corrections[0]
    assert {c.quantity: c.corrected for c in together.changes} == pytest.approx(
        {"armature": 2e-5, "mass": 0.060, "thickness": 0.001}
    )


@pytest.mark.parametrize(
    ("changes", "quantity", "corrected"),
    [
        ({"mass": 0.60, "thickness": 0.001}, "mass", 0.060),
        ({"mass": 58.9, "thickness": 0.001}, "mass", 0.0589),
        ({"mass": 0.059, "thickness": 0.001, "youngs_modulus": 200.0}, "youngs_modulus", 200e9),
        ({"mass": 0.0, "density": 7.85, "thickness": 0.001}, "density", 7850.0),
        ({"mass": 0.059, "thickness": 0.001, "width": 0.25}, "width", 0.025),
    ],
    ids=["decimal point", "grams", "GPa", "g/cm³", "ten times too wide"],
)
def test_single_slips(changes: dict[str, float], quantity: str, corrected: float) -> None:
    """Each is planted in the sound table (1 mm, 7850–8000 kg/m³, 200 GPa), which bends at 37.2–37.5 Hz."""
    result = audit(printed(**changes), measured={"rod": [37.4]})
    assert not result.possible
    (change,) = result.corrections[0].changes
    assert (change.quantity, change.corrected) == (quantity, pytest.approx(corrected))


def test_a_drawing_in_millimetres() -> None:
    raw = printed(length=300.0, width=25.0, thickness=1.0, mass=0.059)
    best = audit(raw).corrections[0]
    assert {c.quantity for c in best.changes} == {"length", "width", "thickness"}
    assert all(c.corrected == pytest.approx(c.stated / 1000) for c in best.changes)


@pytest.mark.parametrize(
    "path", sorted(p for p in MODELS.rglob("*.*") if p.suffix in (".toml", ".urdf", ".xml") and p != PRINTED), ids=str
)
def test_sound_models_are_left_alone(path: Path) -> None:
    result = audit(path)
    assert result.possible
    assert result.corrections == ()


def test_the_sound_table_agrees_with_the_hammer_test() -> None:
    assert audit(MODELS / "toml/flexible_pendulum.toml", measured={"rod": [37.0]}).possible


def test_a_table_that_cannot_be_loaded_is_audited_all_the_same(tmp_path: Path) -> None:
    path = tmp_path / "contradiction.toml"
    path.write_text(PRINTED.read_text().replace("2.0e11 }", "2.0e11, density = 7850.0 }"))
    result = audit(path)
    assert any("density contradicts mass" in f.what for f in result.findings)
    assert result.corrections


def test_rigid_links(tmp_path: Path) -> None:
    """Inertia given about the joint (m l²/3 = 4/3 m d²), and in kg·mm² where kg·m² is meant."""

    def told(inertia: str) -> str:
        path = tmp_path / "rigid.toml"
        path.write_text(
            '[[joint]]\nname = "j"\ntype = "revolute"\nparent = "base"\nchild = "rod"\naxis = [0, 1, 0]\n'
            f'[[link]]\nname = "rod"\nmass = 0.18\ncom = [0, 0, -0.15]\ninertia = {inertia}\n'
        )
        return " | ".join(f.what for f in audit(path).findings)

    assert told("[1.35e-3, 1.35e-3, 5e-6]") == ""
    assert "about the joint" in told("[5.4e-3, 5.4e-3, 5e-6]")
    assert "radius of gyration" in told("[1350.0, 1350.0, 5.0]")
    assert "triangle inequality" in told("[1.35e-3, 1e-4, 5e-6]")


def test_what_cannot_be_audited_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"link 'rdo' has measured frequencies but is not a flexible link.*rod"):
        audit(PRINTED, measured={"rdo": [37.0]})
    with pytest.raises(InputError, match="measured frequencies of 'rod' must be positive"):
        audit(PRINTED, measured={"rod": [-1.0]})
    with pytest.raises(InputError, match="no frequency of 'rod' was measured"):
        audit(PRINTED, measured={"rod": [float("nan")]})
    with pytest.raises(InputError, match="no such file"):
        audit(tmp_path / "nowhere.toml")
    with pytest.raises(InputError, match="not valid TOML"):
        (tmp_path / "broken.toml").write_text("x = [")
        audit(tmp_path / "broken.toml")
    with pytest.raises(InputError, match=r"link 'rod': mass is -0\.1"):
        audit(printed(mass=-0.1))
    with pytest.raises(InputError, match="link 'rod': mass or density is missing"):
        audit(printed(mass=0.0))


def test_slips_of_a_number() -> None:
    told = {round(slip.value, 12): slip.what for slip in slips(2e-3, length=True)}
    assert told[1e-3] == "half for whole"
    assert told[0.02] == "decimal point by 1"
    assert told[2.0] == "unit prefix (factor 1000)"
    assert told[2e3] == "sign of the exponent"
    assert told[7e-3] == "digit 2 for 7"
