"""Motions in MuJoCo's own viewer: the model as it is, and every motion as lines in its colour."""

from __future__ import annotations

import os
import sys
import time as clock
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.compiled_packages import loaded
from harness.engines.mujoco_model import mujoco_model
from harness.errors import InputError, cannot_be_loaded
from harness.report.animation.scene import Motion, seen
from harness.report.animation.skeleton import Skeleton, skeleton
from harness.system import System

Array = NDArray[np.float64]

COLOURS = {"ink": (0.95, 0.96, 0.98, 1.0)}  # the viewer's background is dark
THICK, THIN = 0.02, 0.008  # of the mechanism's extent: radius of the first motion's lines and of the last one's
FRAME = 1.0 / 60.0  # s
LIGHT, GLOW = 0.4, 0.5  # ambient light of a model that may have no lamp, and emission of the lines
AWAY = 2.2  # of the motion's extent: how far the camera stands


def view(system: System, time: Array, motions: Sequence[Motion]) -> None:
    """Play the motions over and over until the window is closed.

    time: [s], shape (T,); the model itself moves as the last motion does.
    Raises InputError where there is no screen, EngineUnavailableError where MuJoCo is not installed.
    """
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise InputError("there is no screen to open MuJoCo's viewer on", mend="write a page instead: --out view.html")
    try:
        mujoco = loaded("mujoco", "mujoco.viewer")
    except ImportError as error:
        raise cannot_be_loaded("MuJoCo", error, "pip install mujoco") from None
    model = shown_model(system)
    model.vis.headlight.ambient[:] = np.maximum(model.vis.headlight.ambient, LIGHT)
    data = mujoco.MjData(model)
    bones = skeleton(system)
    points = [bones.points(motion.positions) for motion in motions]
    addresses = joint_addresses(model, motions[-1])
    with mujoco.viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False) as window:
        look_at(window.cam, np.concatenate([p.reshape(-1, 3) for p in points]), np.asarray(system.gravity))
        begun = clock.monotonic()
        while window.is_running():
            now = time[0] + (clock.monotonic() - begun) % max(time[-1] - time[0], FRAME)
            at = min(int(np.searchsorted(time, now)), len(time) - 1)
            for joint, place in addresses.items():
                data.qpos[place] = motions[-1].positions[joint][at]
            mujoco.mj_forward(model, data)
            with window.lock():
                lines(window.user_scn, bones, [p[at] for p in points], motions)
            window.sync()
            clock.sleep(FRAME)


def shown_model(system: System) -> Any:
    """The user's own MJCF with its shapes and lights, if it is one; else the model as the engine builds it."""
    import mujoco

    if system.source is not None and system.source.suffix.lower() == ".xml":
        try:
            return mujoco.MjModel.from_xml_path(str(system.source))
        except ValueError:
            pass  # a URDF under another name, or meshes that are not there
    return mujoco_model(system)


def look_at(camera: Any, points: Array, gravity: Array) -> None:
    """Put a camera where the motion is seen from the side; points: shape (N, 3) [m]."""
    every = np.vstack([points, np.zeros((1, 3))])
    right, up = seen(every, gravity)
    forward = np.cross(up, right)
    camera.lookat[:] = 0.5 * (every.min(axis=0) + every.max(axis=0))
    camera.distance = AWAY * max(float(np.ptp(every, axis=0).max()), 1e-3)
    camera.azimuth = float(np.degrees(np.arctan2(forward[1], forward[0])))
    camera.elevation = -8.0


def joint_addresses(model: Any, motion: Motion) -> dict[str, int]:
    """Where the positions of joints stand in ``qpos``, of joints that the model knows by name."""
    import mujoco

    found = {}
    for name in motion.positions:
        joint = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
        if joint >= 0:
            found[name] = int(model.jnt_qposadr[joint])
    return found


def lines(scene: Any, bones: Skeleton, points: Sequence[Array], motions: Sequence[Motion]) -> None:
    """Fill an ``MjvScene`` with a capsule for every edge of every motion; points: by motion, shape (K, 3) [m]."""
    import mujoco

    extent = max(float(np.ptp(np.vstack([*points, np.zeros((1, 3))]), axis=0).max()), 1e-3)
    scene.ngeom = 0
    for k, (place, motion) in enumerate(zip(points, motions, strict=True)):
        radius = extent * (THICK + (THIN - THICK) * k / max(len(motions) - 1, 1))
        for first, last in bones.edges:
            if scene.ngeom >= scene.maxgeom:
                return
            geom = scene.geoms[scene.ngeom]
            colour = np.array(rgba(motion.colour), dtype=np.float32)
            mujoco.mjv_initGeom(
                geom, mujoco.mjtGeom.mjGEOM_CAPSULE, np.zeros(3), np.zeros(3), np.zeros(9), colour
            )  # fmt: skip
            mujoco.mjv_connector(geom, mujoco.mjtGeom.mjGEOM_CAPSULE, radius, place[first], place[last])
            geom.emission = GLOW
            scene.ngeom += 1


def rgba(colour: str) -> tuple[float, float, float, float]:
    """A CSS colour of six digits, or "ink", as MuJoCo has it."""
    if colour in COLOURS:
        return COLOURS[colour]
    red, green, blue = (int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
    return red, green, blue, 0.85
