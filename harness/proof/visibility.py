"""How visible a concealed effect is: the distance it moves the recording, in noise, that nothing else could have moved.

The difference between the truth with and without the effect is whitened by the sensor's noise and projected off what
every hypothesis may change anyway: release states, and the rig's data within tolerance. What is left, as a norm, is the
signal-to-noise ratio d of an ideal observer who knows which effect to look for; d² is twice the gain in log-likelihood.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from harness.proof.rigs import Rig
from harness.proof.scene import Scene, Sensor

Array = NDArray[np.float64]

# With d = 5 an ideal observer errs once in a million; we call it the detection limit.
DETECTION_LIMIT = 5.0
RELATIVE_STEP = 1e-4


def whiten(residual: Array, sensor: Sensor) -> Array:
    """Residual in units of independent noise, for white noise, AR(1) noise and quantisation taken as white."""
    std = np.hypot(sensor.std, sensor.step / np.sqrt(12.0))
    if sensor.colour == 0.0:
        return residual / std
    out = residual.copy()
    out[1:] -= sensor.colour * residual[:-1]
    out[1:] /= np.sqrt(1.0 - sensor.colour**2)
    return out / std


def observe(scene: Scene, offset: Mapping[str, float] | None = None, only: int | None = None) -> list[Array]:
    """Whitened noise-free samples of every run (empty where ``only`` names another run)."""
    rows = []
    for index in range(len(scene.runs)):
        if only is not None and index != only:
            rows.append(np.zeros(0))
            continue
        instants = np.arange(0.0, scene.runs[index].duration, 1.0 / scene.sensor.rate)
        data = scene.record(index, instants, offset)
        rows.append(np.concatenate([whiten(data[f"{joint}.position"], scene.sensor) for joint in scene.rig.joints]))
    return rows


def _stack(rows: list[Array]) -> Array:
    return np.concatenate(rows)


def nuisance(make: Callable[[Rig], Scene], rig: Rig) -> tuple[Array, Array]:
    """Whitened sensitivities of what every hypothesis may change, shape (samples, k), and their priors' 1σ, shape (k,).

    make: builds the scene on a rig (so that the rig's data can be varied).
    """
    base = make(rig)
    reference = observe(base)
    columns, sigma = [], []
    for k, s in enumerate(rig.segments):
        # A link heavier than thought has the same shape, so its inertia grows with its mass.
        for names in (("mass", "inertia"), ("length", "com"), ("inertia",), ("damping",), ("armature",)):
            if getattr(s, names[0]) == 0.0:
                continue
            segments = list(rig.segments)
            segments[k] = replace(s, **{n: getattr(s, n) * (1.0 + RELATIVE_STEP) for n in names})
            moved = observe(make(replace(rig, segments=tuple(segments))))
            columns.append((_stack(moved) - _stack(reference)) / RELATIVE_STEP)
            sigma.append(rig.tolerance)
    sizes = [len(r) for r in reference]
    for index in range(len(base.runs)):
        for joint in rig.joints:
            for name in ("q", "v"):
                moved = observe(base, {f"{name}:{joint}": RELATIVE_STEP}, only=index)
                column = np.zeros(sum(sizes))
                start = sum(sizes[:index])
                column[start : start + sizes[index]] = (moved[index] - reference[index]) / RELATIVE_STEP
                columns.append(column)
                sigma.append(np.inf)
    return np.stack(columns, axis=1), np.array(sigma)


def distance(difference: Array, sensitivities: Array, sigma: Array) -> float:
    """Norm of the whitened difference after the best change of the nuisances, their priors included."""
    scale = np.linalg.norm(sensitivities, axis=0)
    scale[scale == 0.0] = 1.0
    prior = np.where(np.isfinite(sigma), 1.0 / (sigma * scale), 0.0)
    a = np.vstack([sensitivities / scale, np.diag(prior)])
    b = np.concatenate([difference, np.zeros(len(sigma))])
    x, *_ = np.linalg.lstsq(a, b, rcond=1e-12)
    return float(np.linalg.norm(b - a @ x))
