"""Laws of friction fitted to real recordings from Python, beside what a diagnosis says of them by itself.

All are fitted to training recordings alone, and judged as a diagnosis is: from the first sample, and with the initial state fitted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from harness.diagnose.levels.levels import fit_levels
from harness.recording import Recording
from harness.system import Attachment, System

from real_recordings_free_run import free_run, native  # isort: skip

DRY = ("coulomb_friction", "stribeck_friction", "dahl_friction")
ONE_LEVEL = 1e-6  # spread of levels that are all but one
GUESS = 3e-4  # N·m of dry friction from which fits begin


def pooled(system: System, recordings: Sequence[Recording], window: float | None) -> dict[str, float]:
    """Errors over all recordings together [rad]."""
    each = [(free_run(native(system), system, r, window), r.samples) for r in recordings]
    total = sum(n for _, n in each)
    first, fitted = ((sum(e[k] ** 2 * n for e, n in each) / total) ** 0.5 for k in (0, 1))
    return {"first_sample": first, "state_fitted": fitted}


def told(system: System) -> dict[str, dict[str, Any]]:
    """Parameters of what is attached, with their standard deviations, by effect and site."""
    return {
        f"{a.effect}@{a.site}": {k: {"value": v, "std": a.std.get(k)} for k, v in a.parameters.items()}
        for a in system.attachments
    }


def bare(system: System) -> System:
    """The system without stated damping and dry friction."""
    for joint in system.movable_joints:
        system = system.replace_joint(replace(joint, damping=0.0, friction=0.0))
    return system


def at_both_joints(
    system: System, train: Sequence[Recording], heldout: Sequence[Recording], window: float
) -> list[dict[str, Any]]:
    """Viscous damping, dry friction, and both, at every joint of a chain; then both beside zeros that are off.

    window: length [s] of the free runs. A zero is off where an angle reads too much, or a centre of mass lies beside its link.
    """
    joints = system.joint_names
    viscous = [Attachment("viscous_damping", j, {"coefficient": 1e-5}) for j in joints]
    dry = [Attachment("coulomb_friction", j, {"torque": GUESS}) for j in joints]
    zeros = [
        Attachment("com_side_offset", system.joint(joints[0]).child, {"offset": 1e-4}),
        Attachment("sensor_offset", f"{joints[1]}.position", {"offset": 1e-3}),
    ]
    anew = [list(np.arange(window, r.duration - 0.5 * window, window)) for r in train]
    out = []
    for what, attached in (
        ("viscous", viscous), ("dry", dry), ("dry and viscous", dry + viscous),
        ("dry and viscous, zeros off", dry + viscous + zeros),
    ):  # fmt: skip
        start = replace(bare(system), attachments=tuple(attached))
        found = fit_levels(start, train, spread=ONE_LEVEL, anew=anew)
        out.append(
            {
                "what": what, "parameters": told(found.system), "train_rmse": found.rmse,
                "heldout": pooled(found.system, heldout, window),
            }
        )  # fmt: skip
    return out


def with_levels(
    system: System, answer: dict[str, Any], train: Sequence[Recording], heldout: Sequence[Recording]
) -> dict[str, Any]:
    """Dry friction that yields before it slides and is larger in slow motion, at a level of its own in every recording.

    Beside drag, a tilt and an eccentric encoder disc, from four starts that divide the dry friction which the diagnosis found; the
    one that fits the training recordings best counts. The held-out ones are predicted with the last training recording's level.
    """
    joint = system.joint(system.joint_names[0])
    found = {f["effect"]: {k: v["value"] for k, v in f["parameters"].items()} for f in answer["findings"]}
    dry = max(sum(v for k, v in found.get(name, {}).items() if k.endswith("torque")) for name in DRY) or GUESS
    drag = found.get("quadratic_drag", {}).get("coefficient", 0.0)
    starts = []
    for share, speed in product((0.4, 0.8), (1.5, 3.0)):
        slow, gives, way = (1.0 - share) * dry, share * dry, 0.04
        starts.append(
            replace(
                bare(system),
                attachments=(
                    Attachment(
                        "stribeck_friction",
                        joint.name,
                        {"coulomb_torque": slow, "static_torque": slow + 0.4 * dry, "stribeck_velocity": speed},
                    ),
                    Attachment("dahl_friction", joint.name, {"torque": gives, "stiffness": gives / way}),
                    Attachment("quadratic_drag", joint.name, {"coefficient": drag}),
                    Attachment("base_tilt", "base", {"angle": -1e-3}),
                    Attachment(
                        "encoder_interpolation",
                        f"{joint.name}.position",
                        {"amplitude": 2e-3, "periods": 1.0, "phase": 0.0},
                    ),
                ),
            )
        )
    fits = sorted((fit_levels(start, train) for start in starts), key=lambda fit: fit.cost)
    best = fits[0]
    one = min((fit_levels(start, train, spread=ONE_LEVEL) for start in starts), key=lambda fit: fit.cost)
    return {
        "parameters": told(best.system),
        "levels": best.levels,
        "level_std": best.level_std,
        "train_rmse": best.rmse,
        "heldout": pooled(best.system, heldout, None),
        "heldout_each": {r.name: free_run(native(best.system), best.system, r, None) for r in heldout},
        "one_level": {
            "parameters": told(one.system),
            "train_rmse": one.rmse,
            "heldout": pooled(one.system, heldout, None),
        },
        # How far the other starts ended, worse in cost, and what they would have predicted.
        "other_starts": [
            {
                "cost": fit.cost - best.cost,
                "heldout": pooled(fit.system, heldout, None),
            }
            for fit in fits[1:]
        ],
    }
