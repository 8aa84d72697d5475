"""Which shape functions the beams of a system bend in, and why those."""

from __future__ import annotations

from harness.denoc.beam.integrals import beam_data
from harness.system import System


def told_shapes(system: System) -> tuple[str, ...]:
    """One sentence for each choice of shapes, with the links it holds for; empty without flexible links.

    Raises InputError if a beam is not sound.
    """
    links: dict[str, list[str]] = {}
    for link in system.links:
        if link.beam is not None:
            links.setdefault(beam_data(system, link.name).why, []).append(link.name)
    return tuple(f"{', '.join(names)}: {why}" for why, names in links.items())
