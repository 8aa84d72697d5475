"""Inertia tensors: moving them between points, and whether a body can have them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.system.description import Array, Link, constant

# Model files print inertias with about six digits; a body thinner than that is not a contradiction.
PRINTED_DIGITS = 1e-6
# Tensors that were moved between points keep rounding of the term that was subtracted.
MOVED = 1e-9


def point_inertia(mass: float, offset: Array) -> Array:
    """Inertia tensor of a point mass at ``offset`` about the origin (Steiner's term) [kg·m²], shape (3, 3)."""
    x, y, z = offset.tolist()
    return mass * np.array(
        [[y * y + z * z, -x * y, -x * z], [-x * y, z * z + x * x, -y * z], [-x * z, -y * z, x * x + y * y]]
    )


def about_origin(link: Link) -> Array:
    """Inertia tensor of a link about its link-frame origin [kg·m²], shape (3, 3)."""
    return np.asarray(link.inertia) + point_inertia(link.mass, np.asarray(link.com))


def inertial_numbers(link: Link) -> Array:
    """Mass [kg], first moments [kg·m], second moments xx, yy, zz, xy, xz, yz about the link-frame origin [kg·m²], shape (10,).

    Every one adds up over bodies that are joined.
    """
    about = about_origin(link)
    return np.concatenate([[link.mass], link.mass * link.com, about[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]])


def with_inertial_numbers(link: Link, numbers: Array) -> Link:
    """The link with these ``inertial_numbers`` (10,) in the place of its own."""
    m, first, (xx, yy, zz, xy, xz, yz) = np.split(numbers, (1, 4))
    mass = float(m[0])
    com = first / mass if mass > 0.0 else np.zeros(3)
    whole = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return replace(link, mass=mass, com=constant(com), inertia=constant(whole - point_inertia(mass, com)))


def impossible(mass: float, inertia: Array) -> str | None:
    """Why no body has this mass [kg] and inertia about its centre of mass [kg·m²], or None.

    A point mass (all zero) and a slender rod (one principal moment zero) are possible limits.
    """
    if not (np.isfinite(mass) and np.all(np.isfinite(inertia))):
        return "mass or inertia is NaN or infinite"
    if mass < 0.0:
        return f"mass {mass:g} kg is negative"
    moments = np.linalg.eigvalsh(inertia)
    largest = float(np.abs(moments).max())
    if mass == 0.0 and largest > 0.0:
        return "mass is zero but inertia is not"
    slack = PRINTED_DIGITS * largest
    if moments[0] < -slack:
        return f"principal moment of inertia {moments[0]:.4g} kg·m² about the centre of mass is negative"
    if moments[2] > moments[0] + moments[1] + slack:
        return (
            f"principal moments of inertia {moments[0]:.4g}, {moments[1]:.4g}, {moments[2]:.4g} kg·m² violate the "
            "triangle inequality"
        )
    return None


def rounded_away(link: Link) -> bool:
    """Whether a link's inertia is no body's, and nothing but what rounding leaves of a tensor about the link's origin."""
    inertia = np.asarray(link.inertia)
    if link.mass <= 0.0 or not np.all(np.isfinite(inertia)) or impossible(link.mass, inertia) is None:
        return False
    return float(np.abs(np.linalg.eigvalsh(inertia)).max()) <= MOVED * link.mass * float(link.com @ link.com)


def combine(*bodies: tuple[float, Array, Array]) -> tuple[float, Array, Array]:
    """One body for several rigidly joined ones: (mass [kg], com [m], inertia about its own com [kg·m²]) each."""
    mass = sum(body[0] for body in bodies)
    if mass == 0.0:
        return 0.0, np.zeros(3), np.asarray(sum((body[2] for body in bodies), np.zeros((3, 3))))
    com = sum((body[0] * np.asarray(body[1]) for body in bodies), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for body_mass, body_com, body_inertia in bodies:
        inertia = inertia + body_inertia + point_inertia(body_mass, np.asarray(body_com) - com)
    return mass, com, inertia
