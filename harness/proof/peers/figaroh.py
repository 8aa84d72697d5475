"""What FIGAROH's intervals say a driven rig of one joint lacks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import norm

from harness.compare.peers.figaroh import fit_figaroh
from harness.compare.peers.runs import heldout_error
from harness.effects.scale import swings
from harness.proof.peers.runs import as_run, finding

MEANS = {"fv": "viscous_damping", "fs": "coulomb_friction", "off": "constant_torque"}


def figaroh_claims(folder: Path) -> dict[str, Any]:
    """Friction and offset of the effort whose 95 % intervals, all together, leave out the stated values.

    Raises NotForIt for rigs that swing freely or have more than one joint.
    """
    import harness
    from harness.recording import read_recordings

    system = harness.load(folder / "model.toml")
    runs = [as_run(system, r) for r in read_recordings(sorted(folder.glob("run*.csv")), system=system)]
    found = fit_figaroh(system, runs[:-1], runs[-1:], max(swings(system)) / (2.0 * np.pi))
    joint = system.movable_joints[0]
    wide = float(norm.ppf(1.0 - 0.025 / len(MEANS)))
    findings = []
    for name, effect in MEANS.items():
        # Its offset is a part of the effort, a constant torque beside it has the other sign.
        sign = -1.0 if name == "off" else 1.0
        value, std = sign * found.values.get(f"{name}_{joint.name}", 0.0), found.std.get(f"{name}_{joint.name}", np.inf)
        stated = joint.damping if name == "fv" else joint.friction if name == "fs" else 0.0
        if abs(value - stated) > wide * std > 0.0:
            findings.append(finding(effect, joint.name, value - stated, 1.96 * std))
    return {
        "findings": findings, "values": dict(found.values), "std": dict(found.std), "effort_rmse": found.effort_rmse,
        "effort_held_out": found.prediction, "heldout_rmse": heldout_error(found.free_run, runs[-1:]),
    }  # fmt: skip
