"""TOML systems: what the table means, and one clear line for each thing that cannot be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from jacobian_mechanics import mass_matrix

import harness
from harness.errors import InputError
from harness.system.flexible_link import rectangle_torsion_constant

PIVOT = """[[joint]]
name = "pivot"
type = "revolute"
parent = "base"
child = "rod"
axis = [0, 1, 0]
"""
RIGID = """[[link]]
name = "rod"
mass = 0.2
com = [0, 0, -0.15]
inertia = [1.5e-3, 1.5e-3, 1e-6]
"""
BEAM = """[[link]]
name = "rod"
length = 0.30
direction = [0, 0, -1]
bending = [1, 0, 0]
section = { width = 0.025, thickness = 0.001 }
material = { youngs_modulus = 2.0e11, density = 7850.0 }
modes = 2
"""


def load_text(folder: Path, text: str, **options: object) -> harness.System:
    path = folder / "system.toml"
    path.write_text(text, encoding="utf-8")
    return harness.load(path, **options)


def test_defaults_and_overrides(tmp_path: Path) -> None:
    system = load_text(tmp_path, PIVOT + RIGID)
    assert (system.name, system.base, system.tolerance) == ("system", "base", 0.01)
    np.testing.assert_array_equal(system.gravity, [0.0, 0.0, -9.81])
    assert load_text(tmp_path, "tolerance = 0.2\n" + PIVOT + RIGID).tolerance == 0.2
    assert load_text(tmp_path, "tolerance = 0.2\n" + PIVOT + RIGID, tolerance=0.05).tolerance == 0.05


def test_content_decides_not_the_ending(tmp_path: Path) -> None:
    path = tmp_path / "system.urdf"
    path.write_text("\ufeff" + PIVOT + RIGID, encoding="utf-8")
    assert harness.load(path).joint_names == ("pivot",)


def test_inertia_as_three_six_or_nine(tmp_path: Path) -> None:
    for written in (
        "[1.0, 2.0, 2.5, 0.1, 0.2, 0.3]",
        "[[1.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 2.5]]",
    ):
        inertia = load_text(tmp_path, PIVOT + RIGID.replace("[1.5e-3, 1.5e-3, 1e-6]", written)).links[0].inertia
        np.testing.assert_array_equal(inertia, [[1.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 2.5]])


def test_beam_frozen_has_the_inertia_of_a_slender_rod_with_payload(tmp_path: Path) -> None:
    """ρ l³/3 + m_p l² + I_h, and first moment ρ l²/2 + m_p l (SEED's rigid pendulum equation)."""
    text = PIVOT + "armature = 2e-5\n" + BEAM + "payload = 0.02\n"
    system = load_text(tmp_path, text)
    m, l, mp = 7850.0 * 0.30 * 0.025 * 0.001, 0.30, 0.02
    np.testing.assert_allclose(mass_matrix(system, np.zeros(1)), m * l**2 / 3 + mp * l**2 + 2e-5, rtol=1e-14)
    link = system.links[0]
    np.testing.assert_allclose(link.mass * link.com, [0, 0, -(m * l / 2 + mp * l)], rtol=1e-14)
    beam = link.beam
    assert beam is not None
    assert beam.bending_stiffness == pytest.approx(2.0e11 * 0.025 * 0.001**3 / 12, rel=1e-14)
    assert system.coordinate_names == ("pivot", "rod.mode1", "rod.mode2")


def test_second_plane_and_torsion(tmp_path: Path) -> None:
    text = PIVOT + BEAM.replace("density = 7850.0", "density = 7850.0, poissons_ratio = 0.25")
    beam = load_text(tmp_path, text + "bending2 = true\ntorsion_modes = 1\n").links[0].beam
    assert beam is not None
    assert beam.coordinates == 5
    assert beam.bending_stiffness2 == pytest.approx(2.0e11 * 0.001 * 0.025**3 / 12, rel=1e-14)
    # G = E / 2.5 = 8e10 Pa; J = w t³ / 3 · (1 - 0.63 t / w), Timoshenko & Goodier, art. 109.
    assert beam.torsional_stiffness == pytest.approx(8e10 * 0.025 * 1e-9 / 3 * (1 - 0.63 / 25), rel=2e-3)
    assert beam.polar_inertia == pytest.approx(7850 * 0.025 * 0.001 * (0.025**2 + 0.001**2) / 12, rel=1e-12)


@pytest.mark.parametrize(
    ("ratio", "factor"), [(1.0, 0.1406), (1.5, 0.196), (2.0, 0.229), (3.0, 0.263), (5.0, 0.291), (10.0, 0.312)]
)
def test_torsion_constant_of_rectangles(ratio: float, factor: float) -> None:
    """Table of k1 in J = k1 a b³, Timoshenko & Goodier, Theory of Elasticity, art. 109 (three digits)."""
    assert rectangle_torsion_constant(ratio, 1.0) == pytest.approx(factor * ratio, rel=4e-3)


def test_effects_become_attachments(tmp_path: Path) -> None:
    text = '[[effect]]\nname = "coulomb_friction"\nsite = "pivot"\nparameters = { torque = 0.01 }\nstd = { torque = 1e-3 }\n'
    (attachment,) = load_text(tmp_path, PIVOT + RIGID + text).attachments
    assert (attachment.effect, attachment.site) == ("coulomb_friction", "pivot")
    assert (attachment.parameters, attachment.std) == ({"torque": 0.01}, {"torque": 0.001})


def test_joints_come_parent_first_whatever_the_order_in_the_file(tmp_path: Path) -> None:
    second = PIVOT.replace("pivot", "elbow").replace('"base"', '"rod"').replace('child = "rod"', 'child = "tip"')
    system = load_text(tmp_path, second + PIVOT + RIGID.replace('"rod"', '"tip"') + RIGID)
    assert system.joint_names == ("pivot", "elbow")
    assert [link.name for link in system.links] == ["rod", "tip"]


def test_what_is_taken_for_granted_is_noted(tmp_path: Path) -> None:
    link = '[[link]]\nname = "rod"\nmass = 1.0\ncom = [0, 0, -1]\n'
    assert any("point mass" in note for note in load_text(tmp_path, PIVOT + link).notes)


SECOND = PIVOT.replace("pivot", "elbow")
REFUSED = {
    "broken TOML": ("name = \n", r"system\.toml:1, column 8: not valid TOML: Invalid value"),
    "cut off": (PIVOT + "x = [1, ", r"system\.toml:7: not valid TOML"),
    "empty": ("  \n", r"system\.toml: is empty"),
    "no joint": ('name = "x"\n', r"there is no \[\[joint\]\]"),
    "single bracket": ('[joint]\nname = "x"\n', r"write \[\[joint\]\]"),
    "unknown top key": (
        "gravty = [0, 0, 1]\n" + PIVOT + RIGID,
        r":1: model: unknown key 'gravty' \(did you mean 'gravity'\?\)",
    ),
    "tolerance in per cent": ("tolerance = 5\n" + PIVOT + RIGID, r":1: .*tolerance 5 is not a relative 1σ"),
    "unknown joint key": (PIVOT + "dampng = 1.0\n" + RIGID, r":7: joint 'pivot': unknown key 'dampng'.*'damping'"),
    "unknown link key": (
        PIVOT + BEAM + "mods = 3\n",
        r":15: link 'rod': unknown key 'mods' \(did you mean 'modes'\?\)",
    ),
    "unknown section key": (PIVOT + BEAM.replace("width", "widht"), r":12: link 'rod', section: .*width"),
    "unknown type": (PIVOT.replace("revolute", "revolut") + RIGID, r":3: .*unknown joint type 'revolut'.*'revolute'"),
    "unknown parent": (
        PIVOT.replace('"base"', '"bse"') + RIGID,
        r":1: joint 'pivot': parent 'bse' .*did you mean 'base'",
    ),
    "unknown child": (PIVOT.replace('"rod"', '"rdo"') + RIGID, r":1: joint 'pivot': child 'rdo' .*did you mean 'rod'"),
    "cyclic": (PIVOT.replace('"base"', '"rod"') + RIGID, r"links rod → rod form a loop \(cyclic tree\)"),
    "two parents": (PIVOT + SECOND + RIGID, r":7: link 'rod' has two parents: joints 'pivot' and 'elbow'"),
    "unreachable": (PIVOT + RIGID + RIGID.replace("rod", "stray"), r":12: link 'stray' cannot be reached from 'base'"),
    "duplicate joint": (PIVOT + PIVOT + RIGID, r":7: two joints are named 'pivot'"),
    "duplicate link": (PIVOT + RIGID + RIGID, r":12: two links are named 'rod'"),
    "zero axis": (PIVOT.replace("[0, 1, 0]", "[0, 0.0, 0]") + RIGID, r":6: joint 'pivot': 'axis' has zero length"),
    "no axis": (PIVOT.replace("axis = [0, 1, 0]\n", "") + RIGID, r":1: joint 'pivot': 'axis' is missing"),
    "wrong size": (PIVOT.replace("[0, 1, 0]", "[0, 1]") + RIGID, r":6: .*must be three numbers, not 2 value"),
    "wrong tensor": (PIVOT + RIGID.replace("1.5e-3, 1.5e-3,", "1.5e-3,"), r":11: link 'rod': 'inertia' has 2 values"),
    "crooked tensor": (
        PIVOT + RIGID.replace("[1.5e-3, 1.5e-3, 1e-6]", "[[1,2,0],[0,1,0],[0,0,1]]"),
        r":11: .*not symmetric",
    ),
    "text for number": (
        PIVOT + RIGID.replace("mass = 0.2", 'mass = "0.2"'),
        r":9: link 'rod': 'mass' must be a number",
    ),
    "NaN": (PIVOT + RIGID.replace("0.2", "nan"), r":9: link 'rod': 'mass' must be a finite number, not nan"),
    "infinite": (PIVOT + RIGID.replace("-0.15", "inf"), r":10: link 'rod': 'com' must be a finite number"),
    "negative mass": (PIVOT + RIGID.replace("0.2", "-0.2"), r":9: link 'rod': 'mass' must not be negative"),
    "zero mass": (PIVOT + RIGID.replace("0.2", "0.0"), r":7: link 'rod': mass is zero but inertia is not"),
    "negative inertia": (
        PIVOT + RIGID.replace("[1.5e-3,", "[-1.5e-3,"),
        r":7: link 'rod': principal moment .* is negative",
    ),
    "triangle": (PIVOT + RIGID.replace("1e-6", "4e-3"), r":7: link 'rod': .*triangle inequality"),
    "massless": (PIVOT + '[[link]]\nname = "rod"\nmass = 0.0\n', r":1: joint 'pivot': inertia about its axis is zero"),
    "no mass": (PIVOT + '[[link]]\nname = "rod"\n', r":7: link 'rod': 'mass' is missing"),
    "negative damping": (PIVOT + "damping = -1.0\n" + RIGID, r":7: joint 'pivot': 'damping' must not be negative"),
    "crossed limits": (PIVOT + "limits = { lower = 1, upper = -1 }\n" + RIGID, r"lower 1 is above upper -1"),
    "mixed link": (PIVOT + BEAM + "inertia = [1, 1, 1]\n", r":15: link 'rod': 'inertia' follows from length"),
    "critical damping": (
        PIVOT + BEAM + "modal_damping = [1.0]\n",
        r":15: link 'rod': modal_damping has a ratio outside",
    ),
    "too many ratios": (
        PIVOT + BEAM + "modal_damping = [0.1, 0.1, 0.1]\n",
        r":15: link 'rod': modal_damping has 3 numbers",
    ),
    "no stiffness": (PIVOT + BEAM + "mode_stiffness = [0.0]\n", r":15: link 'rod': mode_stiffness has a factor"),
    "half a beam": (PIVOT + RIGID + "modes = 2\n", r":12: link 'rod': 'modes' belongs to a flexible link"),
    "bending along": (
        PIVOT + BEAM.replace("[1, 0, 0]", "[0, 0, 2]"),
        r":11: link 'rod': bending points along the link",
    ),
    "bending askew": (
        PIVOT + BEAM.replace("[1, 0, 0]", "[1, 0, 1]"),
        r":11: link 'rod': bending is 135\.0° from direction",
    ),
    "zero stiffness": (PIVOT + BEAM.replace("2.0e11", "0.0"), r":13: .*'youngs_modulus' must be positive, not 0"),
    "negative stiffness": (PIVOT + BEAM.replace("2.0e11", "-2.0e11"), r":13: .*'youngs_modulus' must be positive"),
    "zero thickness": (PIVOT + BEAM.replace("0.001", "0.0"), r":12: .*'thickness' must be positive"),
    "zero length": (PIVOT + BEAM.replace("0.30", "0.0"), r":9: link 'rod': 'length' must be positive"),
    "too many modes": (
        PIVOT + BEAM.replace("modes = 2", "modes = 40"),
        r":14: .*modes = 40 is more than.*use at most 20",
    ),
    "no modes": (PIVOT + BEAM.replace("modes = 2", "modes = 0"), r"needs at least one mode"),
    "density against mass": (PIVOT + BEAM + "mass = 0.60\n", r":15: .*density contradicts mass: .*\(density 80000\)"),
    "no material": (PIVOT + BEAM.replace("material", "#"), r":7: link 'rod': 'material' is missing"),
    "unknown shapes": (PIVOT + BEAM + 'shapes = "cubic"\n', r":15: .*unknown shapes 'cubic'"),
}


@pytest.mark.parametrize(("text", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_refused_in_one_line_with_its_place(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        load_text(tmp_path, text)
    assert "\n" not in str(caught.value)
    assert str(tmp_path / "system.toml") in str(caught.value)


@pytest.mark.parametrize(
    ("kind", "further", "message"),
    [
        ("floating", "", r":3: joint 'pivot': unknown joint type 'floating' \(did you mean \"free\"\?\)"),
        ("universal", "", r"add axis2 = \[0, 1, 0\], in the joint frame"),
        ("universal", "axis2 = [0, -2, 0]\n", "'axis' and 'axis2' are parallel"),
        ("helical", "", "add pitch = "),
        ("ball", "stiffness = 1.0\n", "'stiffness' of a ball joint is not modelled"),
        ("revolute", 'mimic = { joint = "pivot" }\n', "joints pivot → pivot mimic one another in a circle"),
        ("revolute", 'mimic = { joint = "elbow" }\n', "joint 'pivot' mimics 'elbow', which is no joint of this model"),
        ("planar", 'mimic = { joint = "pivot" }\n', "joint 'pivot' of type planar mimics 'pivot'"),
    ],
)
def test_unusable_joints_are_refused_in_one_line(tmp_path: Path, kind: str, further: str, message: str) -> None:
    pivot = PIVOT.replace("revolute", kind).replace("axis = [0, 1, 0]\n", f"axis = [0, 1, 0]\n{further}")
    assert further in pivot
    with pytest.raises(InputError, match=message) as caught:
        load_text(tmp_path, pivot + RIGID)
    assert "\n" not in str(caught.value)


def test_files_that_are_no_models(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nowhere\.toml: there is no such file"):
        harness.load(tmp_path / "nowhere.toml")
    with pytest.raises(InputError, match="is a folder"):
        harness.load(tmp_path)
    (tmp_path / "model.mjb").write_bytes(b"\x00\xff\xfe\x80model")
    with pytest.raises(InputError, match=r"model\.mjb:1: is not UTF-8 text"):
        harness.load(tmp_path / "model.mjb")


def test_joints_singular_in_one_pose_only_are_sound(tmp_path: Path) -> None:
    """Three crossing axes with massless links between: gimbal lock at one pose is no defect of the model."""
    text = ""
    for name, parent, child, axis in (("a", "base", "l1", "x"), ("b", "l1", "l2", "y"), ("c", "l2", "rod", "x")):
        text += (
            PIVOT.replace("pivot", name)
            .replace('"base"', f'"{parent}"')
            .replace('"rod"', f'"{child}"')
            .replace("[0, 1, 0]", {"x": "[1, 0, 0]", "y": "[0, 1, 0]"}[axis])
        )
    text += '[[link]]\nname = "l1"\nmass = 0.0\n[[link]]\nname = "l2"\nmass = 0.0\n'
    assert len(load_text(tmp_path, text + RIGID).joint_names) == 3
    parallel = text.replace("axis = [0, 1, 0]", "axis = [1, 0, 0]")
    with pytest.raises(InputError, match="joint 'b': inertia about its axis is zero"):
        load_text(tmp_path, parallel + RIGID)
