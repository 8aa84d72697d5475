"""Floating robots and balls as two descriptions: what differs is named, whichever format says that the root floats."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import pytest

import harness
from harness.cases.run import validate
from harness.errors import InputError
from harness.system import System, random_tree, write
from harness.system.random_joints import in_space

BASE = """<link name="base"><inertial><mass value="2"/>
<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


def heavier(system: System, name: str) -> System:
    links = tuple(replace(link, mass=1.05 * link.mass) if link.name == name else link for link in system.links)
    return replace(system, links=links)


def failed(*models: Path, floating: bool = False) -> list[str]:
    found = validate(models=models, engines=["denoc"], floating=floating)
    return [row.quantity for row in found.rows if row.verdict == "fail"]


def test_a_urdf_that_is_let_float_against_an_mjcf_that_floats(tmp_path: Path) -> None:
    urdf, same, other = tmp_path / "robot.urdf", tmp_path / "robot.xml", tmp_path / "heavier.xml"
    write(random_tree(5, seed=4, damping=True), urdf)
    # What floats has mass.
    urdf.write_text(urdf.read_text().replace('<link name="base"/>', BASE))
    floating = harness.load(urdf, floating=True)
    write(floating, same)
    write(heavier(floating, "link3"), other)
    assert failed(urdf, same, floating=True) == []
    assert failed(urdf, other, floating=True) == ["mass@link3"]
    # Fixed to the world it is another mechanism.
    assert "body@link1" in failed(urdf, same) or "tree@link1" in failed(urdf, same)
    with pytest.raises(InputError, match="no URDF"):
        validate(models=[same], floating=True)


def test_balls_and_other_joints_of_several_degrees(tmp_path: Path) -> None:
    one, two = tmp_path / "one.toml", tmp_path / "two.toml"
    system = in_space()
    write(system, one)
    write(heavier(system, "b").replace_joint(replace(system.joint("hip"), damping=0.3)), two)
    assert failed(one, two) == ["mass@b", "damping@hip.wx", "damping@hip.wy", "damping@hip.wz"]


ALONE = """<robot name="alone"><link name="{name}"><inertial><origin xyz="0.1 0 0.02"/><mass value="2.3"/>
<inertia ixx="0.03" iyy="0.02" izz="0.04" ixy="0.001" ixz="0" iyz="0"/></inertial></link>{rest}</robot>"""
TAIL = """<link name="tail"><inertial><mass value="0.4"/><inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/>
</inertial></link><joint name="wag" type="continuous"><parent link="world"/><child link="tail"/><origin xyz="0.3 0 0"/>
<axis xyz="0 1 0"/></joint>"""


@pytest.mark.parametrize(("name", "rest"), [("body", ""), ("world", TAIL)])
def test_a_root_alone_or_of_the_world_s_name_floats_in_every_engine(name: str, rest: str, tmp_path: Path) -> None:
    """Robots are published so: a quadrotor of one body, arms whose root is called "world", as MuJoCo's own body is."""
    file = tmp_path / "robot.urdf"
    file.write_text(ALONE.format(name=name, rest=rest))
    found = validate(models=[file], engines=["pinocchio", "mujoco"], floating=True)
    compared = {row.engines for row in found.rows if row.quantity == "acceleration" and row.verdict == "pass"}
    assert compared == {("denoc", "pinocchio"), ("denoc", "mujoco")}
    assert not [row for row in found.rows if row.verdict == "fail"]


def test_a_link_of_the_world_s_name_is_written_as_mujoco_can_read_it(tmp_path: Path) -> None:
    file, written = tmp_path / "robot.urdf", tmp_path / "robot.xml"
    file.write_text(ALONE.format(name="world", rest=TAIL))
    assert "link 'world' is body 'world_': the world of MJCF has that name" in write(
        harness.load(file, floating=True), written
    )
    model = mujoco.MjModel.from_xml_path(str(written))
    assert model.body("world_").mass == pytest.approx(2.3)
    assert model.body("tail").parentid == model.body("world_").id
