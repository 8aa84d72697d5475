"""How visible a concealed effect is: the distance it moves the recording, in noise, that nothing else could have moved.

The difference between the truth with and without the effect is whitened by the sensor's noise and projected off what
every hypothesis may change anyway: release states, and the rig's data within tolerance. What is left, as a norm, is the
signal-to-noise ratio d of an ideal observer who knows which effect to look for; d² is twice the gain in log-likelihood.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from harness.proof.rigs import Rig
from harness.proof.scene import Run, Scene, Sensor

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
    out[..., 1:] -= sensor.colour * residual[..., :-1]
    out[..., 1:] /= np.sqrt(1.0 - sensor.colour**2)
    return out / std


def observe(scene: Scene) -> list[Array]:
    """Whitened noise-free samples of every run."""
    rows = []
    for index, run in enumerate(scene.runs):
        instants = np.arange(0.0, run.duration, 1.0 / scene.sensor.rate)
        data = scene.record(index, instants, roughly=True)
        rows.append(np.concatenate([whiten(data[f"{joint}.position"], scene.sensor) for joint in scene.rig.joints]))
    return rows


@dataclass(frozen=True)
class Moves:
    """What every hypothesis may change about a rig's recordings, as numbers around zero.

    segments: per number the segment and the fields that it scales, by its exponential; releases: per further number the run
    and the component of the release state that it shifts. sigma: priors' 1σ, shape (k,).
    """

    segments: tuple[tuple[int, tuple[str, ...]], ...]
    releases: tuple[tuple[int, str], ...]
    sigma: Array

    def moved(self, rig: Rig, z: Array) -> Rig:
        """The rig with its data changed."""
        segments = list(rig.segments)
        for (k, names), value in zip(self.segments, z, strict=False):
            segments[k] = replace(segments[k], **{n: getattr(segments[k], n) * float(np.exp(value)) for n in names})
        return replace(rig, segments=tuple(segments))

    def released(self, run: Run, index: int, z: Array, joints: Sequence[str]) -> Array:
        """A run's release state, positions then velocities."""
        values = zip(self.releases, z[len(self.segments) :], strict=True)
        shift = {name: float(value) for (one, name), value in values if one == index}
        q = [angle + shift.get(f"q:{joint}", 0.0) for angle, joint in zip(run.q0, joints, strict=True)]
        v = [speed + shift.get(f"v:{joint}", 0.0) for speed, joint in zip(run.v0, joints, strict=True)]
        return np.array([*q, *v])


def moves(rig: Rig, runs: int) -> Moves:
    """The nuisances of a rig and so many runs."""
    # A link heavier than thought has the same shape, so its inertia grows with its mass.
    together = (("mass", "inertia"), ("length", "com"), ("inertia",), ("damping",), ("armature",))
    segments = [(k, names) for k, s in enumerate(rig.segments) for names in together if getattr(s, names[0]) != 0.0]
    releases = [(run, f"{name}:{joint}") for run in range(runs) for joint in rig.joints for name in ("q", "v")]
    sigma = np.array([rig.tolerance] * len(segments) + [np.inf] * len(releases))
    return Moves(tuple(segments), tuple(releases), sigma)


EVALUATIONS = 60
FAR = 1e6  # standard deviations, in place of what cannot be simulated


def profiled(
    target: Array,
    simulate: Callable[[Array], Array],
    differentiate: Callable[[Array], Array],
    sigma: Array,
    *,
    start: Array | None = None,
) -> tuple[float, Array]:
    """Distance of a recording from the nearest one that nuisances alone can make, however far they move, and where they end.

    target: whitened samples; simulate: whitened samples at nuisances z; differentiate: their sensitivities there;
    sigma: priors' 1σ. start: nuisances to begin from, zero if not given.
    """
    inverse = np.where(np.isfinite(sigma), 1.0 / sigma, 0.0)

    def misfit(z: Array) -> Array:
        return np.concatenate([np.nan_to_num(simulate(z) - target, nan=FAR, posinf=FAR, neginf=-FAR), z * inverse])

    def slope(z: Array) -> Array:
        return np.vstack([np.nan_to_num(differentiate(z)), np.diag(inverse)])

    first = np.zeros(len(sigma)) if start is None else start
    found = least_squares(misfit, first, jac=slope, x_scale="jac", ftol=1e-5, xtol=1e-9, max_nfev=EVALUATIONS)
    return float(np.sqrt(2.0 * found.cost)), np.asarray(found.x)


def distance(difference: Array, sensitivities: Array, sigma: Array) -> float:
    """Norm of the whitened difference after the best change of the nuisances, their priors included.

    What cannot be simulated (nan) counts as far away, so that it is not mistaken for a size of an effect.
    """
    difference = np.clip(np.nan_to_num(difference, nan=FAR, posinf=FAR, neginf=-FAR), -FAR, FAR)
    scale = np.linalg.norm(sensitivities, axis=0)
    scale[scale == 0.0] = 1.0
    prior = np.where(np.isfinite(sigma), 1.0 / (sigma * scale), 0.0)
    a = np.vstack([sensitivities / scale, np.diag(prior)])
    b = np.concatenate([difference, np.zeros(len(sigma))])
    x, *_ = np.linalg.lstsq(a, b, rcond=1e-12)
    return float(np.linalg.norm(b - a @ x))
