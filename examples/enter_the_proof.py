"""An entrant of the blind proof: what the logarithm of a decay says, with NumPy and SciPy.

``denoc prove --quick --out kept --export cases`` writes sealed cases into ``cases``; then

    python examples/enter_the_proof.py cases claims.json
    denoc prove --score kept --claims claims.json

It looks at free swings of one joint alone. Dry friction f takes 2 f / k off the amplitude in every half-swing, viscous
damping a constant share of it: so losses over amplitudes are a straight line, whose intercept is dry friction and whose
slope is damping. It claims what lies five of its standard errors from the stated model, and nothing of any other case.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.signal import find_peaks

import harness

SURE = 5.0  # standard errors
SMALLEST, LARGEST = 0.05, 0.5  # rad: below it is noise, above it the swing is no linear oscillator


def half_swings(angle: np.ndarray, width: int) -> np.ndarray:
    """Amplitudes [rad] at successive turning points, from the mean of both sides: a zero that is off drops out."""
    smooth = np.convolve(angle, np.ones(width) / width, mode="valid")
    turns = np.sort(np.concatenate([find_peaks(side, prominence=SMALLEST)[0] for side in (smooth, -smooth)]))
    return np.abs(np.diff(smooth[turns])) / 2.0


def claims(folder: Path) -> dict[str, Any]:
    """What one case is said to lack."""
    began = time.perf_counter()
    system = harness.load(folder / "model.toml")
    findings: list[dict[str, Any]] = []
    if len(system.joint_names) == 1 and not system.flexible:
        joint = system.joint(system.joint_names[0])
        model = harness.Denoc(system)
        inertia = float(model.mass_matrix(np.zeros(1))[0, 0])
        stiffness = abs(float(model.gravity(np.array([0.5 * np.pi]))[0]))
        losses, amplitudes = [], []
        for path in sorted(folder.glob("run*.csv"))[:-1]:
            frame = pd.read_csv(path)
            if f"{joint.name}.effort" in frame:
                return {"findings": []}
            step = float(np.median(np.diff(frame["time"])))
            a = half_swings(frame[f"{joint.name}.position"].to_numpy(), max(3, int(0.03 / step)))
            a = a[a < LARGEST]
            losses += list(a[:-1] - a[1:])
            amplitudes += list((a[:-1] + a[1:]) / 2.0)
        if len(losses) >= 6:
            design = np.stack([np.ones(len(losses)), np.array(amplitudes)], axis=1)
            (dry, share), residual, *_ = np.linalg.lstsq(design, np.array(losses), rcond=None)
            variance = float(residual[0]) / (len(losses) - 2) if len(residual) else np.inf
            std = np.sqrt(np.diag(np.linalg.inv(design.T @ design)) * variance)
            rate = np.sqrt(stiffness / inertia)
            # Per half-swing: 2 f / (m g l) in amplitude by dry friction; π c / (2 J ω) of it by viscous damping.
            torque, torque_std = dry * stiffness / 2.0, std[0] * stiffness / 2.0
            factor = 2.0 * inertia * rate / np.pi
            damping, damping_std = share * factor - joint.damping, std[1] * factor
            for effect, parameter, value, deviation in (
                ("coulomb_friction", "torque", torque, torque_std),
                ("viscous_damping", "coefficient", damping, damping_std),
            ):
                if value > SURE * deviation:
                    ends = [value - 1.96 * deviation, value + 1.96 * deviation]
                    estimate = {"value": float(value), "ci95": [float(x) for x in ends]}
                    findings.append({"effect": effect, "site": joint.name, "parameters": {parameter: estimate}})
    return {"findings": findings, "seconds": round(time.perf_counter() - began, 3)}


def main(cases: Path, out: Path) -> None:
    said = {folder.name: claims(folder) for folder in sorted((cases / "cases").iterdir())}
    document = {"schema": "denoc.claims/1", "entrant": "logarithm of the decay", "cases": said}
    out.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    print(f"claimed something of {sum(bool(s['findings']) for s in said.values())} of {len(said)} cases: {out}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit("usage: python examples/enter_the_proof.py CASES CLAIMS.json")
    main(Path(sys.argv[1]), Path(sys.argv[2]))
