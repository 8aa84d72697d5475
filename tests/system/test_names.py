"""Names with control characters are refused: they stand in tables and in lines that terminals and servers read for commands."""

from __future__ import annotations

from pathlib import Path

import pytest

import harness
from harness.errors import InputError

TOML = """name = "NAME"
[[joint]]
name = "JOINT"
type = "revolute"
parent = "BASE"
child = "LINK"
axis = [0, 1, 0]
[[link]]
name = "LINK"
mass = 0.2
com = [0, 0, -0.15]
inertia = [1.5e-3, 1.5e-3, 1e-6]
"""
URDF = """<robot name="NAME"><link name="BASE"/>
<link name="LINK"><inertial><origin xyz="0 0 -0.15"/><mass value="0.2"/>
<inertia ixx="1.5e-3" iyy="1.5e-3" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="JOINT" type="continuous"><parent link="BASE"/><child link="LINK"/><axis xyz="0 1 0"/></joint></robot>
"""
MJCF = """<mujoco model="NAME"><worldbody><body name="LINK">
<inertial pos="0 0 -0.15" mass="0.2" diaginertia="1.5e-3 1.5e-3 1e-6"/><joint name="JOINT" axis="0 1 0"/>
</body></worldbody></mujoco>
"""
PLAIN = {"NAME": "swing", "BASE": "base", "LINK": "rod", "JOINT": "pivot"}
# A line break and the beginning of a terminal's command; C1's is one that XML 1.0 has a way to write.
STRANGE = {".toml": ("a\\nb", "\\u001b[31m", "\\u009b31m"), ".urdf": ("a&#10;b", "&#x9b;31m"), ".xml": ("a&#10;b",)}


def _written(folder: Path, ending: str, **names: str) -> Path:
    text = {".toml": TOML, ".urdf": URDF, ".xml": MJCF}[ending]
    for word, name in {**PLAIN, **names}.items():
        text = text.replace(word, name)
    path = folder / f"model{ending}"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("ending", STRANGE)
def test_letters_of_any_language_are_names(tmp_path: Path, ending: str) -> None:
    system = harness.load(_written(tmp_path, ending, JOINT="Gelenk é 関節\u00a0α-β"))
    assert system.coordinate_names == ("Gelenk é 関節\u00a0α-β",)


@pytest.mark.parametrize("word", ["NAME", "LINK", "JOINT"])
@pytest.mark.parametrize(("ending", "name"), [(end, name) for end, names in STRANGE.items() for name in names])
def test_a_control_character_in_a_name_is_refused(tmp_path: Path, ending: str, name: str, word: str) -> None:
    path = _written(tmp_path, ending, **{word: name})
    with pytest.raises(InputError) as caught:
        harness.load(path)
    said = str(caught.value)
    assert "control character" in said and str(path) in said and said.isprintable()
