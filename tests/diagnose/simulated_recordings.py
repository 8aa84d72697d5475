"""Recordings for the tests of diagnosis, made without the native dynamics.

A single pendulum obeys one textbook equation (Goldstein, Classical Mechanics, ch. 3), integrated here by SciPy with dry
friction's reversals located as events; longer chains are integrated by MuJoCo.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from harness.recording import Channel, Recording
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

# An arm on a geared servo, which damps and rubs.
ARM = """
name = "arm"
gravity = [0.0, 0.0, -9.81]
tolerance = 0.01
[[joint]]
name = "servo"
type = "revolute"
parent = "base"
child = "arm"
axis = [0, 1, 0]
armature = 0.01
damping = 0.05
friction = 0.02
[[link]]
name = "arm"
mass = 0.55
com = [0.0, 0.0, -0.14]
inertia = [1e-3, 1e-3, 1e-3, 0, 0, 0]
end = [0.0, 0.0, -0.15]
"""

GRAVITY = 9.81
MASS, COM, INERTIA = 0.3, 0.25, 0.003


@dataclass(frozen=True)
class Rig:
    """The true pendulum: data-sheet values times what the maker got wrong, and what is hidden."""

    mass: float = MASS
    com: float = COM
    inertia: float = INERTIA
    viscous: float = 0.0
    drag: float = 0.0
    dry: float = 0.0
    torque: Callable[[float, float, float], float] = lambda t, q, v: 0.0

    @property
    def about_joint(self) -> float:
        return self.inertia + self.mass * self.com**2

    @property
    def moment(self) -> float:
        return self.mass * GRAVITY * self.com


def nominal(tolerance: float = 0.01) -> System:
    """The model that diagnosis is given: one rod on one joint, hanging along -z."""
    joint = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0.0, 1.0, 0.0]))
    link = Link("rod", MASS, constant([0.0, 0.0, -COM]), constant(np.diag([INERTIA, INERTIA, 1e-9])))
    return System("pendulum", (joint,), (link,), tolerance=tolerance)


def swing(rig: Rig, angle: float, time: np.ndarray, effort: Callable[[float], float] = lambda t: 0.0) -> np.ndarray:
    """Positions (T,) of the pendulum released at rest; it stays where dry friction holds it."""
    inertia, moment = rig.about_joint, rig.moment

    def push(t: float, q: float, v: float) -> float:
        return effort(t) + rig.torque(t, q, v) - moment * np.sin(q)

    out = np.empty(len(time))
    t, q, v, filled = float(time[0]), angle, 0.0, 0
    while filled < len(time):
        hold = push(t, q, 0.0)
        if rig.dry > 0.0 and abs(hold) <= rig.dry:
            out[filled:] = q  # only free swings are made with dry friction, so rest is for good
            return out
        sense = float(np.sign(v) or np.sign(hold))

        def rate(s: float, y: np.ndarray, sense: float = sense) -> list[float]:
            w = y[1]
            force = push(s, y[0], w) - rig.viscous * w - rig.drag * w * abs(w) - sense * rig.dry
            return [w, force / inertia]

        def turn(s: float, y: np.ndarray, sense: float = sense) -> float:
            return float(sense * y[1])

        turn.terminal, turn.direction = True, -1
        found = solve_ivp(
            rate, (t, float(time[-1]) + 1e-9), [q, v], method="DOP853", rtol=1e-10, atol=1e-12, dense_output=True,
            events=turn if rig.dry > 0.0 else None, max_step=0.1,
        )  # fmt: skip
        upto = int(np.searchsorted(time, found.t[-1], side="right"))
        out[filled:upto] = found.sol(time[filled:upto])[0]
        filled = upto
        t, q, v = float(found.t[-1]), float(found.y[0, -1]), 0.0
    return out


def passed_slowly(signal: np.ndarray, step: float, cutoff: float) -> np.ndarray:
    """First-order low-pass [Hz] of straight lines between samples ``step`` [s] apart, settled on the first one; exact for them."""
    turn = 2.0 * np.pi * cutoff * step
    decay, mean = np.exp(-turn), -np.expm1(-turn) / turn
    return np.asarray(lfilter([1.0 - mean, mean - decay], [1.0, -decay], signal, zi=[mean * signal[0]])[0])


def recording(name: str, time: np.ndarray, columns: dict[str, np.ndarray], *, linear: bool = False) -> Recording:
    """A recording from columns named ``site.quantity``; linear: of joints that slide."""
    turning = {"position": "rad", "velocity": "rad/s", "effort": "N*m"}
    units = {"position": "m", "velocity": "m/s", "effort": "N"} if linear else turning
    channels = []
    for column, values in columns.items():
        site, quantity = column.rsplit(".", 1)
        channels.append(Channel(column, site, quantity, units[quantity], constant(values)))
    return Recording(
        name, name, constant(time - time[0]), tuple(c for c in channels if c.quantity != "effort"),
        tuple(c for c in channels if c.quantity == "effort"),
    )  # fmt: skip


def released_in_mujoco(
    model: mujoco.MjModel, angles: Sequence[float], time: np.ndarray, *, noise: float, seed: int
) -> list[Recording]:
    """Recordings of MuJoCo's own steps from rest at each angle of the joint ``pivot``, as many steps a sample as fit."""
    rng = np.random.default_rng(seed)
    steps = round((time[1] - time[0]) / model.opt.timestep)
    out = []
    for k, angle in enumerate(angles):
        data = mujoco.MjData(model)
        data.qpos[0] = angle
        rows = []
        for _ in time:
            rows.append(data.qpos[0])
            mujoco.mj_step(model, data, nstep=steps)
        noisy = np.array(rows) + noise * rng.standard_normal(len(time))
        out.append(recording(f"run{k}", time, {"pivot.position": noisy}))
    return out


def releases(
    rig: Rig, angles: tuple[float, ...], noise: float, seed: int, *, duration: float = 12.0, rate: float = 100.0
) -> list[Recording]:
    """One recording of a free swing for each release angle, with white noise [rad] on the angle."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, duration, 1.0 / rate)
    return [
        recording(f"run{k}", time, {"pivot.position": swing(rig, angle, time) + noise * rng.standard_normal(len(time))})
        for k, angle in enumerate(angles)
    ]


def double_pendulum(elbow_damping: float, noise: float, seed: int) -> tuple[System, list[Recording]]:
    """A double pendulum whose elbow is damped in truth and not in the model; motion by MuJoCo's RK4 at 1 ms."""
    joints = (
        Joint("shoulder", JointType.REVOLUTE, "base", "upper", axis=constant([0.0, 1.0, 0.0])),
        Joint(
            "elbow", JointType.REVOLUTE, "upper", "lower", xyz=constant([0, 0, -0.3]), axis=constant([0.0, 1.0, 0.0])
        ),
    )
    inertia = constant(np.diag([0.002, 0.002, 1e-9]))
    links = tuple(Link(name, 0.3, constant([0.0, 0.0, -0.15]), inertia) for name in ("upper", "lower"))
    xml = f"""<mujoco><option integrator="RK4" timestep="0.001" gravity="0 0 -{GRAVITY}"><flag contact="disable"/></option>
      <compiler angle="radian" boundinertia="0"/><worldbody><body><joint name="shoulder" axis="0 1 0"/>
      <inertial pos="0 0 -0.15" mass="0.3" diaginertia="0.002 0.002 1e-9"/>
      <body pos="0 0 -0.3"><joint name="elbow" axis="0 1 0" damping="{elbow_damping}"/>
      <inertial pos="0 0 -0.15" mass="0.3" diaginertia="0.002 0.002 1e-9"/></body></body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(xml.replace('balanceinertia="true"', ""))
    rng = np.random.default_rng(seed)
    out = []
    for k, start in enumerate(((0.5, -0.3), (-0.4, 0.5))):
        data = mujoco.MjData(model)
        data.qpos[:] = start
        rows = []
        for step in range(8000):
            if step % 10 == 0:
                rows.append(data.qpos.copy())
            mujoco.mj_step(model, data)
        q = np.array(rows) + noise * rng.standard_normal((len(rows), 2))
        out.append(
            recording(f"run{k}", 0.01 * np.arange(len(q)), {"shoulder.position": q[:, 0], "elbow.position": q[:, 1]})
        )
    return System("double", joints, links), out
