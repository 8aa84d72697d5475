"""What the ladder of BAM's friction models says a rig of one joint lacks: the terms of the step that predicts data held
out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from harness.compare.peers.servo_friction import LADDER, Arm, climb
from harness.proof.peers.afternoon_motion import Motion
from harness.proof.peers.runs import NotForIt, as_run, finding
from harness.system import System

OFFSET = 0.01  # rad: they take less for what a mount is off by
# What the terms of a step are in the catalogue; M5 and M6 have no word of their own.
MEANS = {
    "friction_viscous": "viscous_damping", "friction_base": "coulomb_friction", "friction_stribeck": "stribeck_friction",
    "load_friction_base": "load_dependent_friction",
}  # fmt: skip


def arm_of(system: System) -> Arm:
    """What a servo of one joint carries."""
    motion = Motion(system)
    return Arm(float(motion.inertia[0]), float(motion.cosine[0]), float(motion.sine[0]))


def servo_claims(folder: Path) -> dict[str, Any]:
    """Terms that are kept, without intervals, since its fit has none. Raises NotForIt for more than one joint."""
    import harness
    from harness.recording import read_recordings

    system = harness.load(folder / "model.toml")
    if len(system.joint_names) != 1 or system.movable_joints[0].prismatic:
        raise NotForIt("it is for one joint that turns")
    runs = [as_run(system, r) for r in read_recordings(sorted(folder.glob("run*.csv")), system=system)]
    found, errors = climb(arm_of(system), runs[:-1], runs[-1:])
    (joint,) = system.joint_names
    terms = [MEANS[name] for name in LADDER[found.model] if name in MEANS]
    if "stribeck_friction" in terms:
        # The catalogue's word for the one that has the other in it.
        terms.remove("coulomb_friction")
    stated = system.movable_joints[0]
    terms = [t for t in terms if not (t == "viscous_damping" and stated.damping)]
    findings = [finding(name, joint) for name in terms]
    if abs(found.values["offset"]) > OFFSET:
        findings.append(finding("sensor_offset", joint))
    return {
        "findings": findings, "model": found.model, "values": dict(found.values), "errors": errors,
        "heldout_rmse": found.heldout if np.isfinite(found.heldout) else None,
    }  # fmt: skip
