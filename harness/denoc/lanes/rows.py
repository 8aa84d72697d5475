"""From a parameter row to the constants of the recursion: fixed joints merged, frames turned so
that joint axes are z, beams scaled."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

from harness.denoc.compiling.pipeline import Kernel, Part
from harness.denoc.joint_laws import laws as law
from harness.denoc.lanes.nodes import (
    ALPHA,
    CONSTANTS,
    COORDINATE,
    DELTA,
    FIRST,
    GAMMA,
    HEAD,
    KIND,
    MASS,
    MODES,
    PARENT,
    PLANE_F,
    PLANE_H,
    POINTS,
    PRISMATIC,
    ROW,
    SECOND,
    SECTION,
    SIGN,
    TABLE,
    R,
)

BASE_SLOTS = (
    "gravity_x",
    "gravity_y",
    "gravity_z",
    "excitation_amplitude",
    "excitation_frequency",
    "excitation_phase",
    "excitation_x",
    "excitation_y",
    "excitation_z",
)
PLACEMENT_SLOTS = ("x", "y", "z", "turn_x", "turn_y", "turn_z")
INERTIA_SLOTS = (
    "mass",
    "first_x",
    "first_y",
    "first_z",
    "inertia_xx",
    "inertia_yy",
    "inertia_zz",
    "inertia_xy",
    "inertia_xz",
    "inertia_yz",
)
PER_JOINT = len(PLACEMENT_SLOTS) + len(INERTIA_SLOTS)

BEAM_SLOTS = ("payload", "stiffness_factor", "mass_factor", "material_damping", "stiffening")
PAYLOAD, STIFFNESS_FACTOR, MASS_FACTOR, MATERIAL_DAMPING, STIFFENING = range(5)
# Behind the slots with names: directions f and h in the link frame, inertia of the payload about the tip; then, m and
# m² at a time, modal damping ratios (named), stiffness K, damping for a ratio of one of each mode, mass points.
BEAM_AXES, PAYLOAD_INERTIA, BEAM_HEAD = 5, 11, 17

# Columns of the table of joints and their child links: joint that carries the parent link (-1: base), node that the
# child link belongs to (-1: base), section node that the joint rides on or -1, node of the child's beam or -1, its tip
# node, where in a row the child's beam, the joint's section and the joint's law begin.
ABOVE, NODE, SECTION_NODE, BEAM_NODE, TIP_NODE, BEAM_ROW, SECTION_ROW, LAW_ROW = range(8)
LINK_COLUMNS = 8


# Only ``prepare_lane`` calls them, never Python.
_part: Any = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, pipeline_class=Part)


@_part
def _multiply(a: Any, b: Any, out: Any) -> None:
    """out = a b for 3 × 3 matrices."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


@_part
def _rotation(x: float, y: float, z: float, out: Any) -> None:
    """Rotation matrix of a rotation vector [rad] (Rodrigues)."""
    square = x * x + y * y + z * z
    if square < 1e-8:
        a = 1.0 - square / 6.0
        b = 0.5 - square / 24.0
    else:
        angle = math.sqrt(square)
        a = math.sin(angle) / angle
        b = (1.0 - math.cos(angle)) / square
    c = 1.0 - b * square
    out[0, 0] = c + b * x * x
    out[1, 1] = c + b * y * y
    out[2, 2] = c + b * z * z
    out[0, 1] = b * x * y - a * z
    out[1, 0] = b * x * y + a * z
    out[0, 2] = b * x * z + a * y
    out[2, 0] = b * x * z - a * y
    out[1, 2] = b * y * z - a * x
    out[2, 1] = b * y * z + a * x


@_part
def _add_inertia(row: Any, at: int, turn: Any, shift: Any, total: Any) -> None:
    """Add a link's ten inertial parameters to a body's, the link lying at (turn, shift) in the body's link frame."""
    m = row[at]
    h = np.empty(3)
    tensor = np.empty((3, 3))
    for i in range(3):
        h[i] = turn[i, 0] * row[at + 1] + turn[i, 1] * row[at + 2] + turn[i, 2] * row[at + 3]
        tensor[i, i] = row[at + 4 + i]
    tensor[0, 1] = row[at + 7]
    tensor[1, 0] = row[at + 7]
    tensor[0, 2] = row[at + 8]
    tensor[2, 0] = row[at + 8]
    tensor[1, 2] = row[at + 9]
    tensor[2, 1] = row[at + 9]
    half = np.empty((3, 3))
    _multiply(turn, tensor, half)
    dot = h[0] * shift[0] + h[1] * shift[1] + h[2] * shift[2]
    square = shift[0] ** 2 + shift[1] ** 2 + shift[2] ** 2
    total[0] += m
    for i in range(3):
        total[1 + i] += h[i] + m * shift[i]
    for c in range(6):
        i = c if c < 3 else (0 if c < 5 else 1)
        j = c if c < 3 else (1 if c == 3 else 2)
        value = half[i, 0] * turn[j, 0] + half[i, 1] * turn[j, 1] + half[i, 2] * turn[j, 2]
        value -= shift[i] * h[j] + h[i] * shift[j] + m * shift[i] * shift[j]
        if i == j:
            value += 2.0 * dot + m * square
        total[4 + c] += value


@_part
def _prepare_plane(
    tree: Any, plane: Any, mount: Any, offset: Any, frames: Any, total: Any, lane: int, constants: Any, shake: Any
) -> None:
    """The constants of ``lanes.planar``: all in the base's axes X, Y and about N, at zero position."""
    nodes = tree.shape[0]
    pose = np.zeros((nodes, 3, 3))  # plane's axes in each node's link frame, as rows, at zero position
    inertia = np.empty((3, 3))
    for i in range(nodes):
        p = tree[i, PARENT]
        above = pose[p] if p >= 0 else plane
        _multiply(above, mount[i], pose[i])
        k = i * CONSTANTS * 8 + lane
        for a in range(2):
            constants[k + (R + a) * 8] = (
                above[a, 0] * offset[i, 0] + above[a, 1] * offset[i, 1] + above[a, 2] * offset[i, 2]
            )
            first = 0.0
            along = 0.0
            across = 0.0
            for b in range(3):
                first += pose[i, a, b] * total[i, 1 + b]
                along += pose[i, a, b] * frames[i, 2 if tree[i, KIND] == PRISMATIC else 0, b]
                across += pose[i, a, b] * frames[i, 1, b]
            constants[k + (FIRST + a) * 8] = first
            constants[k + (PLANE_F + a) * 8] = along
            constants[k + (PLANE_H + a) * 8] = across
        constants[k + MASS * 8] = total[i, 0]
        for a in range(3):
            inertia[a, a] = total[i, 4 + a]
        inertia[0, 1] = inertia[1, 0] = total[i, 7]
        inertia[0, 2] = inertia[2, 0] = total[i, 8]
        inertia[1, 2] = inertia[2, 1] = total[i, 9]
        second = 0.0
        for a in range(3):
            for b in range(3):
                second += pose[i, 2, a] * inertia[a, b] * pose[i, 2, b]
        constants[k + SECOND * 8] = second
    for at in (0, 5):
        x, y, z = shake[at * 8 + lane], shake[(at + 1) * 8 + lane], shake[(at + 2) * 8 + lane]
        for a in range(3):
            shake[(at + a) * 8 + lane] = plane[a, 0] * x + plane[a, 1] * y + plane[a, 2] * z


@njit(cache=True, error_model="numpy", no_cfunc_wrapper=True, pipeline_class=Kernel)
def prepare_lane(
    row: Any, lane: int, links: Any, tree: Any, axes: Any, nominal: Any, plane: Any, constants: Any, beams: Any, laws: Any,
    shake: Any,
) -> None:  # fmt: skip
    """Write one row's constants into one lane of a group.

    links: one line a joint (with its child link), columns ABOVE …; tree: one line a node, as in ``lanes.nodes``;
    axes: joint axes, shape (joints, 3); nominal: joint rotations, shape (joints, 3, 3); plane: axes X, Y, N of the plane
    of motion in base coordinates, shape (3, 3), read where the tree's SIGN says that there is one.
    """
    joints = links.shape[0]
    nodes = tree.shape[0]
    turn = np.zeros((joints, 3, 3))  # pose of each link in the frame of the node that carries it
    shift = np.zeros((joints, 3))
    mount = np.zeros((nodes, 3, 3))  # pose of each node's link frame in the parent node's link frame, at zero position
    offset = np.zeros((nodes, 3))
    frames = np.zeros((nodes, 3, 3))  # link frame to node frame; of joint nodes only z is known at first
    child = np.full(nodes, -1)
    total = np.zeros((nodes, 10))
    local = np.empty((3, 3))
    placed = np.empty((3, 3))
    whole = np.empty((3, 3))
    move = np.empty(3)
    identity = np.zeros((3, 3))
    zero = np.zeros(3)
    x = np.zeros(3)
    zc = np.zeros(3)
    r = np.empty(3)
    turned = np.zeros(10)
    first: Any = np.int64(0)  # not the literal 0, which would be compiled for separately
    for i in range(3):
        identity[i, i] = 1.0
    for j in range(joints):
        at = len(BASE_SLOTS) + j * PER_JOINT
        _rotation(row[at + 3], row[at + 4], row[at + 5], local)
        _multiply(nominal[j], local, placed)
        up = links[j, ABOVE]
        section = links[j, SECTION_NODE]
        if section >= 0:
            # On a flexible link: what is left of the origin is an offset from the section.
            start = links[up, BEAM_ROW]
            station = row[links[j, SECTION_ROW]]
            _multiply(identity, placed, whole)
            for i in range(3):
                move[i] = row[at + i] - station * row[start + BEAM_AXES + i]
        elif up < 0:
            _multiply(identity, placed, whole)
            for i in range(3):
                move[i] = row[at + i]
        else:
            _multiply(turn[up], placed, whole)
            for i in range(3):
                move[i] = shift[up, i] + (
                    turn[up, i, 0] * row[at] + turn[up, i, 1] * row[at + 1] + turn[up, i, 2] * row[at + 2]
                )
        here = links[j, NODE]
        if links[j, LAW_ROW] >= 0:
            _multiply(identity, whole, mount[here])
            for i in range(3):
                offset[here, i] = move[i]
                frames[here, 2, i] = axes[j, i]
                turn[j, i, i] = 1.0
        else:
            _multiply(identity, whole, turn[j])
            for i in range(3):
                shift[j, i] = move[i]
        if here >= 0:
            _add_inertia(row, at + 6, turn[j], shift[j], total[here])
        beam = links[j, BEAM_NODE]
        if beam >= 0:
            start = links[j, BEAM_ROW]
            tip = links[j, TIP_NODE]
            _multiply(identity, turn[j], mount[beam])
            for i in range(3):
                offset[beam, i] = shift[j, i]
                frames[beam, 0, i] = row[start + BEAM_AXES + i]
                frames[beam, 1, i] = row[start + BEAM_AXES + 3 + i]
            for i in range(3):
                a, b = (i + 1) % 3, (i + 2) % 3
                frames[beam, 2, i] = frames[beam, 0, a] * frames[beam, 1, b] - frames[beam, 0, b] * frames[beam, 1, a]
            total[tip, 0] += row[start + PAYLOAD]
            for i in range(6):
                total[tip, 4 + i] += row[start + PAYLOAD_INERTIA + i]
            _write_beam(row, start, tree[beam, MODES], tree[beam, POINTS], lane, beams, tree[beam, TABLE])
    for i in range(nodes):
        p = tree[i, PARENT]
        if p >= 0 and child[p] < 0:
            child[p] = i
        if tree[i, KIND] == SECTION:
            _multiply(identity, identity, mount[i])
            _multiply(identity, frames[p], frames[i])
            stiffening = row[tree[i, HEAD] + STIFFENING]
            m = tree[i, MODES]
            for k in range(1 + 2 * m + m * m):
                value = row[tree[i, ROW] + k]
                if k > 2 * m:
                    value *= stiffening
                beams[(tree[i, TABLE] + k) * 8 + lane] = value
    for j in range(joints):
        if links[j, LAW_ROW] >= 0:
            c = tree[links[j, NODE], COORDINATE]
            for a in range(law.WIDTH):
                laws[(c * law.WIDTH + a) * 8 + lane] = row[links[j, LAW_ROW] + a]
    for a in range(3):
        shake[a * 8 + lane] = row[a]
        shake[(5 + a) * 8 + lane] = row[3] * row[6 + a]
    shake[3 * 8 + lane] = 2.0 * math.pi * row[4]
    shake[4 * 8 + lane] = row[5]
    if tree[0, SIGN] != 0:
        _prepare_plane(tree, plane, mount, offset, frames, total, lane, constants, shake)
        return
    # Body frames: z along the axis, x across the axes of the body and its first child.
    for i in range(nodes):
        if tree[i, KIND] > PRISMATIC:
            continue
        z = frames[i, 2]
        for a in range(3):
            x[a] = 0.0
        if child[i] >= 0:
            c = child[i]
            for a in range(3):
                zc[a] = (
                    mount[c, a, 0] * frames[c, 2, 0]
                    + mount[c, a, 1] * frames[c, 2, 1]
                    + mount[c, a, 2] * frames[c, 2, 2]
                )
            x[0] = z[1] * zc[2] - z[2] * zc[1]
            x[1] = z[2] * zc[0] - z[0] * zc[2]
            x[2] = z[0] * zc[1] - z[1] * zc[0]
        if x[0] ** 2 + x[1] ** 2 + x[2] ** 2 < 1e-16:
            least = 0
            for a in range(1, 3):
                if abs(z[a]) < abs(z[least]):
                    least = a
            for a in range(3):
                x[a] = 0.0
            x[least] = 1.0
        for _ in range(2):
            along = x[0] * z[0] + x[1] * z[1] + x[2] * z[2]
            for a in range(3):
                x[a] -= along * z[a]
            size = math.sqrt(x[0] ** 2 + x[1] ** 2 + x[2] ** 2)
            for a in range(3):
                x[a] /= size
        for a in range(3):
            frames[i, 0, a] = x[a]
        frames[i, 1, 0] = z[1] * x[2] - z[2] * x[1]
        frames[i, 1, 1] = z[2] * x[0] - z[0] * x[2]
        frames[i, 1, 2] = z[0] * x[1] - z[1] * x[0]
    relative = np.empty((3, 3))
    for i in range(nodes):
        p = tree[i, PARENT]
        _multiply(mount[i], frames[i].T, local)
        if p >= 0:
            _multiply(frames[p], local, relative)
        else:
            _multiply(identity, local, relative)
        # relative = turn about z by gamma · about x by alpha · about z by delta
        gamma = 0.0
        free = p < 0 or child[p] != i or tree[p, KIND] > PRISMATIC
        if free and relative[0, 2] ** 2 + relative[1, 2] ** 2 > 1e-16:
            gamma = math.atan2(relative[0, 2], -relative[1, 2])
        cg = math.cos(gamma)
        sg = math.sin(gamma)
        for a in range(3):
            swap = cg * relative[0, a] + sg * relative[1, a]
            relative[1, a] = cg * relative[1, a] - sg * relative[0, a]
            relative[0, a] = swap
        alpha = math.atan2(-relative[1, 2], relative[2, 2])
        delta = math.atan2(-relative[0, 1], relative[0, 0])
        k = i * CONSTANTS * 8 + lane
        constants[k + ALPHA * 8] = math.cos(alpha)
        constants[k + (ALPHA + 1) * 8] = math.sin(alpha)
        constants[k + DELTA * 8] = math.cos(delta)
        constants[k + (DELTA + 1) * 8] = math.sin(delta)
        constants[k + GAMMA * 8] = cg
        constants[k + (GAMMA + 1) * 8] = sg
        for a in range(3):
            if p >= 0:
                r[a] = frames[p, a, 0] * offset[i, 0] + frames[p, a, 1] * offset[i, 1] + frames[p, a, 2] * offset[i, 2]
            else:
                r[a] = offset[i, a]
        constants[k + R * 8] = cg * r[0] + sg * r[1]
        constants[k + (R + 1) * 8] = cg * r[1] - sg * r[0]
        constants[k + (R + 2) * 8] = r[2]
        for a in range(10):
            turned[a] = 0.0
        _add_inertia(total[i], first, frames[i], zero, turned)
        constants[k + MASS * 8] = turned[0]
        for a in range(3):
            constants[k + (FIRST + a) * 8] = turned[1 + a]
        for a in range(6):
            constants[k + (SECOND + a) * 8] = turned[4 + a]


@_part
def _write_beam(row: Any, start: int, m: int, points: int, lane: int, beams: Any, table: int) -> None:
    """A beam's stiffness, damping and mass points, its factors applied, into one lane of the beams' tables."""
    ratios = start + BEAM_HEAD
    stiffness = ratios + m
    factor = row[start + STIFFNESS_FACTOR]
    material = row[start + MATERIAL_DAMPING]
    for k in range(m * m):
        value = factor * row[stiffness + k]
        beams[(table + k) * 8 + lane] = value
        value *= material
        for r in range(m):
            value += row[ratios + r] * row[stiffness + (r + 1) * m * m + k]
        beams[(table + m * m + k) * 8 + lane] = value
    values = stiffness + (m + 1) * m * m
    scale = math.sqrt(max(row[start + MASS_FACTOR], 0.0))
    size = 2 + m + m * m
    for p in range(points):
        for k in range(size):
            value = scale * row[values + p * size + k]
            if k >= 2 + m:
                value *= row[start + STIFFENING]
            beams[(table + 2 * m * m + p * size + k) * 8 + lane] = value
