"""Writes a case as a user would meet it: a model file and recordings, nothing else."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import tomli_w
from scipy.signal import lfilter

from harness.proof.draw import Case
from harness.proof.rigs import Rig


def nominal_toml(rig: Rig, name: str) -> str:
    """The nominal model as a TOML system."""
    joints, links = [], []
    for k, s in enumerate(rig.segments):
        joints.append(
            {
                "name": s.joint,
                "type": "continuous",
                "parent": "base" if k == 0 else rig.segments[k - 1].link,
                "child": s.link,
                "origin": {"xyz": [0.0, 0.0, 0.0 if k == 0 else -rig.segments[k - 1].length], "rpy": [0.0, 0.0, 0.0]},
                "axis": list(rig.axis),
                "armature": s.armature,
                "damping": s.damping,
            }
        )
        links.append({"name": s.link, "mass": s.mass, "com": [0.0, 0.0, -s.com], "inertia": [s.inertia] * 3})
    return tomli_w.dumps(
        {
            "name": name,
            "gravity": [0.0, 0.0, -rig.gravity],
            "tolerance": rig.tolerance,
            "joint": joints,
            "link": links,
        }
    )


def write_case(case: Case, folder: Path, rng: np.random.Generator) -> None:
    """``model.toml`` and ``run1.csv`` … into the folder; the last run is the one to hold out.

    rng: draws the noise and the jitter of the sampling instants.
    """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.toml").write_text(nominal_toml(case.nominal, "rig"), encoding="utf-8")
    scene = case.scene
    sensor = scene.sensor
    for index, run in enumerate(scene.runs):
        instants = np.arange(0.0, run.duration, 1.0 / sensor.rate)
        if sensor.jitter:
            instants = np.sort(np.maximum(instants + rng.normal(0.0, sensor.jitter, len(instants)), 0.0))
            instants = np.maximum.accumulate(instants + np.arange(len(instants)) * 1e-9)
        data = scene.record(index, instants)
        for column, values in data.items():
            if not column.endswith(".position"):
                continue
            white = rng.normal(0.0, sensor.std, len(values) + 200)
            noise = lfilter([np.sqrt(1.0 - sensor.colour**2)], [1.0, -sensor.colour], white)[200:]
            noisy = values + noise
            if sensor.step:
                noisy = np.round(noisy / sensor.step) * sensor.step
            data[column] = noisy
        frame = pd.DataFrame(data)
        frame.to_csv(folder / f"run{index + 1}.csv", index=False, float_format="%.9g")
