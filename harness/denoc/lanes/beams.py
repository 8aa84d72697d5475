"""Flexible links in parameter rows: stiffness, damping, mass points and sections of every beam."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.denoc.beam.integrals import BeamData, Station, beam_data, modal_damping_matrix
from harness.denoc.lanes.nodes import point_size, section_table_size
from harness.denoc.lanes.rows import BEAM_AXES, BEAM_HEAD, BEAM_SLOTS, PAYLOAD_INERTIA, SECTION_ROW
from harness.denoc.recursion.elastic import mass_points
from harness.system import Beam, System
from harness.system.description import Array


def most_points(m: int) -> int:
    """Mass points that m modes in one plane need at most: as many as independent functions 1, x, s_k, H_kl."""
    return 2 + m + m * (m + 1) // 2


def beam_block_size(m: int) -> int:
    """Numbers of a beam in a row: head, modal damping ratios, K and one damping matrix a mode, points, the tip's section."""
    return BEAM_HEAD + m + (m + 1) * m * m + most_points(m) * point_size(m) + section_table_size(m)


def write_beams(row: Array, system: System, slots: Mapping[tuple[str, str], int], links: Array) -> None:
    """Fill the parts of a row (P,) that belong to flexible links; links: the table of joints of ``lanes.rows``."""
    data = {link.name: beam_data(system, link.name) for link in system.links if link.beam is not None}
    for name, beam in data.items():
        described = system.link(name).beam
        assert described is not None
        block = _block(system, described, beam)
        at = slots[name, BEAM_SLOTS[0]]
        row[at : at + len(block)] = block
    for joint, line in zip(system.joints, links, strict=True):
        at = int(line[SECTION_ROW])
        if at >= 0:
            beam = data[joint.parent]
            x = float(np.clip(joint.xyz @ beam.direction, 0.0, beam.length))
            values = _section(beam.at(x))
            row[at : at + len(values)] = values


def _block(system: System, described: Beam, beam: BeamData) -> Array:
    m = beam.coordinates
    points = mass_points(replace(beam, payload=0.0, geometric_stiffening=True))
    # Values of 1, x, s in the first plane, s in the second (none here), H.
    points = np.concatenate([points[:, : 2 + m], points[:, 2 + 2 * m :]], axis=1)
    padded = np.zeros((most_points(m), point_size(m)))
    padded[: len(points)] = points
    ratios = np.zeros(m)
    ratios[: len(described.modal_damping)] = described.modal_damping
    head = np.zeros(BEAM_HEAD)
    head[: len(BEAM_SLOTS)] = [described.payload, 1.0, 1.0, described.material_damping, described.geometric_stiffening]
    head[BEAM_AXES : BEAM_AXES + 6] = np.concatenate([beam.direction, beam.bending])
    payload = beam.payload_inertia
    head[PAYLOAD_INERTIA : PAYLOAD_INERTIA + 6] = payload[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    damping = [_damping_of_mode(system, beam, k) for k in range(m)]
    return np.concatenate([head, ratios, beam.K.ravel(), *damping, padded.ravel(), _section(beam.tip)])


def _damping_of_mode(system: System, beam: BeamData, k: int) -> Array:
    """Damping matrix (m²,) that a ratio of one of mode k stands for; the matrix is linear in the ratios."""
    link = system.link(beam.link)
    assert link.beam is not None
    ratios = tuple(0.5 if i == k else 0.0 for i in range(beam.coordinates))
    changed = system.replace_link(replace(link, beam=replace(link.beam, modal_damping=ratios)))
    return 2.0 * modal_damping_matrix(changed, beam).ravel()


def _section(station: Station) -> Array:
    """A section as the kernels read it: x, s, slope, H."""
    return np.concatenate([[station.x], station.s, station.slope, station.H.ravel()])
