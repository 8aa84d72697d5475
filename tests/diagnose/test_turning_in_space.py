"""Balls and floating bodies are diagnosed from recorded poses; the truth is MuJoCo's."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mechanisms_by_mujoco import BALL, BOX, CENTRED, LEGGED, legged, model_file, motion, recording
from scipy.spatial.transform import Rotation

from harness import diagnose
from harness.diagnose.conditioning.poses import in_charts
from harness.diagnose.problem.candidates import candidates
from harness.effects.scale import references
from harness.errors import InputError, UnsupportedError
from harness.recording import Recording
from harness.system import load, write

QUATERNION = ("qw", "qx", "qy", "qz")
LAWS = ("viscous_damping", "coulomb_friction", "quadratic_drag")


def hanging(damping: float, noise: float = 5e-4) -> list[Recording]:
    out = []
    for k, (q, w) in enumerate((((0.9, 0.4, 0.1, 0.0), (0.3, 1.5, 2.0)), ((0.85, -0.2, 0.45, 0.1), (-1.0, 0.4, -3.0)))):
        time, found = motion(BALL.format(damping=damping), np.array(q) / np.linalg.norm(q), w, 6.0)
        columns = {("ball", f"position.{name}"): found[:, j] for j, name in enumerate(QUATERNION)}
        out.append(recording(f"run{k}", time, columns, noise, k))
    return out


def thrown(damping: float, noise: float = 5e-4, text: str = BOX, joint: str = "root") -> list[Recording]:
    out = []
    for k, (v, w) in enumerate((((0.5, 1.0, 6.0), (1.0, 5.0, 2.0)), ((-1.0, 0.4, 7.0), (6.0, -1.0, 3.0)))):
        time, found = motion(text.format(damping=damping), (), (*v, *w), 2.0)
        columns = {(joint, f"pose.{name}"): found[:, j] for j, name in enumerate(("x", "y", "z", *QUATERNION))}
        out.append(recording(f"run{k}", time, columns, noise, k))
    return out


def test_damping_of_a_ball_is_found(tmp_path: Path) -> None:
    model = load(model_file(tmp_path, BALL.format(damping=0.0)))
    found = diagnose(hanging(0.02), model, only=LAWS)
    assert [f"{f['effect']}@{f['site']}" for f in found.findings] == ["viscous_damping@ball"]
    told = found.findings[0]["parameters"]["coefficient"]
    assert told["ci95"][0] <= 0.02 <= told["ci95"][1]
    assert told["unit"] == "N*m*s/rad"


@pytest.mark.slow
@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_a_centre_of_mass_off_the_origin_of_a_thrown_body_is_found(tmp_path: Path, damping: float) -> None:
    """The whole catalogue; along the link or beside it means nothing where the drawing has it at the origin."""
    model = load(model_file(tmp_path, CENTRED.format(damping=0.0, com="0 0 0")))
    made = CENTRED.format(damping="{damping}", com="0.008 0 -0.004")
    found = diagnose(thrown(damping, text=made), model)
    assert found.verdict == "explained"
    damped = {"viscous_damping@root.turn", "viscous_damping@root.shift"} if damping else set()
    assert {f"{f['effect']}@{f['site']}" for f in found.findings} == {"com_displacement@trunk"} | damped
    told = next(f["parameters"] for f in found.findings if f["effect"] == "com_displacement")
    for axis, true in (("x", 0.008), ("y", 0.0), ("z", -0.004)):
        assert abs(told[axis]["value"] - true) < 4.0 * told[axis]["std"]
        assert told[axis]["std"] < 3e-4


@pytest.mark.slow
def test_a_thrown_body_is_damped_in_both_its_motions(tmp_path: Path) -> None:
    model = load(model_file(tmp_path, BOX.format(damping=0.0)))
    found = diagnose(thrown(0.03), model)
    told = {f["site"]: f["parameters"]["coefficient"] for f in found.findings}
    assert {f["effect"] for f in found.findings} == {"viscous_damping"}
    assert told.keys() == {"root.turn", "root.shift"}
    for site, unit in (("root.turn", "N*m*s/rad"), ("root.shift", "N*s/m")):
        assert told[site]["ci95"][0] <= 0.03 <= told[site]["ci95"][1]
        assert told[site]["unit"] == unit


@pytest.mark.slow
def test_a_leg_of_a_body_that_flies_tells_which_of_its_joints_is_damped(tmp_path: Path) -> None:
    """The whole catalogue, at a trunk whose pose is recorded and two joints."""
    found = diagnose(legged(knee=0.01), load(model_file(tmp_path, LEGGED.format(knee=0.0))))
    assert found.verdict == "explained"
    assert [f"{f['effect']}@{f['site']}" for f in found.findings] == ["viscous_damping@knee"]
    told = found.findings[0]["parameters"]["coefficient"]
    assert told["ci95"][0] <= 0.01 <= told["ci95"][1]


@pytest.mark.slow
def test_the_root_of_a_urdf_is_damped_where_it_floats(tmp_path: Path) -> None:
    """MuJoCo has the same body from numbers of its own file; the URDF says nothing of a joint."""
    text = """<mujoco><option timestep="0.0005" integrator="RK4"><flag contact="disable"/></option><worldbody>
    <body name="trunk"><joint name="root" type="free" damping="{damping}"/>
    <inertial pos="0.02 0.01 0" mass="2.3" fullinertia="0.03 0.02 0.04 0.001 0 0"/></body></worldbody></mujoco>"""
    file = tmp_path / "trunk.urdf"
    file.write_text(
        """<robot name="trunk"><link name="root"><inertial><origin xyz="0.02 0.01 0"/><mass value="2.3"/>
        <inertia ixx="0.03" iyy="0.02" izz="0.04" ixy="0.001" ixz="0" iyz="0"/></inertial></link></robot>"""
    )
    found = diagnose(thrown(0.03, text=text, joint="root_joint"), load(file, floating=True), only=LAWS)
    told = {f["site"]: f["parameters"]["coefficient"]["ci95"] for f in found.findings}
    assert {f["effect"] for f in found.findings} == {"viscous_damping"}
    assert told.keys() == {"root_joint.turn", "root_joint.shift"}
    assert all(low <= 0.03 <= high for low, high in told.values())


@pytest.mark.slow
@pytest.mark.parametrize(("text", "made"), [(BALL, hanging), (BOX, thrown)])
def test_what_the_model_foretells_lacks_nothing(tmp_path: Path, text: str, made) -> None:
    found = diagnose(made(0.0), load(model_file(tmp_path, text.format(damping=0.0))))
    assert found.verdict == "consistent"
    assert found.findings == []


def test_a_body_about_its_centre_is_as_large_as_its_inertia_says(tmp_path: Path) -> None:
    text = CENTRED.format(damping=0.0, com="0 0 0").replace("0.01 0.018 0.021 0.001 0 0", "0.009 0.009 0.003 0 0 0")
    system, recordings = in_charts(load(model_file(tmp_path, text)), thrown(0.0, noise=0.0, text=text))
    # A rod of 3 kg with a central inertia of m l² / 12 = 0.009 kg·m² is 0.19 m long.
    assert references(system, "trunk").length == pytest.approx(0.5 * np.sqrt(12.0 * 0.009 / 3.0))
    found = {c.key for c in candidates(system, recordings) if c.site == "trunk"}
    assert found == {"payload_mass@trunk", "com_displacement@trunk"}


def test_a_free_body_falls_in_the_chart_as_it_was_thrown(tmp_path: Path) -> None:
    system, recordings = in_charts(load(model_file(tmp_path, BOX.format(damping=0.0))), thrown(0.0, noise=0.0))
    time = recordings[0].time
    place = {c.site: np.asarray(c.values) for c in recordings[0].channels}
    # A free joint of an MJCF stands where the world does.
    assert [place[f"root.{axis}"][0] for axis in "xyz"] == pytest.approx([0.3, 0.0, 1.0], abs=1e-12)
    assert abs(np.sin(place["root.ry"])).max() < 0.97
    assert np.abs(np.diff(place["root.rx"])).max() < 0.3  # no jumps of a turn
    assert time[-1] == pytest.approx(1.99)
    assert [g.name for g in system.gimbals] == ["root.shift", "root.turn"]


def test_a_chart_is_written_and_read_again(tmp_path: Path) -> None:
    system, _ = in_charts(load(model_file(tmp_path, BALL.format(damping=0.02))), hanging(0.0))
    file = tmp_path / "charted.toml"
    assert write(system, file) == ()
    again = load(file)
    (gimbal,) = again.gimbals
    assert (gimbal.name, gimbal.damping, gimbal.slides) == ("ball", 0.02, False)
    assert gimbal.coordinates == ("ball.rx", "ball.ry", "ball.rz")


def test_what_resists_a_chart_as_a_whole_is_no_urdf(tmp_path: Path) -> None:
    """Damping of each angle is another law than damping of the angular velocity, and no damping is none."""
    resisting, _ = in_charts(load(model_file(tmp_path, BALL.format(damping=0.02))), hanging(0.0))
    with pytest.raises(UnsupportedError, match=r"gimbal 'ball' has damping 0.02 against .* which URDF cannot say"):
        write(resisting, tmp_path / "charted.urdf")
    assert not (tmp_path / "charted.urdf").exists()
    smooth, _ = in_charts(load(model_file(tmp_path, BALL.format(damping=0.0))), hanging(0.0))
    for ending in (".urdf", ".xml"):
        assert "gimbal 'ball': that ball.rx, ball.ry, ball.rz belong together" in write(
            smooth, tmp_path / f"of{ending}"
        )


def test_dry_friction_of_a_chart_as_a_whole_is_no_mjcf(tmp_path: Path) -> None:
    """MuJoCo's friction loss bounds each component by itself."""
    system, _ = in_charts(load(model_file(tmp_path, BALL.format(damping=0.02))), hanging(0.0))
    rubbing = replace(system, gimbals=tuple(replace(g, friction=0.01) for g in system.gimbals))
    with pytest.raises(UnsupportedError, match=r"damping 0.02 and friction 0.01 against .* which MJCF cannot say"):
        write(rubbing, tmp_path / "rubbing.xml")


def test_a_damped_chart_is_written_as_a_ball_that_mujoco_turns_alike(tmp_path: Path) -> None:
    """Origin: MuJoCo's forward dynamics of the model before its ball was taken apart, the body turned and turning alike."""
    import mujoco

    first = model_file(tmp_path, BALL.format(damping=0.02))
    system, _ = in_charts(load(first), hanging(0.0))
    file = tmp_path / "charted.xml"
    assert write(system, file) == ()
    whole, apart = (mujoco.MjModel.from_xml_path(str(path)) for path in (first, file))
    assert (apart.nq, apart.nv, apart.dof_damping.tolist()) == (4, 3, [0.02] * 3)
    body = system.joints[-1].child
    data, expected = mujoco.MjData(apart), mujoco.MjData(whole)
    mujoco.mj_forward(whole, expected)
    unturned = expected.body(body).xmat.reshape(3, 3).copy()
    data.qpos[:] = np.array([0.6, -0.3, 0.5, 0.2]) / np.linalg.norm([0.6, -0.3, 0.5, 0.2])
    data.qvel[:] = (1.1, -0.7, 2.0)
    mujoco.mj_forward(apart, data)
    # The axes of a ball's velocity are those of the body that it carries, to which the drawn one is fastened turned.
    turn = np.asarray(system.joints[-1].rotation).T
    relative = unturned.T @ data.body(body).xmat.reshape(3, 3)
    expected.qpos[:] = np.roll(Rotation.from_matrix(relative).as_quat(), 1)
    expected.qvel[:] = turn @ data.qvel
    mujoco.mj_forward(whole, expected)
    np.testing.assert_allclose(turn @ data.qacc, expected.qacc, rtol=1e-9, atol=1e-9)


def test_a_damped_body_in_space_is_written_as_slides_and_a_ball(tmp_path: Path) -> None:
    """Damping of the velocity as a vector is as much of each of three slides square to one another: 0.05 of all six."""
    import mujoco

    system, _ = in_charts(load(model_file(tmp_path, BOX.format(damping=0.05))), thrown(0.0))
    file = tmp_path / "charted.xml"
    assert write(system, file) == ("gimbal 'root.shift': that root.x, root.y, root.z belong together",)
    model = mujoco.MjModel.from_xml_path(str(file))
    assert (model.nq, model.nv, model.dof_damping.tolist()) == (7, 6, [0.05] * 6)


def test_a_quaternion_without_length_is_refused(tmp_path: Path) -> None:
    system = load(model_file(tmp_path, BALL.format(damping=0.0)))
    bad = recording(
        "bad", np.arange(60) / 100.0, {("ball", f"pose.{name}"): np.zeros(60) for name in QUATERNION}, 0.0, 0
    )
    with pytest.raises(InputError, match="length zero"):
        in_charts(system, [bad])


def test_a_pose_without_its_quaternion_is_refused(tmp_path: Path) -> None:
    system = load(model_file(tmp_path, BOX.format(damping=0.0)))
    place = recording("place", np.arange(60) / 100.0, {("root", f"pose.{name}"): np.ones(60) for name in "xyz"}, 0.0, 0)
    with pytest.raises(InputError, match="no qw of the pose"):
        in_charts(system, [place])


def test_rotations_that_no_chart_holds_are_refused(tmp_path: Path) -> None:
    system = load(model_file(tmp_path, BALL.format(damping=0.0)))
    q = np.random.default_rng(1).standard_normal((4, 4000))
    q /= np.linalg.norm(q, axis=0)
    wild = recording(
        "wild", np.arange(4000) / 100.0, {("ball", f"pose.{name}"): q[k] for k, name in enumerate(QUATERNION)}, 0.0, 0
    )
    with pytest.raises(UnsupportedError, match="every way"):
        in_charts(system, [wild])


def test_what_does_not_turn_at_all_is_no_mismatch(tmp_path: Path) -> None:
    """Angles of a fall without spin, computed without noise, are rounding of either engine."""
    text = BOX.replace('euler="0 30 0"', "").format(damping=0.0)
    out = []
    for k, v in enumerate(((0.5, 1.0, 6.0), (-1.0, 0.4, 7.0))):
        time, found = motion(text, (), (*v, 0.0, 0.0, 0.0), 2.0)
        columns = {("root", f"pose.{name}"): found[:, j] for j, name in enumerate(("x", "y", "z", *QUATERNION))}
        out.append(recording(f"run{k}", time, columns, 0.0, k))
    found = diagnose(out, load(model_file(tmp_path, text)), only=LAWS)
    assert found.verdict == "consistent"
    assert not found.findings
