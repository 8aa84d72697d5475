"""Three recordings of a pendulum whose bearing has dry friction that its model does not know; see docs/diagnosis.md.

SciPy integrates the textbook's equation, so that nothing of the diagnosis's own dynamics is in the recordings.

    python examples/worked_diagnosis.py FOLDER
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

INERTIA = 1.775e-3 + 0.200 * 0.165**2  # about the pivot [kg·m²], of the comment in models/urdf/rigid_pendulum.urdf
MOMENT = 0.200 * 9.80665 * 0.165  # weight times arm [N·m]
VISCOUS = 1.9e-3  # [N·m·s/rad], which the model states
FRICTION = 4.0e-3  # [N·m], which it lacks
NOISE = 1.0e-3  # of the angle sensor [rad]
RATE, DURATION = 200.0, 5.0  # [Hz], [s]
RELEASES = (1.2, 0.6, 0.9)  # [rad], at rest; the last recording is held out


def recorded(release: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Time [s] and angle [rad] as the sensor reads it. Friction is smoothed over 2 mrad/s, below any speed that matters here."""
    time = np.arange(int(DURATION * RATE)) / RATE

    def rate_of(_: float, y: np.ndarray) -> list[float]:
        friction = FRICTION * np.tanh(y[1] / 2e-3)
        return [y[1], (-MOMENT * np.sin(y[0]) - VISCOUS * y[1] - friction) / INERTIA]

    true = solve_ivp(rate_of, (0.0, DURATION), [release, 0.0], t_eval=time, method="LSODA", rtol=1e-8, atol=1e-10).y[0]
    return time, true + NOISE * np.random.default_rng(seed).standard_normal(len(time))


def main() -> None:
    """Write run1.csv, run2.csv and run3.csv."""
    parser = argparse.ArgumentParser(description="recordings of a pendulum with concealed friction")
    parser.add_argument("folder", type=Path)
    chosen = parser.parse_args()
    chosen.folder.mkdir(parents=True, exist_ok=True)
    for number, release in enumerate(RELEASES, start=1):
        time, angle = recorded(release, seed=number)
        with (chosen.folder / f"run{number}.csv").open("w", newline="") as file:
            rows = csv.writer(file)
            rows.writerow(["time", "pivot.position"])
            rows.writerows((f"{t:.3f}", f"{a:.6f}") for t, a in zip(time, angle, strict=True))


if __name__ == "__main__":
    main()
