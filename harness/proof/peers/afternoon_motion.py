"""Equations of motion for the practitioner's fit, written without the native dynamics: what a peer stands on is its
own.

One joint is solved in closed form: inertia J, and a force by gravity of a cos q + b sin q + c. More are solved in world
frames by Newton and Euler (Featherstone 2008, chapter 2), bodies that hang on fixed joints merged; tests hold them
against Pinocchio. Dry friction is smoothed, torque · tanh(v / v_s), and integrated by the classical Runge-Kutta method
at a fixed step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from harness.system import System

Array = NDArray[np.float64]

STEP = 2.5e-3  # s, longest step between samples
STIFF = 1.0  # of the smoothed friction: slope of its acceleration over speed, times the step
MOST_STEPS = 40  # between two samples


@dataclass(frozen=True)
class Bodies:
    """Joints in our order, each with all that rides on it.

    parent: index of the joint it rides on or −1, (n,). rotation, place: of the joint in its parent's frame at zero, (n,
    3, 3), (n, 3). axis: (n, 3). slides: whether prismatic, (n,). mass (n,); com (n, 3) and inertia about it (n, 3, 3)
    in the joint's frame. gravity: (3,). armature: (n,).
    """

    parent: NDArray[np.int64]
    rotation: Array
    place: Array
    axis: Array
    slides: NDArray[np.bool_]
    mass: Array
    com: Array
    inertia: Array
    gravity: Array
    armature: Array


def bodies(system: System) -> Bodies:
    """The rigid system as bodies, in the order of ``system.joint_names``; what hangs on fixed joints is merged.

    Inertias that no body can have are taken as stated: a joint feels only the sum about its axis.
    """
    joints = system.movable_joints
    number = {j.name: k for k, j in enumerate(joints)}
    ride: dict[str, tuple[int, Array, Array]] = {system.base: (-1, np.eye(3), np.zeros(3))}
    n = len(joints)
    parent = np.full(n, -1, dtype=np.int64)
    rotation, place = np.empty((n, 3, 3)), np.empty((n, 3))
    parts: list[list[tuple[float, Array, Array]]] = [[] for _ in joints]
    for joint, link in zip(system.joints, system.links, strict=True):
        carrier, frame, origin = ride[joint.parent]
        frame, origin = frame @ joint.rotation, origin + frame @ joint.xyz
        if joint.movable:
            k = number[joint.name]
            parent[k], rotation[k], place[k] = carrier, frame, origin
            carrier, frame, origin = k, np.eye(3), np.zeros(3)
        ride[joint.child] = carrier, frame, origin
        if carrier >= 0:
            parts[carrier].append((link.mass, origin + frame @ link.com, frame @ link.inertia @ frame.T))
    mass, com, inertia = np.zeros(n), np.zeros((n, 3)), np.zeros((n, 3, 3))
    for k, pieces in enumerate(parts):
        mass[k] = sum(m for m, _, _ in pieces)
        com[k] = sum((m * c for m, c, _ in pieces), np.zeros(3)) / max(mass[k], 1e-300)
        for m, c, tensor in pieces:
            arm = c - com[k]
            inertia[k] += tensor + m * (float(arm @ arm) * np.eye(3) - np.outer(arm, arm))
    return Bodies(
        parent, rotation, place, np.array([j.axis for j in joints]), np.array([j.prismatic for j in joints]), mass, com,
        inertia, np.array(system.gravity), np.array([j.armature for j in joints]),
    )  # fmt: skip


@numba.njit(cache=True, inline="always")
def _cross(a: Array, b: Array, out: Array, factor: float) -> None:
    """Adds factor · a × b."""
    out[0] += factor * (a[1] * b[2] - a[2] * b[1])
    out[1] += factor * (a[2] * b[0] - a[0] * b[2])
    out[2] += factor * (a[0] * b[1] - a[1] * b[0])


@numba.njit(cache=True, inline="always")
def _turned(matrix: Array, vector: Array, out: Array) -> None:
    for i in range(3):
        out[i] = matrix[i, 0] * vector[0] + matrix[i, 1] * vector[1] + matrix[i, 2] * vector[2]


@numba.njit(cache=True, inline="always")
def _dot(a: Array, b: Array) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@numba.njit(cache=True)
def workspace(n: int) -> tuple[Array, Array]:
    """Frames (n, 3, 3) and vectors (8, n, 3) that ``mass_and_bias`` writes into."""
    return np.zeros((n + 2, 3, 3)), np.zeros((8, n + 1, 3))


@numba.njit(cache=True)
def mass_and_bias(
    q: Array,
    v: Array,
    parent: Array,
    rotation: Array,
    place: Array,
    axis: Array,
    slides: Array,
    mass: Array,
    com: Array,
    inertia: Array,
    gravity: Array,
    frames: Array,
    vectors: Array,
    matrix: Array,
    bias: Array,
) -> None:
    """Into ``matrix`` (n, n) the mass matrix without armature, into ``bias`` (n,) the forces that hold the motion
    unaccelerated."""
    n = len(q)
    origin, along, spin, spin_rate, rate, linear = (
        vectors[0],
        vectors[1],
        vectors[2],
        vectors[3],
        vectors[4],
        vectors[5],
    )
    arm, w, force, moment, part = vectors[6, 0], vectors[6, 1], vectors[7, 0], vectors[7, 1], vectors[5, n]
    frame, tensor = frames[n], frames[n + 1]
    matrix[:] = 0.0
    bias[:] = 0.0
    for k in range(n):
        p = parent[k]
        if p >= 0:
            for i in range(3):
                for j in range(3):
                    frame[i, j] = 0.0
                    for m in range(3):
                        frame[i, j] += frames[p, i, m] * rotation[k, m, j]
            _turned(frames[p], place[k], arm)
            for i in range(3):
                origin[k, i], spin[k, i], spin_rate[k, i], rate[k, i] = (
                    origin[p, i],
                    spin[p, i],
                    spin_rate[p, i],
                    rate[p, i],
                )
        else:
            for i in range(3):
                for j in range(3):
                    frame[i, j] = rotation[k, i, j]
                arm[i] = place[k, i]
                origin[k, i] = spin[k, i] = spin_rate[k, i] = rate[k, i] = 0.0
        z = along[k]
        _turned(frame, axis[k], z)
        for i in range(3):
            w[i] = spin[k, i]
        if slides[k]:
            for i in range(3):
                arm[i] += z[i] * q[k]
                for j in range(3):
                    frames[k, i, j] = frame[i, j]
            _cross(w, z, rate[k], 2.0 * v[k])
        else:
            c, s = np.cos(q[k]), np.sin(q[k])
            x, y, t = axis[k, 0], axis[k, 1], axis[k, 2]
            u = 1.0 - c
            tensor[0, 0], tensor[0, 1], tensor[0, 2] = c + x * x * u, x * y * u - t * s, x * t * u + y * s
            tensor[1, 0], tensor[1, 1], tensor[1, 2] = y * x * u + t * s, c + y * y * u, y * t * u - x * s
            tensor[2, 0], tensor[2, 1], tensor[2, 2] = t * x * u - y * s, t * y * u + x * s, c + t * t * u
            for i in range(3):
                for j in range(3):
                    frames[k, i, j] = (
                        frame[i, 0] * tensor[0, j] + frame[i, 1] * tensor[1, j] + frame[i, 2] * tensor[2, j]
                    )
        for i in range(3):
            origin[k, i] += arm[i]
            part[i] = 0.0
        _cross(spin_rate[k], arm, rate[k], 1.0)
        _cross(w, arm, part, 1.0)
        _cross(w, part, rate[k], 1.0)
        if not slides[k]:
            _cross(w, z, spin_rate[k], v[k])
            for i in range(3):
                spin[k, i] += z[i] * v[k]
    for k in range(n):
        _turned(frames[k], com[k], arm)
        for i in range(3):
            w[i] = spin[k, i]
            part[i] = 0.0
            force[i] = rate[k, i] - gravity[i]
            for j in range(3):
                frame[i, j] = (
                    frames[k, i, 0] * inertia[k, 0, j]
                    + frames[k, i, 1] * inertia[k, 1, j]
                    + frames[k, i, 2] * inertia[k, 2, j]
                )
        for i in range(3):
            for j in range(3):
                tensor[i, j] = (
                    frame[i, 0] * frames[k, j, 0] + frame[i, 1] * frames[k, j, 1] + frame[i, 2] * frames[k, j, 2]
                )
        _cross(spin_rate[k], arm, force, 1.0)
        _cross(w, arm, part, 1.0)
        _cross(w, part, force, 1.0)
        _turned(tensor, w, part)
        _turned(tensor, spin_rate[k], moment)
        _cross(w, part, moment, 1.0)
        for i in range(3):
            force[i] *= mass[k]
            arm[i] += origin[k, i]
        i = k
        while i >= 0:
            for m in range(3):
                linear[i, m] = along[i, m] if slides[i] else 0.0
                part[m] = arm[m] - origin[i, m]
            if not slides[i]:
                _cross(along[i], part, linear[i], 1.0)
                bias[i] += _dot(along[i], moment)
            bias[i] += _dot(linear[i], force)
            i = parent[i]
        i = k
        while i >= 0:
            _turned(tensor, along[i], part)
            j = i
            while j >= 0:
                value = mass[k] * _dot(linear[i], linear[j])
                if not slides[i] and not slides[j]:
                    value += _dot(part, along[j])
                matrix[i, j] += value
                if i != j:
                    matrix[j, i] += value
                j = parent[j]
            i = parent[i]


@numba.njit(cache=True)
def _solved(matrix: Array, force: Array, out: Array) -> None:
    """By Cholesky's factors, in place of the matrix."""
    n = len(force)
    for j in range(n):
        for i in range(j, n):
            total = matrix[i, j]
            for m in range(j):
                total -= matrix[i, m] * matrix[j, m]
            matrix[i, j] = np.sqrt(total) if i == j else total / matrix[j, j]
    for i in range(n):
        out[i] = force[i]
        for m in range(i):
            out[i] -= matrix[i, m] * out[m]
        out[i] /= matrix[i, i]
    for i in range(n - 1, -1, -1):
        for m in range(i + 1, n):
            out[i] -= matrix[m, i] * out[m]
        out[i] /= matrix[i, i]


@numba.njit(cache=True)
def _one_joint(
    q: float, v: float, time: Array, tau: Array, held: bool, inertia: float, a: float, b: float, c: float, viscous: float,
    dry: float, drag: float, soft: float, steps: NDArray[np.int64], out: Array,
) -> None:  # fmt: skip
    for t in range(len(time)):
        out[t] = q
        if t + 1 == len(time):
            break
        m = steps[t]
        h = (time[t + 1] - time[t]) / m
        for i in range(m):
            u0, u1 = tau[t], tau[t]
            if not held:
                slope = (tau[t + 1] - tau[t]) / m
                u0, u1 = tau[t] + slope * i, tau[t] + slope * (i + 1)
            qk, vk, dq, dv = q, v, 0.0, 0.0
            for stage in range(4):
                u = u0 if stage == 0 else u1 if stage == 3 else 0.5 * (u0 + u1)
                force = u - a * np.cos(qk) - b * np.sin(qk) - c
                force -= viscous * vk + dry * np.tanh(vk / soft) + drag * vk * abs(vk)
                acc = force / inertia
                weight = 1.0 if stage == 0 or stage == 3 else 2.0
                dq += weight * vk
                dv += weight * acc
                step = 0.5 * h if stage < 2 else h
                qk, vk = q + step * vk, v + step * acc
            q, v = q + h / 6.0 * dq, v + h / 6.0 * dv


@numba.njit(cache=True)
def _many_joints(
    q: Array, v: Array, time: Array, tau: Array, held: bool, parent: Array, rotation: Array, place: Array, axis: Array,
    slides: Array, mass: Array, com: Array, inertia: Array, gravity: Array, added: Array, constant: Array, viscous: Array,
    dry: Array, drag: Array, soft: Array, steps: NDArray[np.int64], out: Array,
) -> None:  # fmt: skip
    n = len(q)
    frames, vectors = workspace(n)
    matrix, bias, force, acc = np.empty((n, n)), np.empty(n), np.empty(n), np.empty(n)
    qk, vk, dq, dv = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    for t in range(len(time)):
        out[t] = q
        if t + 1 == len(time):
            break
        m = steps[t]
        h = (time[t + 1] - time[t]) / m
        for i in range(m):
            begin, end = (0.0, 0.0) if held else (i / m, (i + 1) / m)
            qk[:], vk[:], dq[:], dv[:] = q, v, 0.0, 0.0
            for stage in range(4):
                share = begin if stage == 0 else end if stage == 3 else 0.5 * (begin + end)
                mass_and_bias(
                    qk,
                    vk,
                    parent,
                    rotation,
                    place,
                    axis,
                    slides,
                    mass,
                    com,
                    inertia,
                    gravity,
                    frames,
                    vectors,
                    matrix,
                    bias,
                )
                for j in range(n):
                    matrix[j, j] += added[j]
                    force[j] = tau[t, j] + share * (tau[t + 1, j] - tau[t, j]) - constant[j] - bias[j]
                    force[j] -= viscous[j] * vk[j] + dry[j] * np.tanh(vk[j] / soft[j]) + drag[j] * vk[j] * abs(vk[j])
                _solved(matrix, force, acc)
                weight = 1.0 if stage == 0 or stage == 3 else 2.0
                step = 0.5 * h if stage < 2 else h
                for j in range(n):
                    dq[j] += weight * vk[j]
                    dv[j] += weight * acc[j]
                    qk[j], vk[j] = q[j] + step * vk[j], v[j] + step * acc[j]
            for j in range(n):
                q[j] += h / 6.0 * dq[j]
                v[j] += h / 6.0 * dv[j]


@dataclass(frozen=True)
class Law:
    """What the practitioner's model says beside the nominal one, each (n,) in SI.

    inertia: factor on each joint's own inertia at zero position. gravity: factor on gravity, one for all. viscous, dry,
    drag: of v, of the smoothed sign of v, of v|v|. zero: what the angle reads too much. constant: a force that the
    joint feels always. soft: speed over which dry friction sets in [rad/s or m/s].
    """

    inertia: Array
    gravity: float
    viscous: Array
    dry: Array
    drag: Array
    zero: Array
    constant: Array
    soft: Array


class Motion:
    """Free runs of a system under a law."""

    def __init__(self, system: System) -> None:
        self.bodies = b = bodies(system)
        self.n = len(b.mass)
        matrix, self.weight = self._at(np.zeros(self.n))
        self.inertia = np.diag(matrix).copy()  # about each joint at zero position, armature included [kg·m² or kg]
        # Gravity's force in one joint: bias at 0, a quarter and half a turn.
        quarter, half = self._at(np.full(self.n, 0.5 * np.pi))[1], self._at(np.full(self.n, np.pi))[1]
        self.cosine, self.level = 0.5 * (self.weight - half), 0.5 * (self.weight + half)
        self.sine = quarter - self.level
        if self.n == 1 and b.slides[0]:
            self.cosine, self.sine, self.level = np.zeros(1), np.zeros(1), self.weight

    def _at(self, q: Array) -> tuple[Array, Array]:
        b = self.bodies
        matrix, bias = np.empty((self.n, self.n)), np.empty(self.n)
        mass_and_bias(
            q, np.zeros(self.n), b.parent, b.rotation, b.place, b.axis, b.slides, b.mass, b.com, b.inertia, b.gravity,
            *workspace(self.n), matrix, bias,
        )  # fmt: skip
        return matrix + np.diag(b.armature), bias

    def run(self, law: Law, state: Array, time: Array, tau: Array | None, *, held: bool = False) -> Array:
        """Positions as they read (T, n), from a state as it reads (2n,); nan where the run leaves all bounds."""
        n, b = self.n, self.bodies
        slope = law.dry / (np.maximum(self.inertia * law.inertia, 1e-12) * law.soft)
        longest = min(STEP, STIFF / max(float(np.max(slope)), 1e-9))
        steps = np.clip(np.ceil(np.diff(time) / longest - 1e-6), 1, MOST_STEPS).astype(np.int64)
        efforts = np.zeros((len(time), n)) if tau is None else np.ascontiguousarray(tau, dtype=np.float64)
        out = np.empty((len(time), n))
        q, v = state[:n] - law.zero, np.array(state[n:], dtype=np.float64)
        if n == 1:
            one = np.empty(len(time))
            g = law.gravity
            _one_joint(
                float(q[0]), float(v[0]), time, efforts[:, 0].copy(), held, float(self.inertia[0] * law.inertia[0]),
                float(g * self.cosine[0]), float(g * self.sine[0]), float(g * self.level[0] + law.constant[0]),
                float(law.viscous[0]), float(law.dry[0]), float(law.drag[0]), float(law.soft[0]), steps, one,
            )  # fmt: skip
            out[:, 0] = one
        else:
            added = b.armature + self.inertia * (law.inertia - 1.0)
            _many_joints(
                q, v, time, efforts, held, b.parent, b.rotation, b.place, b.axis, b.slides, b.mass, b.com, b.inertia,
                law.gravity * b.gravity, added, law.constant, law.viscous, law.dry, law.drag, law.soft, steps, out,
            )  # fmt: skip
        return out + law.zero
