"""Swing damping and modal damping told apart: a link that vibrates on a free hub is damped by its joint as well."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from harness.compare.decay.bands import Band, Interval
from harness.compare.decay.estimate import estimate
from harness.compare.decay.oscillator import Array
from harness.engines.denoc_native import Native
from harness.engines.small_motion import jacobian
from harness.errors import InputError
from harness.recording.recording import Recording
from harness.system import System


@dataclass(frozen=True)
class Apart:
    """Whose damping it is; numbers with their 95 % intervals.

    joint: viscous coefficient [N·m·s/rad], from every sample of the joint's position. by_joint: what it alone makes of the
    vibration's damping ratio [1]. modal: ratio of the mode of the link as mounted, what is left for the link itself [1].
    link, mode: which (from 1). frequency: of the mode by the model [Hz].
    """

    joint: Interval
    by_joint: Interval
    modal: Interval
    link: str
    mode: int
    frequency: float


def apart(recording: Recording, system: System, vibration: Band) -> Apart:
    """Damping of the joint and of the link of a mechanism of one joint, of which position and some vibrating channel are recorded.

    The joint's part is that of the model's small motion about rest; the link's ratio is what makes the measured one of both.
    Raises InputError if the mechanism has several joints or no link that bends, or the joint's position is not recorded.
    """
    flexible = [link for link in system.links if link.flexible]
    if len(system.joint_names) != 1 or len(flexible) != 1 or flexible[0].beam is None:
        raise InputError("joint and link are told apart for one link that bends on one joint", source=system.source)
    joint, link, beam = system.joint_names[0], flexible[0].name, flexible[0].beam
    channel = next((c for c in recording.channels if c.name == f"{joint}.position"), None)
    if channel is None:
        raise InputError(f"has no {joint}.position, which tells the joint's damping", source=recording.source)
    good = np.isfinite(channel.values)
    read = estimate(recording.time[good], channel.values[good]).linear
    bare = _damped(system, joint, link, 0.0, ())
    inertia = float(Native().build(bare).mass_matrix(np.zeros(len(system.coordinate_names)))[0, 0])
    viscous = (float(read.coefficients[0]) * inertia, *(float(v) * inertia for v in read.ci95[0]))
    frequencies, _ = _small_motion(bare)
    place = 1 + int(np.argmin(np.abs(frequencies[1:] - vibration.frequency[0])))
    mode = place - 1  # the first frequency is the swing's

    def ratio(damping: float, modal: float) -> float:
        given = tuple(modal if k == mode else 0.0 for k in range(beam.coordinates))
        return float(_small_motion(_damped(system, joint, link, damping, given))[1][place])

    by_joint = tuple(ratio(one, 0.0) for one in viscous)
    # The ratio is all but linear in the mode's own; one step of the secant's slope is enough at the ratios that ring.
    own = max(vibration.damping_ratio[0] - by_joint[0], 1e-6)
    slope = (ratio(viscous[0], own) - by_joint[0]) / own
    modal = tuple(
        max(0.0, (whole - joints) / slope)
        for whole, joints in zip(vibration.damping_ratio, (by_joint[0], by_joint[2], by_joint[1]), strict=True)
    )
    return Apart(
        (viscous[0], viscous[1], viscous[2]),
        (by_joint[0], by_joint[1], by_joint[2]),
        (modal[0], modal[1], modal[2]),
        link,
        mode + 1,
        float(frequencies[place]),
    )


def _damped(system: System, joint: str, link: str, damping: float, modal: tuple[float, ...]) -> System:
    """The system with that damping and no other."""
    made = system.replace_joint(replace(system.joint(joint), damping=damping, friction=0.0))
    links = tuple(
        replace(one, beam=replace(one.beam, modal_damping=modal, material_damping=0.0))
        if one.name == link and one.beam is not None
        else one
        for one in made.links
    )
    return replace(made, links=links)


def _small_motion(system: System) -> tuple[Array, Array]:
    """Frequencies [Hz] and damping ratios of small motion about zero at rest, by frequency, each (n,)."""
    model = Native().build(system)
    n = len(system.coordinate_names)
    still = np.zeros(n)
    by_position = jacobian(lambda q: model.forward_dynamics(q, still, still), still)
    by_velocity = jacobian(lambda qd: model.forward_dynamics(still, qd, still), still)
    roots = np.linalg.eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [by_position, by_velocity]]))
    swinging = roots[np.imag(roots) > 0.0]
    swinging = swinging[np.argsort(np.abs(swinging))]
    return np.abs(swinging) / (2.0 * np.pi), -np.real(swinging) / np.abs(swinging)
