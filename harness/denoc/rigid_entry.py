"""Entries from Python into the recursions for rigid trees: plain vectors in, a status out."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.denoc import rigid
from harness.denoc.binding import (
    BODIES,
    COORDINATES,
    NOT_FINITE,
    NOT_PLAIN,
    header_at,
    rows_of,
    topology_of,
    vector_at,
    vector_data,
)
from harness.denoc.compiled import compiled
from harness.denoc.rows import DAMPING, REST, STIFFNESS


@compiled
def forward_dynamics(model: int, q: Any, qd: Any, tau: Any, qdd: Any) -> int:
    header = header_at(model)
    at_q, at_qd, at_tau, at_qdd = (
        vector_data(q, header),
        vector_data(qd, header),
        vector_data(tau, header),
        vector_data(qdd, header),
    )
    if at_q == 0 or at_qd == 0 or at_tau == 0 or at_qdd == 0:
        return NOT_PLAIN
    n = header[COORDINATES]
    out = vector_at(at_qdd, n)
    status = rigid.forward_dynamics(
        header[BODIES],
        rows_of(header),
        topology_of(header),
        vector_at(at_q, n),
        vector_at(at_qd, n),
        vector_at(at_tau, n),
        out,
    )
    return status if status > 0 else finite(out, n)


@compiled
def inverse_dynamics(model: int, q: Any, qd: Any, qdd: Any, tau: Any) -> int:
    header = header_at(model)
    at_q, at_qd, at_qdd, at_tau = (
        vector_data(q, header),
        vector_data(qd, header),
        vector_data(qdd, header),
        vector_data(tau, header),
    )
    if at_q == 0 or at_qd == 0 or at_qdd == 0 or at_tau == 0:
        return NOT_PLAIN
    n = header[COORDINATES]
    d = rows_of(header)
    position, velocity, out = vector_at(at_q, n), vector_at(at_qd, n), vector_at(at_tau, n)
    rigid.inverse_dynamics(header[BODIES], d, topology_of(header), position, velocity, vector_at(at_qdd, n), out)
    for i in range(n):
        out[i] += d[i + 1, DAMPING] * velocity[i] + d[i + 1, STIFFNESS] * (position[i] - d[i + 1, REST])
    return finite(out, n)


@compiled
def finite(out: Any, n: int) -> int:
    """0, or NOT_FINITE if any element is infinite or no number."""
    total = 0.0
    for i in range(n):
        total += out[i] * 0.0
    return 0 if np.isfinite(total) else NOT_FINITE
