"""Recordings of closed mechanisms and of bodies in space, made by MuJoCo from its own files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np

from harness.recording import Channel, Recording
from harness.recording.recording import SPATIAL_UNITS

RATE = 100.0  # Hz

BALL = """<mujoco><option timestep="0.0005" integrator="RK4"><flag contact="disable"/></option><worldbody>
<body name="bob" pos="0 0 1"><joint name="ball" type="ball" damping="{damping}"/>
<geom type="capsule" fromto="0 0 0 0.02 0 -0.5" size="0.02" mass="1"/>
<geom type="box" pos="0.05 0 -0.45" size="0.06 0.02 0.02" mass="0.3"/></body></worldbody></mujoco>"""

BOX = """<mujoco><option timestep="0.0005" integrator="RK4"><flag contact="disable"/></option><worldbody>
<body name="trunk" pos="0.3 0 1" euler="0 30 0"><joint name="root" type="free" damping="{damping}"/>
<geom type="box" size="0.1 0.2 0.05" mass="2"/>
<geom type="box" pos="0.1 0.05 0" size="0.03 0.02 0.02" mass="0.3"/></body></worldbody></mujoco>"""

# A body whose drawing puts its centre of mass at its origin.
CENTRED = """<mujoco><option timestep="0.0005" integrator="RK4"><flag contact="disable"/></option><worldbody>
<body name="trunk" pos="0 0 1"><joint name="root" type="free" damping="{damping}"/>
<inertial pos="{com}" mass="3" fullinertia="0.01 0.018 0.021 0.001 0 0"/></body></worldbody></mujoco>"""

# Base 0.5 m, crank 0.3 m, coupler 0.5 m, rocker 0.35 m, gravity along -y. Dry friction is MuJoCo's soft constraint: with its usual
# time constant of 20 ms it gives way by 2.6 mrad of the crank, five times the noise; with 0.2 ms (twice the step) by 0.027 mrad.
FOUR_BAR = """<mujoco><option timestep="0.0001" integrator="RK4" gravity="0 -9.81 0"><flag contact="disable"/></option>
<compiler angle="radian"/><worldbody>
<body name="short"><joint name="crank" axis="0 0 1" damping="{crank}"/>
 <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.01" mass="0.3"/>
 <body name="coupler" pos="0.3 0 0"><joint name="pin" axis="0 0 1" damping="{pin}" stiffness="{spring}"/>
  <geom type="capsule" fromto="0 0 0 0.5 0 0" size="0.01" mass="0.5"/><site name="a" pos="0.5 0 0"/></body></body>
<body name="long" pos="0.5 0 0"><joint name="rocker" axis="0 0 1" damping="{rocker}" frictionloss="{dry}"
  solreffriction="0.0002 1" solimpfriction="0.9999 0.9999 0.001"/>
 <geom type="capsule" fromto="0 0 0 0 -0.35 0" size="0.01" mass="0.4"/><site name="b" pos="0 -0.35 0"/></body>
</worldbody>{closing}</mujoco>"""
CLOSED = (
    """<equality><connect name="knee" site1="a" site2="b" solref="0.001 1" solimp="0.9999 0.9999 0.001"/></equality>"""
)
# The same four-bar cut where the rocker hangs on the base: where FOUR_BAR is cut there is a joint.
CUT_ELSEWHERE = """<mujoco><option timestep="0.0001" integrator="RK4" gravity="0 -9.81 0"><flag contact="disable"/></option>
<compiler angle="radian"/><worldbody><site name="c" pos="0.5 0 0"/>
<body name="short"><joint name="crank" axis="0 0 1"/><geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.01" mass="0.3"/>
 <body name="coupler" pos="0.3 0 0"><joint name="pin" axis="0 0 1"/>
  <geom type="capsule" fromto="0 0 0 0.5 0 0" size="0.01" mass="0.5"/>
  <body name="long" pos="0.5 0 0"><joint name="knee" axis="0 0 1" damping="{knee}"/>
   <geom type="capsule" fromto="0 0 0 0 0.35 0" size="0.01" mass="0.4"/><site name="d" pos="0 0.35 0"/></body></body></body>
</worldbody>
<equality><connect name="rocker" site1="d" site2="c" solref="0.001 1" solimp="0.9999 0.9999 0.001"/></equality></mujoco>"""
# A rope of that length between the two ends: within it they go free of each other.
ROPE = """<tendon><spatial limited="true" range="-1 {gap}" solreflimit="0.0008 1" solimplimit="0.9999 0.9999 0.0001">
<site site="a"/><site site="b"/></spatial></tendon>"""
# Crank 0.2 m, rod 0.5 m, from the middle of the slide along x; stretched at zero.
SLIDER_CRANK = """<mujoco><option timestep="0.0002" integrator="RK4" gravity="{gravity}"><flag contact="disable"/></option>
<worldbody>
<body name="short"><joint name="crank" axis="0 1 0" damping="{crank}"/>
 <geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.01" mass="0.3"/>
 <body name="rod" pos="0.2 0 0"><joint name="pin" axis="0 1 0" damping="{pin}"/>
  <geom type="capsule" fromto="0 0 0 0.5 0 0" size="0.01" mass="0.5"/><site name="a" pos="0.5 0 0"/></body></body>
<body name="piston" pos="0.7 0 0"><joint name="slide" type="slide" axis="1 0 0" damping="{slide}"/>
 <geom type="box" size="0.03 0.03 0.03" mass="0.4"/><site name="b"/></body></worldbody>
<equality><connect name="wrist" site1="a" site2="b" solref="0.001 1" solimp="0.9999 0.9999 0.001"/></equality></mujoco>"""
# Two cranks of 0.2 m on a base of 0.4 m, and two rods of 0.3 m from them to where they meet, below. Where the file places it the
# rods are stretched and do not meet.
FIVE_BAR = """<mujoco><option timestep="0.0001" integrator="RK4" gravity="0 -9.81 0"><flag contact="disable"/></option>
<compiler angle="radian"/><worldbody>
<body name="one"><joint name="left" axis="0 0 1"/><geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.01" mass="0.25"/>
 <body name="two" pos="0.2 0 0"><joint name="elbow" axis="0 0 1" damping="{elbow}" frictionloss="{dry}"
  solreffriction="0.0002 1" solimpfriction="0.9999 0.9999 0.001"/>
  <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.01" mass="0.35"/><site name="a" pos="0.3 0 0"/></body></body>
<body name="three" pos="0.4 0 0"><joint name="right" axis="0 0 1"/>
 <geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.01" mass="0.25"/>
 <body name="four" pos="0.2 0 0"><joint name="other" axis="0 0 1"/>
  <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.01" mass="0.35"/><site name="b" pos="0.3 0 0"/></body></body></worldbody>
<equality><connect name="tip" site1="a" site2="b" solref="0.001 1" solimp="0.9999 0.9999 0.001"/></equality></mujoco>"""
# A trunk that flies, and a leg with springs at both its joints.
LEGGED = """<mujoco><option timestep="0.0005" integrator="RK4"><flag contact="disable"/></option>
<compiler angle="radian"/><worldbody>
<body name="trunk" pos="0 0 1"><joint name="root" type="free"/><geom type="box" size="0.15 0.1 0.04" mass="2.5"/>
 <body name="thigh" pos="0.15 0.1 0"><joint name="hip" axis="0 1 0" stiffness="3"/>
  <geom type="capsule" fromto="0 0 0 0 0 -0.2" size="0.02" mass="0.4"/>
  <body name="shank" pos="0 0 -0.2"><joint name="knee" axis="0 1 0" stiffness="2" springref="0.3" damping="{knee}"/>
   <geom type="capsule" fromto="0 0 0 0 0 -0.2" size="0.015" mass="0.25"/></body></body></body></worldbody></mujoco>"""
NOTHING = {"crank": 0.0, "pin": 0.0, "rocker": 0.0, "dry": 0.0, "spring": 0.0}
# Where the loop is closed: crank, pin, rocker [rad], by the law of cosines.
STARTS = (-0.9, -2.3)


def closed(crank: float) -> tuple[float, float, float]:
    """Angles of crank, pin and rocker where the coupler's end meets the rocker's below the base, by the law of cosines."""
    elbow = 0.3 * np.array([np.cos(crank), np.sin(crank)])
    away = np.array([0.5, 0.0]) - elbow
    distance = float(np.hypot(*away))
    corner = np.arccos((distance**2 + 0.5**2 - 0.35**2) / (2.0 * distance * 0.5))
    coupler = np.arctan2(away[1], away[0]) - corner
    end = elbow + 0.5 * np.array([np.cos(coupler), np.sin(coupler)]) - np.array([0.5, 0.0])
    rocker = np.arctan2(end[1], end[0]) + np.pi / 2.0
    return crank, coupler - crank, float(np.mod(rocker + np.pi, 2.0 * np.pi) - np.pi)


def mounted(crank: float) -> tuple[float, float, float]:
    """Crank, pin and slide of the slider-crank, the crank that far below its stretched place [rad]."""
    rod = -np.arcsin(0.2 * np.sin(crank) / 0.5)
    return crank, float(rod - crank), float(0.2 * np.cos(crank) + 0.5 * np.cos(rod) - 0.7)


def met(left: float, right: float) -> tuple[float, float, float, float]:
    """Angles of the five-bar's joints where its rods meet below its cranks [rad], by the law of cosines."""
    elbows = np.array([[0.2 * np.cos(q) + x, 0.2 * np.sin(q)] for q, x in ((left, 0.0), (right, 0.4))])
    between = elbows[1] - elbows[0]
    half = 0.5 * float(np.hypot(*between))
    down = np.array([between[1], -between[0]]) / (2.0 * half)
    end = elbows.mean(axis=0) + np.sqrt(0.3**2 - half**2) * down
    first, second = (float(np.arctan2(y, x)) for x, y in end - elbows)
    one, other = (float(np.mod(a + np.pi, 2.0 * np.pi) - np.pi) for a in (first - left, second - right))
    return left, one, right, other


def five_bar(seconds: float = 4.0, **hidden: float) -> list[Recording]:
    """Three recordings of the five-bar's cranks, let go."""
    text = FIVE_BAR.format(**{"elbow": 0.0, "dry": 0.0} | hidden)
    out = []
    for k, cranks in enumerate(((-1.9, -1.2), (-1.2, -0.8), (-2.1, -1.6))):
        time, q = motion(text, met(*cranks), np.zeros(4), seconds)
        out.append(recording(f"run{k}", time, {("left", "position"): q[:, 0], ("right", "position"): q[:, 2]}, 5e-4, k))
    return out


def legged(seconds: float = 2.0, knee: float = 0.0) -> list[Recording]:
    """Three recordings of the trunk's pose and the leg's joints, thrown."""
    thrown = (
        ((0.5, 1.0, 6.0), (1.0, 2.0, 1.0), (0.3, -0.5), (1.5, -1.0)),
        ((-1.0, 0.4, 7.0), (2.0, -1.0, 1.5), (-0.4, 0.5), (-1.0, 2.0)),
        ((0.2, -0.4, 6.5), (-1.0, 1.5, 2.0), (0.5, 0.2), (0.5, -1.5)),
    )
    out = []
    for k, (v, w, joints, rates) in enumerate(thrown):
        time, q = motion(LEGGED.format(knee=knee), (0, 0, 1, 1, 0, 0, 0, *joints), (*v, *w, *rates), seconds)
        pose = ("x", "y", "z", "qw", "qx", "qy", "qz")
        columns = {("root", f"pose.{name}"): q[:, j] for j, name in enumerate(pose)}
        columns |= {(name, "position"): q[:, 7 + j] for j, name in enumerate(("hip", "knee"))}
        out.append(recording(f"run{k}", time, columns, 5e-4, k))
    return out


def four_bar_cut_elsewhere(knee: float, seconds: float = 5.0) -> list[Recording]:
    """Two recordings of the crank of the four-bar, damped where ``FOUR_BAR`` has no joint."""
    out = []
    for k, angle in enumerate(STARTS):
        crank, pin, rocker = closed(angle)
        # The rocker's own angle is the sum of the three.
        time, q = motion(CUT_ELSEWHERE.format(knee=knee), (crank, pin, rocker - crank - pin), np.zeros(3), seconds)
        out.append(recording(f"run{k}", time, {("crank", "position"): q[:, 0]}, 5e-4, k))
    return out


def model_file(folder: Path, text: str) -> Path:
    path = folder / "model.xml"
    path.write_text(text, encoding="utf-8")
    return path


def motion(
    text: str, position: Sequence[float], velocity: Sequence[float], seconds: float
) -> tuple[np.ndarray, np.ndarray]:
    """Time (T,) and positions (T, nq)."""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    if len(position):
        data.qpos[:] = position
    data.qvel[:] = velocity
    steps = round(1.0 / RATE / model.opt.timestep)
    found = np.empty((round(seconds * RATE), model.nq))
    for row in found:
        row[:] = data.qpos
        mujoco.mj_step(model, data, nstep=steps)
    return np.arange(len(found)) / RATE, found


def recording(
    name: str, time: np.ndarray, columns: dict[tuple[str, str], np.ndarray], noise: float, seed: int
) -> Recording:
    """Columns by site and quantity, with white noise."""
    rng = np.random.default_rng(seed)
    channels = tuple(
        Channel(
            f"{site}.{quantity}",
            site,
            quantity,
            SPATIAL_UNITS.get(quantity, "rad"),
            values + noise * rng.standard_normal(len(values)),
        )
        for (site, quantity), values in columns.items()
    )
    return Recording(name, name, time, channels)


def four_bar(
    seconds: float = 5.0, closing: str = CLOSED, seen: str = "crank", step: str = "0.0001",
    starts: Sequence[float] = STARTS, **hidden: float,
) -> list[Recording]:  # fmt: skip
    """Two recordings of one joint of the four-bar, let go at these angles of the crank [rad]."""
    text = FOUR_BAR.format(**NOTHING | hidden, closing=closing).replace('timestep="0.0001"', f'timestep="{step}"')
    out = []
    for k, crank in enumerate(starts):
        time, q = motion(text, closed(crank), np.zeros(3), seconds)
        place = ("crank", "pin", "rocker").index(seen)
        out.append(recording(f"run{k}", time, {(seen, "position"): q[:, place]}, 5e-4, k))
    return out
