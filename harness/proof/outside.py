"""Kinds of effect that no catalogue names: each must be told as unexplained, or as partly explained.

Every kind is a function (scene, rng, strength, amplitude) that plants it at the first joint; strength 1 is plainly visible.
Kinds that a combination of catalogued effects expresses exactly do not belong here.
"""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.proof.rigs import Segment
from harness.proof.scene import Scene
from harness.proof.truth import DryFriction

Array = NDArray[np.float64]
Kind = Callable[[Scene, np.random.Generator, float, float], None]

OUTSIDE: dict[str, Kind] = {}


def _kind(function: Kind) -> Kind:
    OUTSIDE[function.__name__] = function
    return function


def _rate(s: Segment) -> float:
    return float(np.sqrt(s.gravity_moment / s.inertia_about_joint))


def _law(scene: Scene, law: Callable[[float, float, float], float]) -> None:
    dof = scene.dof(scene.rig.joints[0])

    def torque(t: float, q: Array, v: Array) -> Array:
        force = np.zeros(len(v))
        force[dof] = law(t, q[dof], v[dof])
        return force

    scene.torques.append(torque)


@_kind
def magnet_at_one_angle(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """A magnet beside the path pulls within a few degrees of one angle: derivative of a Gaussian well."""
    centre, width = rng.uniform(-0.6, 0.6) * amplitude, rng.uniform(0.05, 0.15) * amplitude
    depth = 0.1 * strength * scene.rig.segments[0].gravity_moment * width
    _law(scene, lambda t, q, v: -depth * (q - centre) / width**2 * float(np.exp(-0.5 * ((q - centre) / width) ** 2)))


@_kind
def sloshing_bob(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """Liquid in the bob: part of the mass swings across the link on a spring of its own, damped."""
    s = scene.rig.segments[0]
    share = min(0.12 * strength, 0.8)
    rate = float(rng.uniform(1.2, 2.5)) * _rate(s)
    across = " ".join(repr(float(x)) for x in np.cross(np.array(scene.rig.axis), np.array([0.0, 0.0, -1.0])))
    m = share * s.mass
    scene.edit_segment(0, mass=s.mass - m)
    scene.extra[0] = (
        f'<body name="liquid" pos="0 0 {-s.com!r}"><inertial pos="0 0 0" mass="{m!r}" diaginertia="1e-9 1e-9 1e-9"/>'
        f'<joint name="liquid" type="slide" axis="{across}" stiffness="{m * rate**2!r}" '
        f'damping="{2 * 0.05 * m * rate!r}"/></body>'
    )


@_kind
def gust(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """A draught for a second or two: a smooth pulse of torque at one time."""
    s = scene.rig.segments[0]
    length = min(run.duration for run in scene.runs)
    when, width = rng.uniform(0.3, 0.7) * length, rng.uniform(0.2, 0.5)
    push = 0.05 * strength * rng.choice([-1.0, 1.0]) * s.gravity_moment
    _law(scene, lambda t, q, v: push * float(np.exp(-0.5 * ((t - when) / width) ** 2)))


@_kind
def hinge_changes_side(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """A worn bush: the pin rolls to the other side of its hole, so the lever arm of gravity differs left and right."""
    s = scene.rig.segments[0]
    change, blend = 0.05 * strength * s.gravity_moment, 0.02 * amplitude
    _law(scene, lambda t, q, v: -change * float(np.tanh(q / blend)) * float(np.sin(q)))


@_kind
def warming_bearing(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """Grease that thins as it warms: viscous damping falls by half every few seconds of running."""
    s = scene.rig.segments[0]
    c = 0.05 * strength * s.inertia_about_joint * _rate(s)
    half = rng.uniform(1.5, 4.0)
    _law(scene, lambda t, q, v: -c * 0.5 ** (t / half) * v)


@_kind
def leak(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """A bob that loses mass through a hole at its centre while it swings; the rod keeps the rest of the inertia."""
    s = scene.rig.segments[0]
    length = min(run.duration for run in scene.runs)
    lost = min(0.15 * strength, 0.6)
    # The leaking mass sits at the tip, where it changes the swing's period.
    tip = lost * s.mass

    def edit(t: float, model: mujoco.MjModel) -> None:
        left = tip * (1.0 - 0.9 * min(max(t / length, 0.0), 1.0))
        body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, "leaking_bob")
        model.body_mass[body] = left

    scene.extra[0] = (
        f'<body name="leaking_bob" pos="0 0 {-s.length!r}">'
        f'<inertial pos="0 0 0" mass="{tip!r}" diaginertia="1e-9 1e-9 1e-9"/></body>'
    )
    scene.edit_segment(0, mass=s.mass - tip)
    scene.edit = edit


@_kind
def sudden_rubbing(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """Something starts to rub at one moment: dry friction from then on, none before."""
    s = scene.rig.segments[0]
    length = min(run.duration for run in scene.runs)
    when = rng.uniform(0.25, 0.6) * length
    torque = 0.02 * strength * s.gravity_moment
    dof = scene.dof(scene.rig.joints[0])
    scene.breaks.append(when)
    clock = {"t": 0.0}

    def watch(t: float, q: Array, v: Array) -> Array:
        clock["t"] = t
        return np.zeros(len(v))

    scene.torques.append(watch)
    scene.dry.append(
        DryFriction(
            dof,
            lambda v, n, q: torque if clock["t"] >= when else 0.0,
            lambda n, q: torque if clock["t"] >= when else 0.0,
        )
    )


@_kind
def parametric_pumping(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """The support moves up and down at about twice the swing's frequency."""
    s = scene.rig.segments[0]
    rate = rng.uniform(1.5, 2.6) * _rate(s)
    scene.gravity = lambda t: np.array([0.0, 0.0, -scene.rig.gravity * (1.0 + 0.05 * strength * np.sin(rate * t))])


@_kind
def sector_friction(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """A scored sector of the bearing: dry friction only between two angles away from rest."""
    s = scene.rig.segments[0]
    centre, width = rng.choice([-1, 1]) * rng.uniform(0.3, 0.6) * amplitude, rng.uniform(0.08, 0.2) * amplitude
    torque = 0.05 * strength * s.gravity_moment
    dof = scene.dof(scene.rig.joints[0])

    def inside(q: float) -> float:
        return torque / (1.0 + ((q - centre) / width) ** 8)

    scene.dry.append(DryFriction(dof, lambda v, n, q: inside(q), lambda n, q: inside(q)))


@_kind
def self_excitation(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """Air flow past the bob feeds small swings and brakes large ones (van der Pol)."""
    s = scene.rig.segments[0]
    c, scale = 0.03 * strength * s.inertia_about_joint * _rate(s), rng.uniform(0.3, 0.6) * amplitude
    _law(scene, lambda t, q, v: c * (1.0 - (q / scale) ** 2) * v)


@_kind
def encoder_skip(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """An encoder that loses counts at one moment: the reading is off by a constant from then on."""
    length = min(run.duration for run in scene.runs)
    when, jump = rng.uniform(0.3, 0.7) * length, 0.03 * strength * rng.choice([-1.0, 1.0])
    scene.signal.setdefault(scene.rig.joints[0], []).append(lambda g: lambda t: g(t) + jump * (t >= when))


@_kind
def knock(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """Somebody bumps the link once: the velocity jumps."""
    s = scene.rig.segments[0]
    length = min(run.duration for run in scene.runs)
    when = rng.uniform(0.3, 0.7) * length
    jump = 0.05 * strength * rng.choice([-1.0, 1.0]) * amplitude * _rate(s)
    dof = scene.dof(scene.rig.joints[0])

    def kick(q: Array, v: Array) -> tuple[Array, Array]:
        v = v.copy()
        v[dof] += jump
        return q, v

    scene.kicks[when] = kick


@_kind
def hidden_absorber(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """A loose cable: a small pendulum of its own hangs from the link and takes energy and gives it back."""
    s = scene.rig.segments[0]
    length = float(9.81 / (rng.uniform(0.85, 1.3) * _rate(s)) ** 2)
    mass = 0.03 * strength * s.mass
    axis = " ".join(repr(a) for a in scene.rig.axis)
    scene.extra[0] = (
        f'<body name="cable" pos="0 0 {-s.com!r}"><inertial pos="0 0 {-length!r}" mass="{mass!r}" '
        f'diaginertia="1e-9 1e-9 1e-9"/><joint name="cable" type="hinge" axis="{axis}" '
        f'damping="{float(0.04 * mass * length**2 * np.sqrt(9.81 / length))!r}"/></body>'
    )


@_kind
def relaxing_rubber(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """A rubber bush that remembers: a spring in series with a dashpot (Maxwell element) whose time is near the swing's."""
    s = scene.rig.segments[0]
    k = 0.15 * strength * s.gravity_moment
    time = rng.uniform(0.5, 1.5) / _rate(s)
    dof = scene.dof(scene.rig.joints[0])

    def torque(t: float, q: Array, v: Array, z: Array) -> Array:
        force = np.zeros(len(v))
        force[dof] = -z[0]
        return force

    scene.states.append((1, lambda t, q, v, z: np.array([k * v[dof] - z[0] / time]), torque))


@_kind
def one_way_crack(scene: Scene, rng: np.random.Generator, strength: float, amplitude: float) -> None:
    """A cracked flexure: restoring torque that is softer while the crack is open, and rubs only while it closes."""
    s = scene.rig.segments[0]
    k = 0.1 * strength * s.gravity_moment
    c = 0.05 * strength * s.inertia_about_joint * _rate(s)
    _law(scene, lambda t, q, v: (-k * q - c * v if v < 0.0 else -0.3 * k * q) if q > 0.0 else -k * q)
