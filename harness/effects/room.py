"""How far an effect may take away from what a model states."""

from __future__ import annotations

from dataclasses import replace

from harness.effects.effect import Effect
from harness.system import System

STATED = {"viscous_damping": "damping", "coulomb_friction": "friction"}


def with_room(effect: Effect, system: System, site: str) -> Effect:
    """The effect with room to take away what the model states too much of: its damping or dry friction at a joint.

    Dissipation adds to the model's own, so it may be negative down to where the total vanishes, and no further.
    """
    if effect.name not in STATED:
        return effect
    nominal = float(getattr(system.joint(site), STATED[effect.name]))
    if nominal <= 0.0:
        return effect
    first = effect.parameters[0]
    return replace(effect, parameters=(replace(first, lower=first.lower - nominal), *effect.parameters[1:]))
