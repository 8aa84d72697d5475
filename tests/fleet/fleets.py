"""Fleets for the tests: single pendulums, each from its own textbook equation, and answers as a diagnosis would keep them."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "diagnose"))
from simulated_recordings import Rig, nominal, swing

from harness.system.write import write

NOISE = 0.002  # rad


def pendulum(path: Path, seed: int, *, viscous: float = 0.0, dry: float = 0.0) -> Path:
    """One recording: 5 s at 50 Hz from rest at 1 rad."""
    time = np.arange(0.0, 5.0, 0.02)
    angle = swing(Rig(viscous=viscous, dry=dry), 1.0, time)
    angle = angle + NOISE * np.random.default_rng(seed).standard_normal(len(time))
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = "".join(f"{t:.3f},{q:.6f}\n" for t, q in zip(time, angle, strict=True))
    path.write_text("time,pivot.position\n" + rows, encoding="utf-8")
    return path


def model(path: Path) -> Path:
    write(nominal(), path)
    return path


def answer(
    torque: float, *, std: float = 1e-4, grade: str = "established", effect: str = "coulomb_friction"
) -> dict[str, Any]:
    """What is kept of a unit with one effect."""
    number = {"value": torque, "std": std, "ci95": [torque - 2 * std, torque + 2 * std], "unit": "N*m"}
    finding = {"effect": effect, "site": "pivot", "grade": grade, "parameters": {"torque": number},
               "evidence": {"delta_bic": 100.0}, "indistinguishable_from": []}  # fmt: skip
    told = {"verdict": "explained", "complete": True, "findings": [finding]}
    return {"schema": "denoc.unit/1", "unit": "", "files": [], "failed": None, "again": False, "diagnosis": told}
