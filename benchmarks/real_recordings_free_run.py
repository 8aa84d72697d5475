"""How well a model runs freely along a recording: from the first sample, and with the initial state fitted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from harness.effects import apply, input_chain, lane_model, lane_row, sensor_chain
from harness.recording import Recording
from harness.system import System

Array = NDArray[np.float64]
Simulate = Callable[[Array, Array, Array | None], Array]  # state (2n,), time (T,), efforts (T, n) -> positions (T, n)

FIRST = 0.03  # s of the recording that its first state is read off from, and at least ten samples
MOST_SAMPLES = 4000  # of a window that the initial state is fitted to


def native(system: System, *, held: bool = False) -> Simulate:
    """Free runs of a system with its attached effects, sensors and inputs included; held: efforts stay from sample to sample."""
    attached = system.attachments
    shaped = replace(system, attachments=())
    for attachment in attached:
        shaped = apply(shaped, attachment)
    model = lane_model(shaped)
    row = lane_row(model, shaped)
    # Coordinates that an effect adds (a compliant base) begin at rest where they are slack.
    seen = [model.names.index(name) for name in system.joint_names]

    def run(state: Array, time: Array, tau: Array | None) -> Array:
        n = len(system.joint_names)
        if tau is not None:
            tau = tau.copy()
            for j, joint in enumerate(system.joint_names):
                for effect, attachment in input_chain(attached, joint):
                    assert effect.input is not None
                    values = effect.values(attachment.parameters)[None]
                    tau[:, j] = effect.input.apply(tau[None, :, j].copy(), time - time[0], values)[0]
        q0, qd0 = np.zeros((1, model.n)), np.zeros((1, model.n))
        q0[0, seen], qd0[0, seen] = state[:n], state[n:]
        if tau is not None:
            every = np.zeros((len(time), model.n))
            every[:, seen] = tau
            tau = every
        q, _, _ = model.simulate(row, q0, qd0, time - time[0], tau=tau, hold="zero" if held else "linear")
        out = q[0][:, seen]
        for j, joint in enumerate(system.joint_names):
            for effect, attachment in sensor_chain(attached, f"{joint}.position"):
                assert effect.sensor is not None
                values = effect.values(attachment.parameters)[None]
                out[:, j] = effect.sensor.apply(out[None, :, j].copy(), time - time[0], values)[0]
        return np.asarray(out)

    return run


def measured(system: System, recording: Recording) -> tuple[Array, Array | None]:
    """Positions (T, n), single samples left out as outliers interpolated, and efforts (T, n), None if it is free."""

    def filled(values: Array) -> Array:
        good = np.isfinite(values)
        return np.interp(recording.time, recording.time[good], values[good])

    positions = np.stack([filled(recording.channel(f"{j}.position").values) for j in system.joint_names], axis=1)
    if not recording.efforts:
        return positions, None
    tau = np.zeros_like(positions)
    for channel in recording.efforts:
        tau[:, system.joint_names.index(channel.site)] = channel.values
    return positions, tau


def first_state(system: System, time: Array, positions: Array) -> Array:
    """Position and velocity at the first sample from a local parabola, (2n,)."""
    count = max(10, int(np.searchsorted(time - time[0], FIRST)))
    fits = [np.polynomial.polynomial.polyfit(time[:count] - time[0], p[:count], 2) for p in positions.T]
    return np.array([f[0] for f in fits] + [f[1] for f in fits])


def free_run(
    simulate: Simulate,
    system: System,
    recording: Recording,
    window: float | None,
    left_out: Sequence[tuple[float, float]] = (),
) -> tuple[float, float]:
    """Position RMSE [rad] of free runs from the first sample and with the initial state fitted.

    window: length [s] of the pieces that a recording is cut into, each run freely; None: the whole of it.
    left_out: stretches of time [s]; pieces that touch one are not judged.
    """
    positions, tau = measured(system, recording)
    time = recording.time
    pieces = 1 if window is None else max(1, round(recording.duration / window))
    edges = np.round(np.linspace(0, len(time), pieces + 1)).astype(int)
    raw: list[Array] = []
    fitted: list[Array] = []
    for a, b in pairwise(edges):
        part, target = time[a:b], positions[a:b]
        if any(part[0] <= last and part[-1] >= first for first, last in left_out):
            continue
        effort = None if tau is None else tau[a:b]
        state = first_state(system, part, target)
        raw.append((simulate(state, part, effort) - target).ravel())
        thin = max(1, len(part) // MOST_SAMPLES)

        def misfit(
            x: Array, part: Array = part, target: Array = target, effort: Array | None = effort, thin: int = thin
        ) -> Array:
            return np.nan_to_num((simulate(x, part, effort) - target)[::thin].ravel(), nan=1e3)

        scale = np.repeat([1e-2, 1e-1], len(state) // 2)
        found = least_squares(misfit, state, x_scale=scale, max_nfev=30)
        fitted.append((simulate(found.x, part, effort) - target).ravel())
    of_raw, of_fitted = (float(np.sqrt(np.mean(np.concatenate(r) ** 2))) for r in (raw, fitted))
    return of_raw, of_fitted
