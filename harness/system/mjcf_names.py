"""What MuJoCo calls the links of a system."""

from __future__ import annotations

from harness.system.description import System

WORLD = "world"


def body_names(system: System) -> dict[str, str]:
    """Every link's body, and the base's: a link keeps its name, but "world" is MuJoCo's own body, on which everything stands."""
    names = {link.name: link.name for link in system.links}
    if WORLD in names:
        free = WORLD
        while free in names:
            free += "_"
        names[WORLD] = free
    return names | {system.base: WORLD}
