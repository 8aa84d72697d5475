"""What sparse regression on the torque left over keeps, as claims."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from harness.compare.peers.torque_regression import fit_regression
from harness.proof.peers.runs import as_run, finding


def regression_claims(folder: Path) -> dict[str, Any]:
    """Terms that are kept, without intervals, since its fit has none."""
    import harness
    from harness.recording import read_recordings

    system = harness.load(folder / "model.toml")
    runs = [as_run(system, r) for r in read_recordings(sorted(folder.glob("run*.csv")), system=system)]
    found = fit_regression(system, runs[:-1], runs[-1:])
    findings = [finding(name, joint) for joint, kept in found.terms.items() for name in kept]
    heldout = {}
    if len(system.joint_names) == 1:
        from harness.compare.peers.runs import heldout_error

        heldout = {"heldout_rmse": heldout_error(found.free_run, runs[-1:])}
    return {"findings": findings, "values": {j: dict(kept) for j, kept in found.terms.items()}, **heldout}
