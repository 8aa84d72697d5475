"""The twist of a joint: what its drive's encoder reads less what the encoder behind the gear does, along the recorded motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, make_interp_spline

from harness.denoc.model import Denoc
from harness.diagnose.inverse.band import driven_at, motion_noise
from harness.diagnose.inverse.constants import (
    ATTENUATION,
    EDGE_PERIODS,
    FEWEST_HARMONICS,
    MOTION_CUTOFF_RATIO,
    NYQUIST_SHARE,
    OVERSAMPLING,
    SAMPLE_PERIODS,
    WIDEST_NYQUIST_SHARE,
)
from harness.diagnose.inverse.effort_motion import ZeroPhase, low_pass, reading_noise
from harness.diagnose.problem.hypothesis import nominal_quantities, scaled
from harness.diagnose.selection.constants.starts import MOTION_HARMONICS
from harness.diagnose.transmission.constants import FEWEST_SAMPLES
from harness.effects.catalogue import effect
from harness.effects.effect import Effect
from harness.effects.scale import swings
from harness.engines.expressed import express
from harness.recording.recording import Channel, Recording
from harness.system import System

Array = NDArray[np.float64]

SECOND = "link_position"  # the quantity that a second encoder reads

# Effects whose torque acts on the drive, where the first encoder reads; all others act on the link, behind the spring.
AT_THE_DRIVE = (
    "viscous_damping", "coulomb_friction", "stribeck_friction", "quadratic_drag", "polynomial_damping", "dahl_friction",
    "load_dependent_friction", "friction_creep", "friction_softness", "cogging_torque", "added_inertia", "joint_flexibility",
    "backlash", "stop_inertia",
)  # fmt: skip


ROWS = ("time", "twist", "position", "speed", "load", "load_rate", "push", "errors")


@dataclass(frozen=True, eq=False)
class TwistRun:
    """The twist of one joint in one recording, at samples that a low-pass lets be independent; all (N,).

    name: of the recording. time [s]; twist, position [rad]; speed [rad/s], a mean over as long as the second
    encoder is late; load: torque that the link asks of the coupling [N·m], load_rate [N·m/s]; push: its direction, -1 to 1 (m and N
    at slides). step: between samples [s]. noise: of the twist, by the encoders' own [rad]. errors: by how much load and its rate
    are another if one nominal quantity is off by its tolerance, (quantities, 2, N).
    """

    name: str
    time: Array
    twist: Array
    position: Array
    speed: Array
    load: Array
    load_rate: Array
    push: Array
    step: float
    noise: float
    errors: Array

    def part(self, keep: slice | NDArray[np.intp]) -> TwistRun:
        """Some of the samples, which follow one another."""
        rows = {k: getattr(self, k)[..., keep] for k in ROWS}
        return replace(self, **rows)


def cutoff_for(system: System, recordings: Sequence[Recording]) -> float:
    """The cutoff [Hz] up to which the recorded motion goes, or where the noise of accelerations is small beside them."""
    lowest = np.inf
    for recording in recordings:
        own = np.array(swings(system, recording)) / (2.0 * np.pi)
        driven = np.array([driven_at(recording, name) for name in system.joint_names])
        paces = np.maximum(own, driven)
        highest = min(MOTION_HARMONICS * float(paces.max()), NYQUIST_SHARE * 0.5 / recording.interval)
        least = min(FEWEST_HARMONICS * float(paces.max()), highest)
        for cutoff in np.geomspace(highest, least, 8):
            smooth, _ = _motion(system, recording, {}, float(cutoff))
            ratios = [
                motion_noise(recording, name, float(cutoff), 2) ** 2 / max(float(np.var(a)), 1e-30)
                for name, a in zip(system.joint_names, smooth[2].T, strict=True)
            ]
            if max(ratios) < ATTENUATION:
                break
        lowest = min(lowest, float(cutoff))
    return lowest


def twists(
    system: System,
    recording: Recording,
    second: Sequence[Channel],
    there: Mapping[str, Channel],
    late: Mapping[str, float],
    cutoff: float,
    links: System,
    others: Sequence[System] = (),
) -> dict[str, TwistRun]:
    """The twist of every joint with a second encoder, by its name.

    second: what those read. there: positions of links by joint, where they are not the drives'. late: by how much second encoders
    are, as far as known [s]. cutoff: of the low-pass [Hz]. links: the system as ``behind_the_gears`` leaves it. others: the
    same, each with a nominal quantity off by its tolerance.
    """
    read = {channel.site: channel for channel in second}
    (q, qd, qdd), time = _motion(system, recording, there, cutoff)
    step = float(time[1] - time[0])
    smooth = ZeroPhase(low_pass(cutoff, step))
    whole = express(links)
    stated = Denoc(whole.system).inverse_dynamics_batch(q, qd, qdd)
    torque = stated - whole.forces(q, qd) if whole.forces.any else stated
    edge, every = round(EDGE_PERIODS / (cutoff * step)), max(1, round(SAMPLE_PERIODS / (cutoff * step)))
    taken = np.arange(edge, len(time) - edge, every)
    out: dict[str, TwistRun] = {}
    if len(taken) < FEWEST_SAMPLES:
        return out
    off = [Denoc(express(other).system).inverse_dynamics_batch(q, qd, qdd) - stated for other in others]
    for name, channel in read.items():
        j = system.joint_names.index(name)
        drive = recording.channel(f"{name}.position")
        # Both through one low-pass, so that it takes nothing from their difference.
        twist = smooth(_on(time, recording.time, drive.values) - _on(time, recording.time, channel.values))
        speed = qd[:, j]
        if late.get(name, 0.0) != 0.0:
            speed = (q[:, j] - CubicSpline(time, q[:, j])(time - late[name])) / late[name]
        own = (torque[:, j], np.gradient(torque[:, j], step), np.sign(torque[:, j]), q[:, j], speed)
        load, rate, push, position, speed = smooth(np.stack(own, axis=1))[taken].T
        errors = [smooth(np.stack([o[:, j], np.gradient(o[:, j], step)], axis=1))[taken].T for o in off]
        noises = [reading_noise(recording, c) for c in (drive, channel)]
        # Of white noise a low-pass leaves as much as it lets through of all frequencies up to Nyquist's.
        left = float(np.linalg.norm(noises) * np.sqrt(min(2.0 * cutoff * recording.interval, 1.0)))
        out[name] = TwistRun(
            recording.name, time[taken], twist[taken], position, speed, load, rate, push, every * step, left,
            np.array(errors).reshape(-1, 2, len(taken)),
        )  # fmt: skip
    return out


def given_way(system: System, recording: Recording, there: Mapping[str, Channel], cutoff: float) -> tuple[Array, Array]:
    """By how much more effort drives would need if the links were where they are, (T, n), and the grid [s] that it is on.

    there: positions of links by joint, where they are not the drives'.
    """
    links = behind_the_gears(system)
    model = Denoc(express(links).system).inverse_dynamics_batch
    (q, qd, qdd), time = _motion(system, recording, {}, cutoff)
    behind, _ = _motion(system, recording, there, cutoff)
    return np.asarray(model(q, qd, qdd) - model(*behind)), time


def off_by_tolerance(system: System, links: System) -> list[System]:
    """``links`` with each nominal quantity that loads depend on off by its tolerance."""
    quantities = nominal_quantities(system)
    out = []
    for k, quantity in enumerate(quantities):
        if quantity.kind not in ("armature", "damping"):
            factors = np.ones(len(quantities))
            factors[k] += quantity.tolerance
            out.append(scaled(links, quantities, list(factors)))
    return out


def behind_the_gears(system: System) -> System:
    """The system without what acts on its drives: rotors, friction in them, and errors of sensors and drives.

    Nor with what moves by coordinates of its own, a base or a link that gives: nothing reads those, and loads are those of links
    that follow their joints.
    """
    joints = tuple(replace(joint, armature=0.0, damping=0.0, friction=0.0) for joint in system.joints)
    kept = tuple(a for a in system.attachments if a.effect not in AT_THE_DRIVE and _of_links(effect(a.effect)))
    return replace(system, joints=joints, attachments=kept)


def _of_links(law: Effect) -> bool:
    return law.side == "dynamics" and not law.adds_coordinates


def _motion(
    system: System, recording: Recording, there: Mapping[str, Channel], cutoff: float
) -> tuple[tuple[Array, Array, Array], Array]:
    """Position, speed and acceleration of the links (T, n), and the grid [s] that they are on.

    there: positions of links by joint, where they are not the drives'.
    """
    step = 1.0 / (OVERSAMPLING * cutoff)
    time = np.arange(0.0, recording.duration, step)
    widest = min(MOTION_CUTOFF_RATIO * cutoff, max(WIDEST_NYQUIST_SHARE * 0.5 / recording.interval, cutoff))
    wide = ZeroPhase(low_pass(widest, step))
    columns = []
    for name in system.joint_names:
        channel = there.get(name) or recording.channel(f"{name}.position")
        columns.append(_on(time, recording.time, channel.values))
    q = wide(np.stack(columns, axis=1))
    spline = make_interp_spline(time, q, k=5)
    return (q, spline.derivative(1)(time), spline.derivative(2)(time)), time


def _on(grid: Array, time: Array, values: Array) -> Array:
    good = np.isfinite(values)
    return np.asarray(CubicSpline(time[good], values[good])(grid))
