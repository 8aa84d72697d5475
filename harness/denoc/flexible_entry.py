"""Entries from Python into the recursions for trees with flexible links: plain vectors in, a status out."""

from __future__ import annotations

from typing import Any

from harness.denoc import flexible
from harness.denoc.binding import (
    BODIES,
    COORDINATES,
    NOT_PLAIN,
    elastic_of,
    header_at,
    rows_of,
    topology_of,
    vector_at,
    vector_data,
)
from harness.denoc.compiled import compiled
from harness.denoc.rigid_entry import finite


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
    status = flexible.forward_dynamics(
        header[BODIES],
        rows_of(header),
        topology_of(header),
        elastic_of(header),
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
    d, t, e = rows_of(header), topology_of(header), elastic_of(header)
    position, velocity, out = vector_at(at_q, n), vector_at(at_qd, n), vector_at(at_tau, n)
    flexible.inverse_dynamics(header[BODIES], d, t, e, position, velocity, vector_at(at_qdd, n), out)
    flexible.subtract_passive(header[BODIES], d, t, e, position, velocity, out)
    return finite(out, n)
