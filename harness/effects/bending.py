"""Rigid links made flexible, and flexible ones given a further mode."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import scipy.linalg

from harness.denoc.beam.integrals import BENDING, beam_data
from harness.effects.scale import rod_and_bob, tip_of
from harness.errors import InputError
from harness.system import Beam, System
from harness.system.description import Array, constant

# Damping ratio of the second mode, which is there for what the link gives under slow forces: its own vibration, six times as fast
# as the first's, is taken to die out at once, for recordings seldom show it and steps would have to follow it.
SECOND = 0.5


def bend(system: System, site: str, parameters: Mapping[str, float]) -> System:
    """The rigid link ``site`` as a beam whose first mode has the given frequency as mounted.

    Its two modes are made of the shapes in which its own weight and its turning bend it at rest: what it gives under slow
    forces is then exact, and the first frequency within a hundredth of the beam's. The beam reaches from the joint to
    the link's end; beam and end mass together have the link's mass and centre of mass, and what inertia is left stays
    rigid at the joint. It bends in the plane in which its joint turns it.
    parameters: ``frequency`` [Hz], ``damping_ratio`` [1].
    Raises InputError if the link bends already or has no length or mass.
    """
    # Where it ends follows from its inertia here, whatever is stated: a longer rod would leave less than none at the joint.
    link = replace(system.link(site), end=None)
    if link.beam is not None:
        raise InputError(f"link {site!r} bends already", mend="higher_mode adds a mode to it")
    tip = tip_of(link, system)
    length = float(np.linalg.norm(tip))
    if length == 0.0 or link.mass <= 0.0 or not np.any(link.com):
        raise InputError(
            f"link {site!r} has no length or mass to bend with", mend="its centre of mass lies on its joint"
        )
    direction = tip / length
    rod, share = rod_and_bob(link)
    if abs(rod - length) > 1e-9 * length:
        # The end is a joint's place: share the mass so that the centre of mass is right, as far as a bob at the
        # end can.
        share = float(np.clip(2.0 * float(link.com @ direction) / length - 1.0, 0.0, 1.0 - 1e-3))
    payload = min(share, 1.0 - 1e-3) * link.mass
    shapes = static_shapes(payload / (link.mass - payload))
    beam = Beam(
        length=length,
        direction=constant(direction),
        bending=constant(bending_direction(system, site, direction)),
        mass=link.mass - payload,
        bending_stiffness=1.0,
        modes=2,
        payload=payload,
        shapes="samples",
        shape_samples=constant(shapes),
    )
    frequencies, modes = mounted_modes(system.replace_link(replace(link, beam=beam)), site)
    own = shapes[:, 1:] @ modes
    own = np.column_stack([shapes[:, 0], own / own[-1]])
    stiffness = (parameters["frequency"] / float(frequencies[0])) ** 2
    first = parameters["damping_ratio"]
    second = max(first, SECOND)
    soft = replace(beam, bending_stiffness=stiffness, modal_damping=(first, second), shape_samples=constant(own))
    return system.replace_link(replace(link, beam=soft))


def static_shapes(tip: float) -> Array:
    """Samples of how a clamped beam bends under an even load, and of what a load that rises evenly bends it less, (5, 3).

    tip: mass at the end over the beam's; its load bends the beam with either. First column: stations in [0, 1].
    Source: the beam equation w'' = M, M the moment of the loads beyond, integrated twice.
    """
    x = np.linspace(0.0, 1.0, 5)
    even = x**2 / 4 - x**3 / 6 + x**4 / 24 + tip * (x**2 / 2 - x**3 / 6)
    rising = x**2 / 6 - x**3 / 12 + x**5 / 120 + tip * (x**2 / 2 - x**3 / 6)
    return np.column_stack([x, even, even - rising])


def add_mode(system: System, site: str, parameters: Mapping[str, float]) -> System:
    """The flexible link ``site`` with one more bending mode, of the given frequency and damping as mounted.

    The mode has the shape that beam theory gives it; its stiffness is scaled until it has the frequency.
    parameters: ``frequency`` [Hz], ``damping_ratio`` [1].
    Raises InputError if the link is rigid or has the shapes of samples.
    """
    link = system.link(site)
    if link.beam is None:
        raise InputError(f"link {site!r} is rigid", mend="link_flexibility makes it bend")
    if link.beam.shapes == "samples":
        raise InputError(
            f"link {site!r} has sampled shapes, which do not say what the next mode is", mend="add it to the samples"
        )
    modes = link.beam.modes
    richer = _richer(link.beam)
    ratios = (*richer.modal_damping[:-1], parameters["damping_ratio"])
    reached = mounted_frequency(system.replace_link(replace(link, beam=richer)), site, modes)
    scaled = (*richer.mode_stiffness[:-1], (parameters["frequency"] / reached) ** 2)
    return system.replace_link(replace(link, beam=replace(richer, modal_damping=ratios, mode_stiffness=scaled)))


def next_mode(system: System, site: str) -> dict[str, float]:
    """What beam theory foretells of the first bending mode that the flexible link ``site`` lacks: ``frequency`` [Hz] as mounted."""
    link = system.link(site)
    assert link.beam is not None
    richer = system.replace_link(replace(link, beam=_richer(link.beam)))
    return {"frequency": mounted_frequency(richer, site, link.beam.modes)}


def _richer(beam: Beam) -> Beam:
    """The beam with one more mode, undamped and as stiff as theory has it."""
    missing = beam.modes - len(beam.modal_damping), beam.modes - len(beam.mode_stiffness)
    return replace(
        beam,
        modes=beam.modes + 1,
        modal_damping=(*beam.modal_damping, *(0.0,) * missing[0], 0.0),
        mode_stiffness=(*beam.mode_stiffness, *(1.0,) * missing[1], 1.0),
    )


def bending_direction(system: System, site: str, direction: Array) -> Array:
    """Across the link, in the plane in which its joint turns it."""
    joint = system.carrier(site)
    bending = joint.axis - direction * (joint.axis @ direction) if joint.prismatic else np.cross(joint.axis, direction)
    if np.linalg.norm(bending) < 1e-9:
        bending = np.cross(direction, np.eye(3)[int(np.argmin(np.abs(direction)))])
    return np.asarray(bending / np.linalg.norm(bending))


def mounted_frequency(system: System, site: str, mode: int = 0) -> float:
    """Frequency of a bending mode of a flexible link as mounted [Hz]: on its free joint with its payload, without gravity.

    mode: counted from 0, ascending.
    """
    return float(mounted_modes(system, site)[0][mode])


def mounted_modes(system: System, site: str) -> tuple[Array, Array]:
    """Frequencies [Hz] of all bending modes of a flexible link as mounted (k,), ascending, and the modes as columns (k, k)."""
    link = system.link(site)
    assert link.beam is not None
    # One damping ratio ζ for every mode as mounted gives a damping matrix with K⁻¹ C v = (2 ζ/ω) v for each of them.
    ratio = 0.1
    beam = replace(link.beam, modal_damping=(ratio,) * link.beam.modes, material_damping=0.0)
    data = beam_data(system.replace_link(replace(link, beam=beam)), site)
    plane = np.ix_(data.plane == BENDING, data.plane == BENDING)
    periods, modes = scipy.linalg.eig(np.linalg.solve(data.K[plane], data.C[plane]))
    order = np.argsort(-periods.real)
    return 2.0 * ratio / periods.real[order] / (2.0 * np.pi), np.asarray(modes.real[:, order])
