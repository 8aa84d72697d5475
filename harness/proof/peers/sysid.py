"""What ``mujoco.sysid`` claims, run as ``harness.compare.peers.sysid`` says."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import norm

from harness.compare.peers.sysid import ALPHA, WHAT, fit_sysid
from harness.proof.peers.runs import as_run, finding

__all__ = ["fit_sysid", "sysid_claims"]


def sysid_claims(folder: Path) -> dict[str, Any]:
    """What it claims of a folder with ``model.toml`` and ``run*.csv``, the last run left out: ``joint:effect`` by its
    intervals.

    It reports 95 % intervals and no claims. Several parameters are freed, so one interval in twenty of each leaves out
    the truth by chance; a careful reader asks for 95 % that none does (Bonferroni), which is what ``claims`` are.
    ``beyond95`` has those outside of the single intervals.
    """
    import harness
    from harness.recording import read_recordings

    system = harness.load(folder / "model.toml")
    runs = [as_run(system, r) for r in read_recordings(sorted(folder.glob("run*.csv")), system=system)]
    found = fit_sysid(system, runs[:-1])
    tested = sum(name.split(":")[-1] in WHAT for name in found.half)
    wider = float(norm.ppf(1.0 - 0.5 * ALPHA / tested) / norm.ppf(1.0 - 0.5 * ALPHA))

    findings = []
    for name in found.beyond(wider):
        joint, what = name.split(":")
        # Beside what the model states, as the catalogue counts.
        findings.append(finding(WHAT[what], joint, found.values[name] - found.nominal[name], found.half[name]))
    return {
        "findings": findings, "beyond95": found.beyond(), "values": dict(found.values),
        "half95": {k: v if np.isfinite(v) else None for k, v in found.half.items()}, "train_rmse": found.rmse,
        "heldout_rmse": found.predicts(runs[-1:]),
    }  # fmt: skip
