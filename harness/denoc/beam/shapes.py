"""Exact Euler-Bernoulli mode shapes of a uniform beam as it is mounted.

Deflections are measured from the tangent at the beam's root, so every shape has s(0) = s'(0) = 0 whatever the root
does: a mode w(x) of a beam on a hinge becomes s(x) = w(x) - w(0) - w'(0) x, and the rigid swing is left to the joint.

The general solution is written on cos y, sin y, exp(-y) and exp(-(z - y)) with y = z x / l, which never overflows and
never cancels at high modes; a mode is the null vector of its four boundary conditions.

Source: any text on vibration of continuous systems, e.g. L. Meirovitch, Fundamentals of Vibrations (2001), ch. 8;
the boundary terms follow from the virtual work written out in ``_conditions``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BSpline, make_interp_spline
from scipy.optimize import brentq

from harness.errors import InputError
from harness.system import Beam

Array = NDArray[np.float64]

#: Modes in one plane beyond which a uniform Euler-Bernoulli beam is no model of anything (shear, rotary inertia) and
#: the spread of modal stiffness, about the fourth power of the number, eats the digits of double precision.
MODE_LIMIT = 20

# Roots are sought from here up; the four functions of the basis are dependent at z = 0, where the rigid swing lies.
_LOWEST_ROOT = 0.02
# Ratios of attached to beam inertia beyond this change no shape, but push the lowest root under the floor.
_RATIO_LIMIT = 1e6


class ModeShapes(Protocol):
    """Shapes of one bending plane (or of torsion): functions of the station x [m], each answering (p, m)."""

    @property
    def name(self) -> str:
        """``clamped_free``, ``tip_mass``, ``hub`` or ``samples``."""
        ...

    @property
    def why(self) -> str:
        """One sentence: what was picked and why."""
        ...

    @property
    def breaks(self) -> Array:
        """Stations between which the shapes are analytic [m], first 0, last the length."""
        ...

    @property
    def nodes(self) -> int:
        """Gauss-Legendre nodes between two breaks that integrate products of two shapes to rounding."""
        ...

    def value(self, x: ArrayLike) -> Array:
        """Shapes s_k(x), shape (p, m)."""
        ...

    def slope(self, x: ArrayLike) -> Array:
        """First derivatives s_k'(x) [1/m], shape (p, m)."""
        ...

    def curvature(self, x: ArrayLike) -> Array:
        """Second derivatives s_k''(x) [1/m²], shape (p, m)."""
        ...


@dataclass(frozen=True)
class Mount:
    """What a beam hangs on and what it carries, as ratios to the beam's own inertia (dimensionless).

    free_hub: whether the root turns; if not, it is clamped and ``hub`` and ``radius`` mean nothing.
    hub: hub inertia about the hinge / (ρ l³).
    radius: distance from the hinge to the beam's root / l.
    mass: tip mass / (ρ l).
    moment: tip mass × distance of its centre beyond the tip / (ρ l²).
    inertia: inertia of the tip body about the tip / (ρ l³).
    """

    free_hub: bool = False
    hub: float = 0.0
    radius: float = 0.0
    mass: float = 0.0
    moment: float = 0.0
    inertia: float = 0.0


@dataclass(frozen=True, eq=False)
class ExactShapes:
    """Exact shapes of a uniform beam; normalised to ∫ s² dx = l / 4, which makes a clamped-free mode one at the tip.

    length: l [m].
    roots: β_k l, ascending, shape (m,).
    coefficients: on cos, sin, exp(-y), exp(-(z - y)), shape (m, 4).
    lift, ramp: what is taken off to measure from the root tangent: lift + ramp · x / l, shape (m,).
    """

    name: str
    why: str
    length: float
    roots: Array
    coefficients: Array
    lift: Array
    ramp: Array

    @property
    def breaks(self) -> Array:
        return np.array([0.0, self.length])

    @property
    def nodes(self) -> int:
        return _nodes(float(self.roots[-1]))

    def value(self, x: ArrayLike) -> Array:
        station = np.atleast_1d(np.asarray(x, dtype=np.float64)) / self.length
        return self._derivative(station, 0) - self.lift - station[:, None] * self.ramp

    def slope(self, x: ArrayLike) -> Array:
        station = np.atleast_1d(np.asarray(x, dtype=np.float64)) / self.length
        return (self.roots * self._derivative(station, 1) - self.ramp) / self.length

    def curvature(self, x: ArrayLike) -> Array:
        station = np.atleast_1d(np.asarray(x, dtype=np.float64)) / self.length
        return (self.roots / self.length) ** 2 * self._derivative(station, 2)

    def _derivative(self, station: Array, order: int) -> Array:
        basis = _basis(self.roots[None, :], station[:, None], order)
        return np.einsum("pmb,mb->pm", basis, self.coefficients)


@dataclass(frozen=True, eq=False)
class SampledShapes:
    """Shapes given by samples: a spline through them with s(0) = s'(0) = 0, not normalised.

    The spline is quintic, of lower degree where there are less than five samples.

    length: l [m].
    spline: of the deflection over x / l, values (m,).
    """

    name: str
    why: str
    length: float
    spline: BSpline

    @property
    def breaks(self) -> Array:
        return self.length * np.unique(self.spline.t)

    @property
    def nodes(self) -> int:
        return self.spline.k + 1

    def value(self, x: ArrayLike) -> Array:
        return self._derivative(x, 0)

    def slope(self, x: ArrayLike) -> Array:
        return self._derivative(x, 1)

    def curvature(self, x: ArrayLike) -> Array:
        return self._derivative(x, 2)

    def _derivative(self, x: ArrayLike, order: int) -> Array:
        station = np.atleast_1d(np.asarray(x, dtype=np.float64)) / self.length
        values: Array = self.spline(station, nu=order) / self.length**order
        return values


@dataclass(frozen=True, eq=False)
class TorsionShapes:
    """Exact twist shapes of a uniform shaft, measured from the root section; normalised to ∫ s² dx = l / 2.

    roots: shape (m,); twist = cosine · (cos(z x / l) - 1) + sine · sin(z x / l).
    """

    name: str
    why: str
    length: float
    roots: Array
    cosine: Array
    sine: Array

    @property
    def breaks(self) -> Array:
        return np.array([0.0, self.length])

    @property
    def nodes(self) -> int:
        return _nodes(float(self.roots[-1]))

    def value(self, x: ArrayLike) -> Array:
        phase = self._phase(x)
        return self.cosine * (np.cos(phase) - 1.0) + self.sine * np.sin(phase)

    def slope(self, x: ArrayLike) -> Array:
        phase = self._phase(x)
        return self.roots / self.length * (self.sine * np.cos(phase) - self.cosine * np.sin(phase))

    def curvature(self, x: ArrayLike) -> Array:
        phase = self._phase(x)
        return -((self.roots / self.length) ** 2) * (self.cosine * np.cos(phase) + self.sine * np.sin(phase))

    def _phase(self, x: ArrayLike) -> Array:
        station = np.atleast_1d(np.asarray(x, dtype=np.float64))[:, None] / self.length
        phase: Array = station * self.roots
        return phase


def mode_shapes(
    beam: Beam,
    *,
    hub_inertia: float = 0.0,
    free_hub: bool,
    tip_mass: float = 0.0,
    tip_inertia: float = 0.0,
    tip_moment: float = 0.0,
    hub_radius: float = 0.0,
    modes: int | None = None,
) -> ModeShapes:
    """Shapes of one bending plane of a beam, of the kind ``beam.shapes`` asks for.

    ``auto`` takes what a single mode serves best: pinned with hub inertia if the hub is free to turn, clamped
    otherwise, with the tip mass and inertia in either case.

    hub_inertia: about the hinge [kg·m²]; hub_radius: hinge to root of the beam [m].
    tip_mass [kg], tip_moment (mass × distance beyond the tip) [kg·m], tip_inertia about the tip [kg·m²]: all that the
    tip carries, the beam's payload included. modes: instead of ``beam.modes``.
    Raises InputError if the beam or the number of modes is not sound, or ``hub`` is asked for on a hub that is held.
    """
    count = beam.modes if modes is None else modes
    if not 1 <= count <= MODE_LIMIT:
        raise InputError(f"{count} modes in a bending plane", mend=f"take 1 to {MODE_LIMIT}")
    mount = mount_ratios(
        beam,
        hub_inertia=hub_inertia,
        free_hub=free_hub,
        tip_mass=tip_mass,
        tip_inertia=tip_inertia,
        tip_moment=tip_moment,
        hub_radius=hub_radius,
    )
    if beam.shapes == "samples":
        return _sampled(beam, count)
    if beam.shapes == "clamped_free":
        return exact_shapes(
            Mount(), beam.length, count, name="clamped_free", why="clamped-free modes, as the system asks for"
        )
    if beam.shapes == "tip_mass":
        held = Mount(mass=mount.mass, moment=mount.moment, inertia=mount.inertia)
        return exact_shapes(
            held, beam.length, count, name="tip_mass", why="clamped modes with the tip's mass, as the system asks for"
        )
    if beam.shapes == "hub":
        if not free_hub:
            raise InputError(
                "hub modes asked for, but the joint does not turn the link in this bending plane",
                mend='say shapes = "auto" or "tip_mass"',
            )
        return exact_shapes(
            mount, beam.length, count, name="hub", why="pinned modes with hub inertia, as the system asks for"
        )
    if beam.shapes != "auto":
        raise InputError(f"unknown shapes {beam.shapes!r}", mend="take auto, clamped_free, tip_mass, hub or samples")
    carried = mount.mass > 0.0 or mount.inertia > 0.0
    if free_hub:
        why = (
            "picked pinned modes with the hub's inertia"
            + (" and what the tip carries" if carried else "")
            + ", because the joint is free to turn and one such mode vibrates at the true frequency"
        )
        return exact_shapes(mount, beam.length, count, name="hub", why=why)
    if carried:
        why = "picked clamped modes with what the tip carries, because the joint holds the root in this plane"
        return exact_shapes(mount, beam.length, count, name="tip_mass", why=why)
    why = "picked clamped-free modes, because the joint holds the root in this plane and the tip carries nothing"
    return exact_shapes(mount, beam.length, count, name="clamped_free", why=why)


def mount_ratios(
    beam: Beam,
    *,
    hub_inertia: float,
    free_hub: bool,
    tip_mass: float = 0.0,
    tip_inertia: float = 0.0,
    tip_moment: float = 0.0,
    hub_radius: float = 0.0,
) -> Mount:
    """What a beam hangs on and carries, in ratios to its own inertia; arguments as for ``mode_shapes``."""
    if not (beam.mass > 0.0 and beam.length > 0.0):
        raise InputError(f"a beam of length {beam.length} m and mass {beam.mass} kg", mend="both have to be positive")
    mass, moment, inertia = beam.mass, beam.mass * beam.length, beam.mass * beam.length**2
    # Beyond the limit the shape is that of an infinite inertia; scaling all three keeps the tip body possible.
    excess = max(1.0, tip_mass / mass / _RATIO_LIMIT, tip_inertia / inertia / _RATIO_LIMIT)
    held = not free_hub or hub_inertia / inertia > _RATIO_LIMIT
    return Mount(
        free_hub=not held,
        hub=0.0 if held else hub_inertia / inertia,
        radius=0.0 if held else hub_radius / beam.length,
        mass=tip_mass / mass / excess,
        moment=tip_moment / moment / excess,
        inertia=tip_inertia / inertia / excess,
    )


def characteristic_roots(mount: Mount, count: int) -> Array:
    """The lowest ``count`` roots β l of the mounted beam, the rigid swing left out, shape (count,)."""
    return np.array(_roots(mount, count))


# Fitting compiles the same beam many times over; its roots depend on ratios that rarely change.
@lru_cache(maxsize=1024)
def _roots(mount: Mount, count: int) -> tuple[float, ...]:
    low = np.geomspace(_LOWEST_ROOT, 1.0, 200)
    roots: list[float] = []
    start = 1.0
    grid = low
    while len(roots) < count:
        determinant = _determinant(grid, mount, np)
        for i in np.flatnonzero(np.sign(determinant[:-1]) * np.sign(determinant[1:]) <= 0.0):
            if determinant[i] == 0.0 and i > 0:
                continue  # a root on a grid point was taken with the interval before it
            roots.append(brentq(_determinant, grid[i], grid[i + 1], args=(mount,), xtol=1e-15, rtol=1e-14))
        # Roots of one uniform beam lie about π apart from here on, so sixty-fourths part any two of them.
        grid = np.linspace(start, start + 4.0 * np.pi, 257)
        start = float(grid[-1])
    return tuple(roots[:count])


def frequencies(beam: Beam, mount: Mount, count: int) -> Array:
    """Natural frequencies of the mounted beam in its first bending plane [Hz], the rigid swing left out, (count,)."""
    density = beam.mass / beam.length
    rate = np.sqrt(beam.bending_stiffness / density) / beam.length**2
    result: Array = characteristic_roots(mount, count) ** 2 * rate / (2.0 * np.pi)
    return result


def exact_shapes(mount: Mount, length: float, count: int, *, name: str, why: str) -> ExactShapes:
    """Exact shapes of a uniform beam on a mount, ``count`` of them."""
    roots = characteristic_roots(mount, count)
    # The null vector of the boundary conditions is the last right singular vector.
    coefficients = np.linalg.svd(_conditions(roots, mount))[2][:, -1, :]
    zero = np.zeros_like(roots)
    lift = np.einsum("mb,mb->m", _basis(roots, zero, 0), coefficients)
    ramp = roots * np.einsum("mb,mb->m", _basis(roots, zero, 1), coefficients)
    if not mount.free_hub:
        lift, ramp = zero, zero
    raw = ExactShapes(name, why, length, roots, coefficients, lift, ramp)
    node, weight = gauss_legendre(raw.nodes)
    mean_square = 0.5 * weight @ raw.value(0.5 * length * (node + 1.0)) ** 2
    sign = np.where(raw.value(length)[0] < 0.0, -1.0, 1.0)
    scale = sign * 0.5 / np.sqrt(mean_square)
    return ExactShapes(name, why, length, roots, coefficients * scale[:, None], lift * scale, ramp * scale)


def torsion_shapes(length: float, count: int, *, free_hub: bool, hub: float = 0.0, tip: float = 0.0) -> TorsionShapes:
    """Exact twist shapes of a uniform shaft on a mount, measured from its root section.

    hub, tip: inertia about the shaft of the hub (if free to turn) and of what the tip carries, over the shaft's own.
    """
    if not 1 <= count <= MODE_LIMIT:
        raise InputError(f"{count} torsion modes", mend=f"take 1 to {MODE_LIMIT}")

    # Twist A cos y + B sin y. Tip: twist' = z tip twist. Root: held, A = 0; or turning, B = -z hub A.
    def pair(z: float) -> tuple[float, float]:
        return (1.0, -z * hub) if free_hub else (0.0, 1.0)

    def end(z: float) -> float:
        cosine, sine = pair(z)
        return float(
            (sine * np.cos(z) - cosine * np.sin(z) - z * tip * (cosine * np.cos(z) + sine * np.sin(z)))
            / (1.0 + z * tip)
            / (1.0 + z * hub)
        )

    grid = np.concatenate([np.geomspace(1e-4, 0.05, 60), np.linspace(0.06, np.pi * (count + 2), 64 * (count + 2))])
    value = np.array([end(z) for z in grid])
    brackets = np.flatnonzero(value[:-1] * value[1:] < 0.0)[:count]
    root = np.array([brentq(end, grid[i], grid[i + 1], xtol=1e-15, rtol=1e-14) for i in brackets])
    pairs = np.array([pair(z) for z in root])
    how = "hinged" if free_hub else "clamped"
    raw = TorsionShapes("torsion", f"{how} torsion modes", length, root, pairs[:, 0], pairs[:, 1])
    node, weight = gauss_legendre(raw.nodes)
    mean_square = 0.5 * weight @ raw.value(0.5 * length * (node + 1.0)) ** 2
    sign = np.where(raw.value(length)[0] < 0.0, -1.0, 1.0)
    scale = sign / np.sqrt(2.0 * mean_square)
    return TorsionShapes(raw.name, raw.why, length, root, raw.cosine * scale, raw.sine * scale)


@lru_cache(maxsize=128)
def gauss_legendre(nodes: int) -> tuple[Array, Array]:
    """Nodes and weights of the Gauss-Legendre rule on [-1, 1], each (nodes,), not to be written to."""
    node, weight = np.polynomial.legendre.leggauss(nodes)
    node.setflags(write=False)
    weight.setflags(write=False)
    return node, weight


def _nodes(highest_root: float) -> int:
    # A product of two shapes has the content of exp(2 z i x / l); n Gauss nodes integrate it to rounding from about
    # n = z on, and a dozen more cover the boundary layers.
    return int(np.ceil(highest_root)) + 14


def _basis(z: Array, station: Array, order: int) -> Array:
    """Derivative of that order, by y = z x / l, of cos y, sin y, exp(-y), exp(-(z - y)); shape (..., 4)."""
    y = z * station
    near = np.exp(-y) * (-1.0) ** order
    far = np.exp(-(z - y))
    turn = order % 4
    cosine = (np.cos(y), -np.sin(y), -np.cos(y), np.sin(y))[turn]
    sine = (np.sin(y), np.cos(y), -np.sin(y), -np.cos(y))[turn]
    return np.stack(np.broadcast_arrays(cosine, sine, near, far), axis=-1)


def _conditions(z: Array, mount: Mount) -> Array:
    """The four boundary conditions at each z on the four functions of the basis, rows of size one; shape (k, 4, 4).

    From the virtual work ∫ EI w'' δw'' dx = ω² [∫ ρ w δw dx + I_h w'(0) δw'(0) + tip terms], with EI β⁴ = ρ ω²;
    derivatives here are by y.
    """
    zero, one = np.zeros_like(z), np.ones_like(z)
    root = [_basis(z, zero, k) for k in range(4)]
    tip = [_basis(z, one, k) for k in range(4)]
    w = z[:, None]
    if mount.free_hub:
        place = root[0] - w * mount.radius * root[1]
        turn = root[2] - w * mount.radius * root[3] + w**3 * mount.hub * root[1]
    else:
        place, turn = root[0], root[1]
    moment = tip[2] - w**3 * mount.inertia * tip[1] - w**2 * mount.moment * tip[0]
    shear = tip[3] + w * mount.mass * tip[0] + w**2 * mount.moment * tip[1]
    rows = np.stack([place, turn, moment, shear], axis=1)
    return rows / np.max(np.abs(rows), axis=2, keepdims=True)


def _determinant(z: Any, mount: Mount, functions: Any = math) -> Any:
    """Determinant of the boundary conditions, up to a positive factor: of one z (functions of ``math``) or of many (``numpy``).

    Written out, since a fit asks for it a million times: the rows of ``_conditions``, expanded by pairs of them (Laplace).
    """
    c, s, e = functions.cos(z), functions.sin(z), functions.exp(-z)
    root = ((1.0, 0.0, 1.0, e), (0.0, 1.0, -1.0, e), (-1.0, 0.0, 1.0, e), (0.0, -1.0, -1.0, e))
    tip = ((c, s, e, 1.0), (-s, c, -e, 1.0), (-c, -s, e, 1.0), (s, -c, -e, 1.0))
    place, turn = root[0], root[1]
    if mount.free_hub:
        arm, hub = z * mount.radius, z**3 * mount.hub
        place = tuple(w - arm * slope for w, slope, _, _ in zip(*root, strict=True))
        turn = tuple(bent - arm * shear + hub * slope for _, slope, bent, shear in zip(*root, strict=True))
    inertia, offset, mass = z**3 * mount.inertia, z**2 * mount.moment, z * mount.mass
    moment = tuple(bent - inertia * slope - offset * w for w, slope, bent, _ in zip(*tip, strict=True))
    force = tuple(shear + mass * w + offset * slope for w, slope, _, shear in zip(*tip, strict=True))

    def minor(one: Any, other: Any, i: int, j: int) -> Any:
        return one[i] * other[j] - one[j] * other[i]

    pairs = (
        (0, 1, 2, 3, 1.0),
        (0, 2, 1, 3, -1.0),
        (0, 3, 1, 2, 1.0),
        (1, 2, 0, 3, 1.0),
        (1, 3, 0, 2, -1.0),
        (2, 3, 0, 1, 1.0),
    )
    total = sum(sign * minor(place, turn, i, j) * minor(moment, force, k, l) for i, j, k, l, sign in pairs)
    return total / ((1.0 + z**3 * mount.hub) * (1.0 + inertia + offset) * (1.0 + mass + offset))


def _sampled(beam: Beam, count: int) -> SampledShapes:
    samples = beam.shape_samples
    if samples is None:
        raise InputError('shapes = "samples" without samples', mend="give shape_samples, or another kind of shapes")
    table = np.asarray(samples, dtype=np.float64)
    if table.ndim != 2 or table.shape[1] != 1 + count or table.shape[0] < max(3, 1 + count):
        raise InputError(
            f"shape samples of shape {table.shape}",
            mend=f"give at least {max(3, 1 + count)} rows of the station in [0, 1] and {count} deflection(s)",
        )
    if not np.all(np.isfinite(table)):
        raise InputError("shape samples that are not finite numbers", mend="give finite numbers")
    station, deflection = table[:, 0], table[:, 1:]
    if station[0] != 0.0 or abs(station[-1] - 1.0) > 1e-12 or np.any(np.diff(station) <= 0.0):
        raise InputError("stations of the shape samples do not rise from 0 to 1", mend="sort and scale them")
    size = np.max(np.abs(deflection), axis=0)
    if np.any(size == 0.0):
        raise InputError("a sampled shape that is zero everywhere", mend="leave it out")
    if np.any(np.abs(deflection[0]) > 1e-9 * size):
        raise InputError(
            "a sampled shape that does not start at zero deflection", mend="measure it from the tangent at the root"
        )
    degree = min(5, len(station))
    # One condition more than samples, the slope at the root; inner knots are averages of the stations, which keeps the
    # interpolation well posed (Schoenberg and Whitney).
    sites = np.concatenate([[0.0], station])
    inner = [float(np.mean(sites[j : j + degree])) for j in range(1, len(sites) - degree)]
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    spline = make_interp_spline(
        station,
        deflection,
        k=degree,
        t=knots,
        bc_type=([(1, np.zeros(count))], None),
    )
    if np.linalg.matrix_rank(deflection) < count:
        raise InputError("sampled shapes that depend on each other", mend="leave out what the others span")
    return SampledShapes("samples", "the shapes that the system gives as samples", beam.length, spline)
