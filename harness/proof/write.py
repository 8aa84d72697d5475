"""Writes a case as a user would meet it: a model file and recordings, nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from io import StringIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from harness.proof.draw import Case
from harness.whole_files import write_folder

Array = NDArray[np.float64]


def write_case(case: Case, folder: Path, rng: np.random.Generator) -> dict[str, dict[str, Array]]:
    """``model.toml`` and ``run1.csv`` … into the folder; the last run is the one to hold out.

    rng: draws the noise and the jitter of the sampling instants. Returns the noise-free columns of every run by its name.
    """
    scene = case.scene
    frames = []
    noise_free = {}
    sensor = scene.sensor
    for index, run in enumerate(scene.runs):
        instants = np.arange(0.0, run.duration, 1.0 / sensor.rate)
        if sensor.jitter:
            instants = np.sort(np.maximum(instants + rng.normal(0.0, sensor.jitter, len(instants)), 0.0))
            instants = np.maximum.accumulate(instants + np.arange(len(instants)) * 1e-9)
        data = scene.record(index, instants)
        noise_free[f"run{index + 1}"] = dict(data)
        for column, values in data.items():
            if column == "time" or column.endswith(".effort"):
                continue
            white = rng.normal(0.0, scene.std(column), len(values) + 200)
            noise = lfilter([np.sqrt(1.0 - sensor.colour**2)], [1.0, -sensor.colour], white)[200:]
            noisy = values + noise
            if sensor.step and column.endswith(".position"):
                noisy = np.round(noisy / sensor.step) * sensor.step
            data[column] = noisy
        frames.append(data)
    # Only now, so that a truth which turns out to have no solution leaves nothing behind.
    runs = {f"run{number}.csv": _table(frame) for number, frame in enumerate(frames, 1)}
    write_folder(folder, {"model.toml": case.nominal.toml(), **runs})
    return noise_free


def _table(frame: Mapping[str, Array]) -> str:
    """Columns as comma-separated values, nine digits each."""
    text = StringIO()
    np.savetxt(
        text, np.column_stack(list(frame.values())), "%.9g", ",", header=",".join(frame), comments="", newline="\n"
    )
    return text.getvalue()
