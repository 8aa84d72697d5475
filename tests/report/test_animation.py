"""A mechanism in motion: points where the joints are, seen from the side, played in a browser and in MuJoCo's viewer."""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path

import numpy as np
import pytest
from diagnosed import curves, document, swing

import harness
from harness.cli.main import status_of
from harness.report.animation import Motion, scene, skeleton
from harness.report.animation.beside import beside
from harness.report.animation.scene import seen
from harness.report.diagnosis.page import diagnosis_html
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

MODELS = Path(__file__).parents[2] / "models"
LONG, SHORT = 0.4, 0.25  # m, of the two links below


def double() -> System:
    """Two rods that hang along −z and turn about y."""
    rod = [
        Link(name, 0.2, constant([0.0, 0.0, -c]), constant(np.diag([1e-3, 1e-3, 1e-5])))
        for name, c in (("upper", 0.2), ("lower", SHORT))
    ]
    joints = (
        Joint("shoulder", JointType.REVOLUTE, "base", "upper", axis=constant([0.0, 1.0, 0.0])),
        Joint(
            "elbow",
            JointType.REVOLUTE,
            "upper",
            "lower",
            axis=constant([0.0, 1.0, 0.0]),
            xyz=constant([0.0, 0.0, -LONG]),
        ),
    )
    return System("double", joints, tuple(rod))


def test_points_are_where_trigonometry_has_them():
    first, second = np.array([0.0, 0.3, -1.2]), np.array([0.0, 0.5, 2.0])
    bones = skeleton(double())
    points = bones.points({"shoulder": first, "elbow": second})
    # Turned by +a about y, what hangs along −z goes to (−sin a, 0, −cos a).
    elbow = LONG * np.stack([-np.sin(first), 0.0 * first, -np.cos(first)], axis=-1)
    both = first + second
    tip = elbow + SHORT * np.stack([-np.sin(both), 0.0 * both, -np.cos(both)], axis=-1)
    assert np.allclose(points[:, 0], 0.0, atol=1e-12)
    assert np.allclose(points[:, 1], elbow, atol=1e-12)
    assert np.allclose(points[:, 2], tip, atol=1e-12)
    assert bones.edges.tolist() == [[0, 1], [1, 2]]


def test_a_wheel_has_a_spoke_that_turns():
    joint = Joint("axle", JointType.REVOLUTE, "base", "wheel", axis=constant([0.0, 0.0, 1.0]))
    wheel = System("wheel", (joint,), (Link("wheel", 1.0, constant([0.0, 0.0, 0.0]), constant(np.eye(3) * 0.01)),))
    points = skeleton(wheel).points({"axle": np.array([0.0, np.pi / 2])})
    spokes = points[:, 1] - points[:, 0]
    assert np.linalg.norm(spokes[0]) > 0.1 and abs(spokes[0] @ spokes[1]) < 1e-12


def test_gravity_is_down_and_the_swing_is_across():
    rng = np.random.default_rng(1)
    points = np.stack(
        [0.1 * rng.standard_normal(200), 3.0 * rng.standard_normal(200), 5.0 * rng.standard_normal(200)], axis=1
    )
    right, up = seen(points, np.array([0.0, 0.0, -9.81]))
    assert np.allclose(up, [0.0, 0.0, 1.0])
    assert abs(right[1]) > 0.99 and right @ up == pytest.approx(0.0, abs=1e-12)
    right, up = seen(np.zeros((4, 3)) + [[0.0, 0.0, z] for z in range(4)], np.array([0.0, 0.0, -9.81]))
    assert np.isfinite(right).all() and np.linalg.norm(right) == pytest.approx(1.0)


def test_a_scene_has_thirty_frames_a_second():
    time = np.linspace(0.0, 2.0, 401)
    made = scene(double(), time, [Motion("one", "ink", {"shoulder": time, "elbow": 0.0 * time})], "t")
    assert len(made.time) == 61 and np.allclose(np.diff(made.time), 1.0 / 30.0)
    told = json.loads(re.search(r"<script[^>]*>(.*?)</script>", str(made.html()), re.S).group(1))
    points = np.frombuffer(base64.b64decode(told["motions"][0]["points"]), "<f4").reshape(61, 3, 2)
    # The elbow at the last frame, 2 s: turned by 2 rad; half a unit in the last of 24 bits.
    assert np.allclose(np.abs(points[-1, 1]), np.abs([LONG * np.sin(2.0), -LONG * np.cos(2.0)]), rtol=1e-6)


def test_the_simulation_begins_as_the_recording_does(tmp_path):
    from harness.recording import read_recording

    file = tmp_path / "run.csv"
    time = np.arange(200) / 200.0
    rows = "\n".join(f"{t:.3f},{0.3 + 0.7 * t:.9f},0" for t in time)
    file.write_text("time,shoulder.position,elbow.position\n" + rows + "\n", encoding="utf-8")
    at, motions, told = beside(double(), read_recording(file, system=double()), {}, {}, 0.2, "denoc")
    simulated = motions[0].positions["shoulder"]
    assert at[-1] <= 0.2 and told == ()
    assert simulated[0] == pytest.approx(0.3, abs=1e-9)
    assert (simulated[1] - simulated[0]) / (at[1] - at[0]) == pytest.approx(
        0.7, abs=0.2
    )  # 40 rad/s² at most, over 5 ms


def test_the_page_of_a_view(tmp_path, capfd):
    out = tmp_path / "view.html"
    assert status_of(["view", str(MODELS / "urdf" / "double_pendulum.urdf"), "--duration", "1", "--out", str(out)]) == 0
    page = out.read_text(encoding="utf-8")
    assert 'class="animation"' in page and not re.findall(r"""(?:src|href)\s*=\s*["'](?!#)""", page)
    assert status_of(["view", str(MODELS / "urdf" / "double_pendulum.urdf"), "--out", str(tmp_path / "view.gif")]) == 2
    assert "use .html" in capfd.readouterr().err


def test_without_a_screen_the_viewer_says_what_to_do(monkeypatch, capfd):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert status_of(["view", str(MODELS / "urdf" / "double_pendulum.urdf"), "--duration", "0.1"]) == 2
    assert "no screen" in capfd.readouterr().err


def test_the_viewer_gets_a_capsule_for_every_line():
    mujoco = pytest.importorskip("mujoco")
    from harness.report.animation.viewer import joint_addresses, lines, shown_model

    system = harness.load(MODELS / "mjcf" / "double_pendulum.xml")
    bones = skeleton(system)
    joints = system.joint_names
    motions = [
        Motion("a", "#0a7bbd", {j: np.array([0.4]) for j in joints}),
        Motion("b", "ink", {j: np.array([0.1]) for j in joints}),
    ]
    points = [bones.points(m.positions)[0] for m in motions]
    model = shown_model(system)
    drawn = mujoco.MjvScene(model, maxgeom=100)
    lines(drawn, bones, points, motions)
    assert drawn.ngeom == 2 * len(bones.edges)
    # A capsule's middle is the middle of its line.
    first, last = bones.edges[0]
    assert np.allclose(drawn.geoms[0].pos, 0.5 * (points[0][first] + points[0][last]), atol=1e-6)
    assert list(joint_addresses(model, motions[0])) == list(joints)


def test_a_report_moves_only_where_every_joint_is_measured():
    one = harness.load(MODELS / "urdf" / "rigid_pendulum.urdf")
    assert 'class="animation"' in diagnosis_html(document(), curves(), one)
    assert 'class="animation"' not in diagnosis_html(
        document(), curves(), harness.load(MODELS / "urdf" / "double_pendulum.urdf")
    )
    assert 'class="animation"' not in diagnosis_html(document(), curves())


def test_what_is_measured_moves_as_measured():
    one = harness.load(MODELS / "urdf" / "rigid_pendulum.urdf")
    page = diagnosis_html(document(), curves(), one)
    figure = page[page.index('class="animation"') :]
    told = json.loads(re.search(r"<script[^>]*>(.*?)</script>", figure, re.S).group(1))
    motion = next(m for m in told["motions"] if m["label"] == "measured")
    time = np.frombuffer(base64.b64decode(told["time"]), "<f4")
    points = np.frombuffer(base64.b64decode(motion["points"]), "<f4").reshape(len(time), -1, 2)
    angle = np.arctan2(np.abs(points[:, 1, 0]), -points[:, 1, 1])
    assert np.allclose(angle, np.abs(swing(time)), atol=1e-3)  # read between samples 2 ms apart
