"""Beams that twist as well."""

from __future__ import annotations

from dataclasses import replace

from harness.system import System


def with_twist(system: System) -> System:
    """The same system with one torsion mode in every beam."""
    links = []
    for link in system.links:
        if link.beam is not None:
            beam = replace(link.beam, torsion_modes=1, torsional_stiffness=5.0, polar_inertia=1e-3)
            link = replace(link, beam=beam)
        links.append(link)
    return replace(system, links=tuple(links))
