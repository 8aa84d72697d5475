"""The next experiment, where efforts leave something that they cannot tell apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

# Effects that scale everything else the effort is held against.
SCALES = ("actuator_gain", "payload_mass", "added_inertia", "com_offset")


def next_experiment(pairs: Sequence[tuple[str, str]]) -> dict[str, Any]:
    """The experiment that would part what cannot be told apart."""
    for pair in pairs:
        if "actuator_gain" in pair:
            return {
                "what": "hang a known weight on the arm and record again: what it adds to the effort is known, "
                "so that the effort's scale shows",
                "separates": list(pair),
            }
    for pair in pairs:
        if set(pair) <= set(SCALES):
            return {
                "what": "let the arm swing freely, undriven: its period fixes inertia over gravity torque",
                "separates": list(pair),
            }
    for pair in pairs:
        return {"what": "drive slowly through the whole range in both directions, then fast", "separates": list(pair)}
    return {"what": "", "separates": []}
