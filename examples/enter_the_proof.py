"""An entrant of the blind proof: what the logarithm of a decay says, with NumPy and SciPy.

``denoc prove --quick --out kept --export cases`` writes sealed cases into ``cases``; then

    python examples/enter_the_proof.py cases claims.json
    denoc prove --score kept --claims claims.json

It looks at free swings of one joint alone. Between two turning points the energy k (1 - cos a) falls by what friction takes, and
with the nominal weight and inertia that has closed forms at any amplitude: dry friction takes its torque times the angle swept,
viscous damping c an elliptic integral, drag over speed squared (4 k / J) (sin a - a cos a) times its coefficient. It claims the law
that explains the losses best where it lies five of its standard errors from the stated model, lists the laws that explain them as
well as indistinguishable, and claims nothing of any other case. What the model states itself is taken off first, in its joints and
in its ``effect`` list; weight and inertia are known within the stated tolerance, and so is what is reckoned with them.
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
from scipy.special import ellipe, ellipk

import harness

SURE = 5.0  # standard errors
LAWS = (("coulomb_friction", "torque"), ("viscous_damping", "coefficient"), ("quadratic_drag", "coefficient"))
ALSO = (
    "stribeck_friction",
    "dahl_friction",
    "load_dependent_friction",
)  # differ from dry friction within a half-swing alone
AS_WELL = 9.0  # three standard errors, squared: by how much less another law may explain
SEVERAL = 2.0  # tolerances: energy goes with mass times length, speed with the root of weight over inertia
SMALLEST, LARGEST = 0.05, 2.8  # rad: below it is noise, above it the swing hangs at the top


def half_swings(angle: np.ndarray, width: int) -> np.ndarray:
    """Amplitudes [rad] at successive turning points, from the mean of both sides: a zero that is off drops out."""
    smooth = np.convolve(angle, np.ones(width) / width, mode="valid")
    turns = np.sort(np.concatenate([find_peaks(side, prominence=SMALLEST)[0] for side in (smooth, -smooth)]))
    return np.abs(np.diff(smooth[turns])) / 2.0


def friction_work(a: np.ndarray, stiffness: float, inertia: float) -> np.ndarray:
    """What each of ``LAWS`` takes of a half-swing of amplitude a [rad] per unit of its coefficient, (N, 3)."""
    m = np.sin(a / 2.0) ** 2
    viscous = 8.0 * np.sqrt(stiffness / inertia) * (ellipe(m) - (1.0 - m) * ellipk(m))
    drag = 4.0 * stiffness / inertia * (np.sin(a) - a * np.cos(a))
    return np.stack([2.0 * a, viscous, drag], axis=1)


def stated_friction(system: harness.System, joint: str) -> np.ndarray | None:
    """What the model states of each of ``LAWS``, in its joint or as an effect; None where it states anything else."""
    one = system.joint(joint)
    stated = np.array([one.friction, one.damping, 0.0])
    known = dict(LAWS)
    for effect in system.attachments:
        if effect.effect not in known:
            return None
        stated[list(known).index(effect.effect)] += effect.parameters[known[effect.effect]]
    return stated


def best_law(
    joint: str, losses: np.ndarray, taken: np.ndarray, stated: np.ndarray, tolerance: float
) -> list[dict[str, Any]]:
    """One finding or none, of energy lost beside what is stated; tolerance: of one mass or length, the losses are of several."""
    known = taken @ stated
    losses = losses - known
    sizes = np.sum(taken**2, axis=0)
    values = taken.T @ losses / sizes
    left = np.sum((losses[:, None] - taken * values) ** 2, axis=0)
    best = int(np.argmin(left))
    variance = left[best] / (len(losses) - 1)
    value = values[best]
    doubt = SEVERAL * tolerance * (abs(value) + taken[:, best] @ known / sizes[best])
    std = np.hypot(np.sqrt(variance / sizes[best]), doubt)
    if value <= SURE * std:
        return []
    alike = [LAWS[k][0] for k in np.flatnonzero(left - left[best] < AS_WELL * variance) if k != best]
    effect, parameter = LAWS[best]
    if "coulomb_friction" in (effect, *alike):
        alike += ALSO
    ends = [value - 1.96 * std, value + 1.96 * std]
    estimate = {"value": float(value), "ci95": [float(x) for x in ends]}
    return [{"effect": effect, "site": joint, "parameters": {parameter: estimate}, "indistinguishable_from": alike}]


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
        stated = stated_friction(system, joint.name)
        if stated is None:
            return {"findings": []}
        losses, taken = [], []
        for path in sorted(folder.glob("run*.csv"))[:-1]:
            frame = pd.read_csv(path)
            if f"{joint.name}.effort" in frame:
                return {"findings": []}
            step = float(np.median(np.diff(frame["time"])))
            a = half_swings(frame[f"{joint.name}.position"].to_numpy(), max(3, int(0.03 / step)))
            a = a[a < LARGEST]
            before, after = a[:-1], a[1:]
            losses += list(stiffness * (np.cos(after) - np.cos(before)))
            taken += list(friction_work((before + after) / 2.0, stiffness, inertia))
        if len(losses) >= 6:
            findings = best_law(joint.name, np.array(losses), np.array(taken), stated, system.tolerance)
    return {"findings": findings, "seconds": round(time.perf_counter() - began, 3)}


def main(cases: Path, out: Path) -> None:
    said = {folder.name: claims(folder) for folder in sorted((cases / "cases").iterdir())}
    document = {"schema": "denoc.claims/1", "entrant": "energy lost per half-swing", "cases": said}
    out.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    print(f"claimed something of {sum(bool(s['findings']) for s in said.values())} of {len(said)} cases: {out}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit("usage: python examples/enter_the_proof.py CASES CLAIMS.json")
    main(Path(sys.argv[1]), Path(sys.argv[2]))
