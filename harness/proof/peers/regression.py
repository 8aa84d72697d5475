"""Sparse regression on the torque that the nominal model leaves over, as pysindy does it."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.signal import savgol_filter

from harness.proof.peers.runs import finding


def regression_claims(folder: Path) -> dict[str, Any]:
    """Sparse regression (pysindy's sequentially thresholded least squares) on the residual torque along smoothed
    motion."""
    import pysindy

    import harness

    system = harness.load(folder / "model.toml")
    model = harness.Denoc(system)
    frame = pd.read_csv(sorted(folder.glob("run*.csv"))[0])
    time = frame["time"].to_numpy()
    step = float(np.median(np.diff(time)))
    window = max(7, int(0.1 / step) // 2 * 2 + 1)
    grid = np.arange(time[0], time[-1], step)
    q, v, a = (
        np.column_stack(
            [
                savgol_filter(np.interp(grid, time, frame[f"{j}.position"]), window, 4, deriv=d, delta=step)
                for j in system.joint_names
            ]
        )
        for d in (0, 1, 2)
    )
    torque = np.array([model.inverse_dynamics(*row) for row in zip(q, v, a, strict=True)])
    findings = []
    for k, joint in enumerate(system.joint_names):
        effort = np.interp(grid, time, frame[f"{joint}.effort"]) if f"{joint}.effort" in frame else 0.0
        y = effort - torque[:, k]
        terms = {
            "viscous_damping": v[:, k],
            "coulomb_friction": np.sign(v[:, k]),
            "quadratic_drag": v[:, k] * np.abs(v[:, k]),
            "constant_torque": np.ones(len(grid)),
            "joint_stiffness": q[:, k],
            "cubic_stiffness": q[:, k] ** 3,
            "added_inertia": a[:, k],
            "payload_mass": np.sin(q[:, k]),
        }
        library = np.column_stack(list(terms.values()))
        norms = np.linalg.norm(library, axis=0)
        optimizer = pysindy.STLSQ(threshold=0.1 * float(np.linalg.norm(y)), alpha=1e-6)
        with contextlib.redirect_stdout(io.StringIO()):
            optimizer.fit(library / norms, y.reshape(-1, 1))
        kept = np.abs(np.ravel(optimizer.coef_)) > 0.0
        findings += [finding(name, joint) for name, keep in zip(terms, kept, strict=True) if keep]
    return {"findings": findings}
