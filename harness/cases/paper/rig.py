"""The paper's two pendulums, released at an angle and followed by its own sensors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from harness.cases.beams import PAPER_MASS, THICKNESS, flexible_pendulum, strip
from harness.cases.case import NATIVE, Array
from harness.cases.pendulums import LENGTH, paper_pendulum
from harness.cases.rigid_pendulum_damped import DAMPING
from harness.engines import registry
from harness.recording.instruments import StrainBridge, TipAccelerometer, WireWound
from harness.system import Attachment, System

# What joint and strip of the flexible pendulum lose is nowhere printed; these let the swing go on for the ten seconds drawn.
FLEXIBLE_DAMPING, MODAL_RATIO = 4e-4, 0.004
# Ten turns: a tenth of the step (section 4.1 of the paper).
TEN_TURNS = WireWound(travel=float(np.radians(3600.0)), windings=5000, linearity=0.0025)


@dataclass(frozen=True, eq=False)
class Run:
    """A release of one pendulum: time [s] (T,), the true angle, rate and acceleration (T,) and what sensors read, by name (T,)."""

    time: Array
    angle: Array
    rate: Array
    acceleration: Array
    read: Mapping[str, Array]
    true: Mapping[str, Array] = field(default_factory=dict)


def rigid(*, damping: float = DAMPING, friction: float = 0.0, drag: float = 0.0) -> System:
    """The rigid pendulum with viscous [N·m·s], dry [N·m] and quadratic [N·m·s²] damping at its joint."""
    system = paper_pendulum(damping=damping)
    system = system.replace_joint(replace(system.joint("pivot"), friction=friction))
    if drag:
        system = replace(system, attachments=(Attachment("quadratic_drag", "pivot", {"coefficient": drag}),))
    return system


def flexible(*, damping: float = FLEXIBLE_DAMPING, ratio: float = MODAL_RATIO, modes: int = 3) -> System:
    """The flexible pendulum as it must have been, 1 mm and 0.060 kg, with joint and modal damping."""
    made = flexible_pendulum(strip(mass=PAPER_MASS, modes=modes))
    link = made.links[0]
    assert link.beam is not None
    made = replace(made, links=(replace(link, beam=replace(link.beam, modal_damping=(ratio,) * modes)),))
    return made.replace_joint(replace(made.joint("pivot"), damping=damping))


def release_rigid(system: System, angle: float, *, duration: float = 15.0, rate: float = 200.0, seed: int = 1) -> Run:
    """The rigid pendulum let go at an angle from the vertical [rad], followed by potentiometer and tip accelerometer."""
    time = np.arange(int(duration * rate) + 1) / rate
    run = registry.engine(NATIVE).build(system).simulate(np.array([angle]), np.zeros(1), time)
    q, qd = run.position[:, 0], run.velocity[:, 0]
    qdd = np.gradient(qd, time, edge_order=2)
    rng = np.random.default_rng(seed)
    read = {"potentiometer": WireWound().read(q, rng), "accelerometer": TipAccelerometer(LENGTH).read(q, qd, qdd, rate)}
    return Run(time, q, qd, qdd, read)


def release_flexible(
    system: System, angle: float, *, duration: float = 6.0, rate: float = 1000.0, seed: int = 2, warming: float = 0.02
) -> Run:
    """The flexible pendulum let go straight at an angle [rad], followed by a ten-turn potentiometer and root strain gauges.

    warming: of the gauges [K/s].
    """
    time = np.arange(int(duration * rate) + 1) / rate
    start = np.zeros(len(system.coordinate_names))
    start[0] = angle
    run = registry.engine(NATIVE).build(system).simulate(start, np.zeros(len(start)), time)
    q, qd = run.position[:, 0], run.velocity[:, 0]
    rng = np.random.default_rng(seed)
    tip, strain = (np.asarray(run.channels[f"rod.{name}"]) for name in ("tip_deflection", "root_strain"))
    bridge = StrainBridge(length=LENGTH, half_depth=THICKNESS / 2.0, warming=warming)
    read = {"potentiometer": TEN_TURNS.read(q, rng), "gauges": bridge.read(strain, time, rng)}
    return Run(time, q, qd, np.gradient(qd, time), read, {"tip": tip, "strain": strain})
