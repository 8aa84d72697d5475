"""Random mechanisms with bodies that could exist, for identities that must hold on any mechanism."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.system.description import STANDARD_GRAVITY, Array, Beam, Joint, JointType, Link, System, constant
from harness.system.flexible_link import flexible_link
from harness.system.rotation import about_axis

Fraction = float


def random_chain(
    n: int,
    seed: int = 0,
    *,
    prismatic: Fraction = 0.2,
    flexible: Fraction = 0.0,
    modes: int = 2,
    bending2: bool = False,
    armature: bool = False,
    damping: bool = False,
    fixed: Fraction = 0.0,
) -> System:
    """A serial chain of ``n`` movable joints with axes, offsets and bodies in general position.

    seed: the same seed gives the same system. prismatic, flexible, fixed: share of sliding joints, of beams, and of
    welded links put in between. modes, bending2: of each beam. armature, damping: whether joints get some.
    """
    return _random_system(n, seed, True, prismatic, flexible, modes, bending2, armature, damping, fixed)


def random_tree(
    n: int,
    seed: int = 0,
    *,
    prismatic: Fraction = 0.2,
    flexible: Fraction = 0.0,
    modes: int = 2,
    bending2: bool = False,
    armature: bool = False,
    damping: bool = False,
    fixed: Fraction = 0.0,
) -> System:
    """A tree of ``n`` movable joints, each on a link drawn among those placed already or the base.

    Options as in ``random_chain``.
    """
    return _random_system(n, seed, False, prismatic, flexible, modes, bending2, armature, damping, fixed)


SPECIAL = ("planar", "vertical", "balanced", "weightless", "tilted")


def special_chain(kind: str, n: int, seed: int = 0) -> System:
    """A chain of hinges in which the terms of some forces cancel.

    kind: ``planar`` (parallel horizontal axes, no gravity), ``vertical`` (axes along gravity), ``balanced`` (what a joint carries
    has its centre on the axis), ``weightless`` (axes in general position, no gravity), ``tilted`` (``vertical`` but for the last
    digit of a right angle as files print it).
    """
    rng = np.random.default_rng([n, seed, SPECIAL.index(kind)])
    chain = random_chain(n, seed, prismatic=0.0)
    along = {"planar": [0.0, 1.0, 0.0], "vertical": [0.0, 0.0, 1.0], "balanced": [0.0, 1.0, 0.0]}.get(kind)
    joints, links = [], []
    for k, (joint, link) in enumerate(zip(chain.joints, chain.links, strict=True)):
        if along is not None:
            joint = replace(joint, rotation=constant(np.eye(3)), axis=constant(along))
        if kind == "tilted":
            # pi / 2 to eight digits, about y: the x axis of the frame points down but for what the digits leave.
            turn = about_axis([0.0, 1.0, 0.0], 1.5707963) if k == 0 else np.eye(3)
            joint = replace(joint, rotation=constant(turn), axis=constant([1.0, 0.0, 0.0]))
        if kind == "balanced":
            # Every joint sits on the axis of the one before it, and every centre of mass on its joint's axis.
            joint = replace(joint, xyz=constant([0.0, float(rng.uniform(0.1, 0.3)), 0.0]))
            link = replace(link, com=constant([0.0, float(rng.uniform(-0.2, 0.2)), 0.0]))
        joints.append(joint)
        links.append(link)
    gravity = np.zeros(3) if kind in ("planar", "weightless") else np.array(STANDARD_GRAVITY)
    return System(f"{kind}_{n}_{seed}", tuple(joints), tuple(links), gravity=constant(gravity))


def _random_system(
    n: int,
    seed: int,
    chain: bool,
    prismatic: Fraction,
    flexible: Fraction,
    modes: int,
    bending2: bool,
    armature: bool,
    damping: bool,
    fixed: Fraction,
) -> System:
    rng = np.random.default_rng([n, seed, int(chain)])
    joints: list[Joint] = []
    links: list[Link] = []
    movable = 0
    while movable < n:
        k = len(joints)
        weld = k > 0 and rng.random() < fixed
        sliding = not weld and rng.random() < prismatic
        bends = not weld and rng.random() < flexible
        parent = k - 1 if chain else int(rng.integers(-1, k))
        parent_link = links[parent] if parent >= 0 else None
        xyz = rng.uniform(-0.4, 0.4, 3)
        if parent_link is not None and parent_link.beam is not None:
            # On a beam the next joint sits at the tip, with a small rigid offset to the side.
            beam = parent_link.beam
            offset = 0.02 * _unit(rng)
            direction = np.asarray(beam.direction)
            xyz = beam.length * direction + offset - (offset @ direction) * direction
        kind = JointType.FIXED if weld else JointType.PRISMATIC if sliding else JointType.REVOLUTE
        placement, axis = _rotation(rng), _unit(rng)
        joints.append(
            Joint(
                name=f"joint{k + 1}",
                type=kind,
                parent=f"link{parent + 1}" if parent >= 0 else "base",
                child=f"link{k + 1}",
                xyz=constant(xyz),
                rotation=constant(placement),
                axis=constant([0.0, 0.0, 1.0] if weld else axis),
                armature=float(rng.uniform(0.01, 0.05)) if armature and not weld else 0.0,
                damping=float(rng.uniform(0.02, 0.2)) if damping and not weld else 0.0,
            )
        )
        links.append(_beam(rng, f"link{k + 1}", modes, bending2) if bends else _body(rng, f"link{k + 1}"))
        movable += not weld
    shape = "chain" if chain else "tree"
    return System(name=f"random_{shape}_{n}_{seed}", joints=tuple(joints), links=tuple(links))


def _unit(rng: np.random.Generator) -> Array:
    vector = rng.normal(size=3)
    return np.asarray(vector / np.linalg.norm(vector))


def _rotation(rng: np.random.Generator) -> Array:
    """A rotation drawn evenly over all rotations (QR of a normal matrix)."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return np.asarray(q * np.linalg.det(q))


def _body(rng: np.random.Generator, name: str) -> Link:
    """A solid box in general position: its inertia is that of a body that could exist."""
    mass = float(rng.uniform(0.2, 2.0))
    squares = rng.uniform(0.05, 0.4, 3) ** 2
    axes = _rotation(rng)
    inertia = axes @ np.diag(mass / 12.0 * (squares.sum() - squares)) @ axes.T
    return Link(
        name=name,
        mass=mass,
        com=constant(rng.uniform(-0.2, 0.2, 3)),
        inertia=constant((inertia + inertia.T) / 2.0),
    )


def _beam(rng: np.random.Generator, name: str, modes: int, bending2: bool) -> Link:
    """A steel strip in general position, with a payload that has inertia about every axis."""
    axes = _rotation(rng)
    length, width, thickness = rng.uniform([0.2, 0.02, 0.001], [0.5, 0.03, 0.002])
    youngs_modulus, density = 2.0e11, 7850.0
    payload = float(rng.uniform(0.02, 0.1))
    return flexible_link(
        name,
        Beam(
            length=float(length),
            direction=constant(axes[:, 0]),
            bending=constant(axes[:, 1]),
            mass=float(density * length * width * thickness),
            bending_stiffness=float(youngs_modulus * width * thickness**3 / 12.0),
            bending_stiffness2=float(youngs_modulus * thickness * width**3 / 12.0) if bending2 else 0.0,
            bending2=bending2,
            half_depth=float(thickness / 2.0),
            modes=modes,
            payload=payload,
            payload_inertia=constant(payload * rng.uniform(0.01, 0.02) ** 2 * np.eye(3)),
            width=float(width),
            thickness=float(thickness),
            youngs_modulus=youngs_modulus,
            density=density,
        ),
    )
