"""Everything the equations of motion need to know about one flexible link, integrated once.

Elastic coordinates b of a link: ``modes`` in the bending plane (along e = ``bending``), then ``modes`` in the second
plane (along n = direction × bending) if ``bending2``, then ``torsion_modes`` of twist about d = ``direction``. The
section at station x stands, to second order in b, at

    x d + e Σ s_k b_k + n Σ s_k b_k - ½ d Σ H_kl b_k b_l      (each Σ over its own plane; H = 0 across planes and twist)

and is turned, to first order, by  n Σ s_k' b_k - e Σ s_k' b_k + d Σ s_k b_k.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from harness.denoc.beam.shapes import MODE_LIMIT, ModeShapes, gauss_legendre, mode_shapes, torsion_shapes
from harness.errors import InputError
from harness.system import Beam, Joint, JointType, Link, System
from harness.system.inertia import about_origin
from harness.system.rotation import skew

Array = NDArray[np.float64]

#: What an elastic coordinate does, the values of ``BeamData.plane``.
BENDING, BENDING2, TORSION = 0, 1, 2

# A joint axis this far (cosine) from the normal of a bending plane holds the root in that plane.
_AXIS_TILT = 1e-3


@dataclass(frozen=True, eq=False)
class Station:
    """A section of the beam: shapes and what belongs to them there.

    s (m,); slope s' (m,) [1/m]; curvature s'' (m,) [1/m²]; foreshortening H (m, m) [1/m].
    For twist, ``s`` is the angle's shape, ``slope`` its derivative.
    """

    x: float
    s: Array
    slope: Array
    curvature: Array
    H: Array


@dataclass(frozen=True, eq=False)
class BeamData:
    """A flexible link's shapes and their integrals; m elastic coordinates, p quadrature nodes.

    The nodes are Gauss-Legendre, enough of them that integrals of products of two shapes are exact to rounding
    (relative error below 1e-12; products of four, as in H², below 1e-9).

    link: its name; length: l [m]; rho: mass per length ρ [kg/m], of the beam alone.
    direction, bending, normal: d, e and n = d × e in the link frame, (3,).
    plane: BENDING, BENDING2 or TORSION for each coordinate, (m,).
    x, weights: nodes [m] and weights [m], (p,).
    s, slope, curvature: (p, m); H: H_kl(x) = ∫₀ˣ s_k' s_l' dx within a plane, (p, m, m).
    S0 = ∫ s dx (m,); S1 = ∫ s_k s_l dx (m, m), within a plane; S2 = ∫ x s dx (m,); S3 = s(l) (m,): the paper's names.
    K: stiffness EI ∫ s_k'' s_l'' dx (GJ ∫ s_k' s_l' dx for twist), (m, m).
    C: damping, material_damping · K plus what gives the modal ratios (see ``modal_damping_matrix``), (m, m).
    polar_inertia: ρ I_p [kg·m], for twist.
    payload [kg], payload_inertia about the tip in link axes (3, 3) [kg·m²].
    geometric_stiffening: whether H is to be used.
    half_depth: root strain is half_depth · Σ curvature(0) b over the bending plane [m]; nan if unknown.
    tip: the section at x = l.
    shape, why: name of the shapes and one sentence why they were picked; of the first plane.
    shapes: the functions themselves, one of each plane, then twist.
    """

    link: str
    length: float
    rho: float
    direction: Array
    bending: Array
    normal: Array
    plane: NDArray[np.int64]
    x: Array
    weights: Array
    s: Array
    slope: Array
    curvature: Array
    H: Array
    S0: Array
    S1: Array
    S2: Array
    S3: Array
    K: Array
    C: Array
    polar_inertia: float
    payload: float
    payload_inertia: Array
    geometric_stiffening: bool
    half_depth: float
    tip: Station
    shape: str
    why: str
    shapes: tuple[ModeShapes, ...]

    @property
    def coordinates(self) -> int:
        """Number m of elastic coordinates."""
        return len(self.plane)

    def at(self, x: float) -> Station:
        """The section at station x [m], within 0 and the length."""
        return _station(self.shapes, self.plane, x)


# Rows of parameters and the sensors that read their motion ask for the same beam one after the other.
@lru_cache(maxsize=256)
def beam_data(system: System, link_name: str) -> BeamData:
    """Shapes and integrals of a flexible link where it stands in its system; not to be written to.

    Raises KeyError if there is no such link, InputError if it is rigid or its beam is not sound.
    """
    link = system.link(link_name)
    beam = link.beam
    if beam is None:
        raise InputError(f"link {link_name!r} is rigid", mend="ask only for links that have a beam")
    check_beam(link_name, beam)
    normal = np.cross(beam.direction, beam.bending)
    shapes: list[ModeShapes] = [_bending_shapes(system, link, beam, beam.bending)]
    kinds = [BENDING] * beam.modes
    if beam.bending2:
        shapes.append(_bending_shapes(system, link, beam, normal))
        kinds += [BENDING2] * beam.modes
    if beam.torsion_modes:
        shapes.append(_torsion(system, link, beam))
        kinds += [TORSION] * beam.torsion_modes
    plane = np.array(kinds, dtype=np.int64)

    breaks = shapes[0].breaks
    nodes = max(shape.nodes for shape in shapes)
    x, weights = _gauss(breaks, nodes)
    s = np.concatenate([shape.value(x) for shape in shapes], axis=1)
    slope = np.concatenate([shape.slope(x) for shape in shapes], axis=1)
    curvature = np.concatenate([shape.curvature(x) for shape in shapes], axis=1)
    together = plane[:, None] == plane[None, :]
    tip = _station(tuple(shapes), plane, beam.length)
    stiffness = np.zeros((len(plane), len(plane)))
    for kind, rigidity, bent in (
        (BENDING, beam.bending_stiffness, curvature),
        (BENDING2, beam.bending_stiffness2, curvature),
        (TORSION, beam.torsional_stiffness, slope),
    ):
        part = np.flatnonzero(plane == kind)
        block = rigidity * np.einsum("p,pk,pl->kl", weights, bent[:, part], bent[:, part])
        if kind != TORSION and len(part) and beam.mode_stiffness:
            factor = np.ones(len(part))
            factor[: len(beam.mode_stiffness)] = np.sqrt(beam.mode_stiffness)
            block = block * np.outer(factor, factor)
        stiffness[np.ix_(part, part)] = 0.5 * (block + block.T)
    data = BeamData(
        link=link_name,
        length=beam.length,
        rho=beam.mass / beam.length,
        direction=np.array(beam.direction),
        bending=np.array(beam.bending),
        normal=normal,
        plane=plane,
        x=x,
        weights=weights,
        s=s,
        slope=slope,
        curvature=curvature,
        H=_foreshortening(tuple(shapes), plane, x),
        S0=weights @ s,
        S1=np.einsum("p,pk,pl->kl", weights, s, s) * together,
        S2=(weights * x) @ s,
        S3=tip.s,
        K=stiffness,
        C=np.zeros_like(stiffness),
        polar_inertia=beam.polar_inertia,
        payload=beam.payload,
        payload_inertia=np.array(beam.payload_inertia),
        geometric_stiffening=beam.geometric_stiffening,
        half_depth=beam.half_depth,
        tip=tip,
        shape=shapes[0].name,
        why=shapes[0].why,
        shapes=tuple(shapes),
    )
    data.C[...] = beam.material_damping * stiffness + modal_damping_matrix(system, data)
    for array in (data.x, data.weights, data.s, data.slope, data.curvature, data.H, data.S0, data.S1, data.S2):
        array.setflags(write=False)
    data.K.setflags(write=False)
    data.C.setflags(write=False)
    return data


def check_beam(link_name: str, beam: Beam) -> None:
    """Raise InputError, naming the link, if a beam cannot be modelled."""
    place = f"link {link_name!r}: "
    positive = {"length": beam.length, "mass": beam.mass, "bending stiffness": beam.bending_stiffness}
    if beam.bending2:
        positive["bending stiffness in the second plane"] = beam.bending_stiffness2
    if beam.torsion_modes:
        positive["torsional stiffness"] = beam.torsional_stiffness
        positive["polar inertia"] = beam.polar_inertia
    for name, value in positive.items():
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"{place}{name} of {value:g}", mend="give a positive number")
    for name, value in {"material damping": beam.material_damping, "payload": beam.payload}.items():
        if not (np.isfinite(value) and value >= 0.0):
            raise InputError(f"{place}{name} of {value:g}", mend="give zero or a positive number")
    if not 1 <= beam.modes <= MODE_LIMIT:
        raise InputError(f"{place}{beam.modes} modes", mend=f"take 1 to {MODE_LIMIT}")
    if not 0 <= beam.torsion_modes <= MODE_LIMIT:
        raise InputError(f"{place}{beam.torsion_modes} torsion modes", mend=f"take 0 to {MODE_LIMIT}")
    if len(beam.modal_damping) > beam.modes or any(not 0.0 <= ratio < 1.0 for ratio in beam.modal_damping):
        raise InputError(
            f"{place}modal damping {list(beam.modal_damping)}", mend="give a ratio in [0, 1) for each mode at most"
        )
    for name, axis in (("direction", beam.direction), ("bending direction", beam.bending)):
        if np.shape(axis) != (3,) or not abs(float(np.linalg.norm(axis)) - 1.0) < 1e-9:
            raise InputError(f"{place}{name} is no unit vector", mend="give three numbers of norm one")
    along = abs(float(beam.direction @ beam.bending))
    if along > 1e-9:
        raise InputError(
            f"{place}bending direction lies {along:.3g} along the link", mend="choose it at right angles to the link"
        )


def modal_damping_matrix(system: System, data: BeamData) -> Array:
    """Damping matrix (m, m) that gives the link's ``modal_damping`` ratios to its modes as mounted.

    As mounted means: the link alone with its payload, straight, on its joint. A revolute joint turns freely with its
    hub inertia (armature, and rigid links between that joint and the beam); any other joint, or one whose axis lies in
    the bending plane, holds the root. What follows down the chain is not counted. With the joint's rotation eliminated,
    M_r = M_bb - M_bθ M_θb / M_θθ, the modes are K v = ω² M_r v, vᵀ M_r v = 1, and C = M_r V diag(2 ζ ω) Vᵀ M_r.
    Ratios go to the modes of each bending plane in ascending frequency; modes without a ratio, and twist, get none.
    """
    link = system.link(data.link)
    beam = link.beam
    assert beam is not None
    damping = np.zeros((data.coordinates, data.coordinates))
    if not any(beam.modal_damping):
        return damping
    for kind, along in ((BENDING, data.bending), (BENDING2, data.normal)):
        part = np.flatnonzero(data.plane == kind)
        if len(part) == 0:
            continue
        reduced = _mounted_mass(data, part, _root(system, link, along), along)
        block = np.ix_(part, part)
        omega2, vectors = scipy.linalg.eigh(data.K[block], reduced)
        ratios = np.zeros(len(part))
        ratios[: len(beam.modal_damping)] = beam.modal_damping
        weighted = reduced @ vectors
        modal = (weighted * (2.0 * ratios * np.sqrt(np.maximum(omega2, 0.0)))) @ weighted.T
        damping[block] = 0.5 * (modal + modal.T)
    return damping


@dataclass(frozen=True)
class Root:
    """How a link's root is held in one bending plane.

    free: to turn about a hinge ``radius`` [m] behind it; inertia: of the hub [kg·m²].
    """

    free: bool
    inertia: float = 0.0
    radius: float = 0.0


def _mounted_mass(data: BeamData, part: NDArray[np.int64], root: Root, along: Array) -> Array:
    """Mass matrix of the coordinates of one plane, payload included, with the joint's rotation eliminated."""
    axis = np.cross(data.direction, along)
    turning = float(axis @ data.payload_inertia @ axis)
    s, tip, tip_slope = data.s[:, part], data.tip.s[part], data.tip.slope[part]
    mass = data.rho * np.einsum("p,pk,pl->kl", data.weights, s, s)
    mass += data.payload * np.outer(tip, tip) + turning * np.outer(tip_slope, tip_slope)
    if not root.free:
        return mass
    arm = data.x + root.radius
    reach = data.length + root.radius
    coupling = data.rho * (data.weights * arm) @ s + data.payload * reach * tip + turning * tip_slope
    inertia = root.inertia + data.rho * data.weights @ arm**2 + data.payload * reach**2 + turning
    return mass - np.outer(coupling, coupling) / inertia


def _bending_shapes(system: System, link: Link, beam: Beam, along: Array) -> ModeShapes:
    root = _root(system, link, along)
    mass, moment, inertia = _tip(system, link, beam, along)
    return mode_shapes(
        beam,
        free_hub=root.free,
        hub_inertia=root.inertia,
        hub_radius=root.radius,
        tip_mass=mass,
        tip_moment=moment,
        tip_inertia=inertia,
    )


def _torsion(system: System, link: Link, beam: Beam) -> ModeShapes:
    joint = system.carrier(link.name)
    own = beam.polar_inertia * beam.length
    turns = _revolute(joint) and abs(float(joint.axis @ beam.direction)) > 1.0 - _AXIS_TILT
    tip = float(beam.direction @ beam.payload_inertia @ beam.direction)
    return torsion_shapes(
        beam.length, beam.torsion_modes, free_hub=turns, hub=joint.armature / own if turns else 0.0, tip=tip / own
    )


def _revolute(joint: Joint) -> bool:
    return joint.type in (JointType.REVOLUTE, JointType.CONTINUOUS)


def _root(system: System, link: Link, along: Array) -> Root:
    """How the root of a link is held in a bending plane; fixed joints are followed up to the one that turns."""
    beam = link.beam
    assert beam is not None
    joint = system.carrier(link.name)
    # Carried along on the way down the fixed joints, in the frame of the link arrived at: the beam's plane and root.
    side, forward, root = along, np.array(beam.direction), np.zeros(3)
    hub = np.zeros((6, 6))
    while joint.type is JointType.FIXED and joint.parent != system.base:
        parent = system.link(joint.parent)
        if parent.flexible:
            return Root(free=False)
        side, forward = joint.rotation @ side, joint.rotation @ forward
        root = joint.xyz + joint.rotation @ root
        hub = _moved(hub, joint) + _spatial_inertia(parent)
        joint = system.carrier(parent.name)
    if not _revolute(joint):
        return Root(free=False)
    axis = joint.axis
    normal = np.cross(forward, side)
    share = float(axis @ normal)
    if abs(share) < _AXIS_TILT:
        return Root(free=False)
    # An oblique axis swings the link out of the plane as well; in terms of the rotation in the plane that is inertia of
    # the hub, and the axis's own share enters squared.
    about = about_origin(link)
    across, spin = float(axis @ side) ** 2, float(axis @ forward) ** 2
    outside = across * float(along @ about @ along) + spin * float(beam.direction @ about @ beam.direction)
    inertia = joint.armature + float(axis @ hub[:3, :3] @ axis) + outside
    radius = float(np.cross(axis, root) @ side) / share
    return Root(free=True, inertia=inertia / share**2, radius=radius)


def _tip(system: System, link: Link, beam: Beam, along: Array) -> tuple[float, float, float]:
    """Mass [kg], first moment [kg·m] and inertia [kg·m²] that the tip carries in the plane along ``along``.

    The payload, and every child with all that hangs on it: its articulated inertia (joints free to turn, beams frozen)
    at zero joint positions. A child that rides below the tip counts by how far a static tip load would carry it.
    """
    axis = np.cross(beam.direction, along)
    mass, moment = beam.payload, 0.0
    inertia = float(axis @ beam.payload_inertia @ axis)
    for joint in system.joints:
        if joint.parent != link.name:
            continue
        station = min(max(float(joint.xyz @ beam.direction) / beam.length, 0.0), 1.0)
        carried = _moved(_articulated_inertia(system, joint), joint)
        # About the station on the beam's axis: twist of a unit turn about the plane's normal, and a unit deflection.
        turn = np.concatenate([axis, np.cross(station * beam.length * beam.direction, axis)])
        shift = np.concatenate([np.zeros(3), along])
        moved, turned = 0.5 * station**2 * (3.0 - station), station * (2.0 - station)
        mass += moved**2 * float(shift @ carried @ shift)
        moment += moved * turned * float(shift @ carried @ turn)
        inertia += turned**2 * float(turn @ carried @ turn)
    return mass, moment, inertia


def _articulated_inertia(system: System, joint: Joint) -> Array:
    """Articulated inertia of what a joint carries, felt through it, in the joint frame; (6, 6), angular first."""
    body = _spatial_inertia(system.link(joint.child))
    for child in system.joints:
        if child.parent == joint.child:
            body = body + _moved(_articulated_inertia(system, child), child)
    if not joint.movable:
        return body
    zero = np.zeros(3)
    motion = np.concatenate([zero, joint.axis] if joint.prismatic else [joint.axis, zero])
    force = body @ motion
    resistance = float(motion @ force) + joint.armature
    if resistance <= 0.0:
        return body
    return body - np.outer(force, force) / resistance


def _moved(inertia: Array, joint: Joint) -> Array:
    """A spatial inertia given in a joint's frame, in the frame of the joint's parent link."""
    rotation, shift = joint.rotation, skew(joint.xyz)
    # Twist (ω, v at the origin) of the parent frame to that of the joint frame.
    transform = np.zeros((6, 6))
    transform[:3, :3] = rotation.T
    transform[3:, :3] = -rotation.T @ shift
    transform[3:, 3:] = rotation.T
    moved: Array = transform.T @ inertia @ transform
    return moved


def _spatial_inertia(link: Link) -> Array:
    """Spatial inertia of a link about its frame's origin, beam undeformed; (6, 6), angular first."""
    centre = skew(link.com)
    result = np.zeros((6, 6))
    result[:3, :3] = about_origin(link)
    result[:3, 3:] = link.mass * centre
    result[3:, :3] = -link.mass * centre
    result[3:, 3:] = link.mass * np.eye(3)
    return result


def _gauss(breaks: Array, nodes: int) -> tuple[Array, Array]:
    """Gauss-Legendre nodes and weights on each interval between breaks, joined."""
    node, weight = gauss_legendre(nodes)
    half = 0.5 * np.diff(breaks)[:, None]
    middle = 0.5 * (breaks[1:] + breaks[:-1])[:, None]
    return (middle + half * node).ravel(), (half * weight).ravel()


def _foreshortening(shapes: tuple[ModeShapes, ...], plane: NDArray[np.int64], x: Array) -> Array:
    """H_kl(x) = ∫₀ˣ s_k' s_l' dx within each bending plane, zero otherwise; shape (p, m, m)."""
    result = np.zeros((len(x), len(plane), len(plane)))
    bends = (plane[:, None] == plane[None, :]) & (plane[:, None] != TORSION)
    nodes = max(shape.nodes for shape in shapes)
    breaks = shapes[0].breaks
    for i, station in enumerate(x):
        inside = breaks[breaks < station]
        points, weights = _gauss(np.append(inside, station), nodes) if station > 0.0 else (np.zeros(1), np.zeros(1))
        slope = np.concatenate([shape.slope(points) for shape in shapes], axis=1)
        result[i] = np.einsum("p,pk,pl->kl", weights, slope, slope) * bends
    return result


def _station(shapes: tuple[ModeShapes, ...], plane: NDArray[np.int64], x: float) -> Station:
    where = np.array([x])
    return Station(
        x=x,
        s=np.concatenate([shape.value(where)[0] for shape in shapes]),
        slope=np.concatenate([shape.slope(where)[0] for shape in shapes]),
        curvature=np.concatenate([shape.curvature(where)[0] for shape in shapes]),
        H=_foreshortening(shapes, plane, where)[0],
    )
