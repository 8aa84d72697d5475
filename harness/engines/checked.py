"""Checks before a system or a state is handed to an engine, because engines take NaN, wrong sizes and infinities without a word."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import metadata

import numpy as np
from numpy.typing import ArrayLike

from harness.engines.protocol import Array, EngineError
from harness.errors import EngineUnavailableError, InputError, UnsupportedError, install
from harness.system import System


def raise_if_refused(system: System, reason: str | None) -> None:
    """UnsupportedError with an engine's reason why it cannot express the system, unless that is None."""
    if reason:
        raise UnsupportedError(reason, source=system.source)


def no_dry_friction(who_has: str, system: System) -> None:
    """UnsupportedError if a joint has dry friction, for an engine without; who_has: as in "Pinocchio has"."""
    sticky = [joint.name for joint in system.movable_joints if joint.friction]
    if sticky:
        raise UnsupportedError(
            f"{who_has} no dry friction, joint {sticky[0]} has", mend="simulate with denoc or mujoco"
        )


def vector(name: str, value: ArrayLike, n: int) -> Array:
    """``value`` as a contiguous float array of shape (n,); InputError if it has another size or is not finite."""
    array = np.ascontiguousarray(value, dtype=np.float64)
    if array.shape != (n,):
        raise InputError(f"{name} has shape {array.shape}, the system has {n} coordinates", mend=f"pass shape ({n},)")
    if not np.all(np.isfinite(array)):
        raise InputError(
            f"{name}[{int(np.argmin(np.isfinite(array)))}] is not finite", mend="remove NaN and infinities"
        )
    return array


def vectors(n: int, **values: ArrayLike) -> Iterator[Array]:
    """The named values in turn, each checked by ``vector``."""
    return (vector(name, value, n) for name, value in values.items())


def sample_times(time: ArrayLike) -> Array:
    """``time`` as an increasing float array, shape (T,), T ≥ 1; InputError otherwise."""
    array = np.ascontiguousarray(time, dtype=np.float64)
    if array.ndim != 1 or array.size == 0:
        raise InputError(f"time has shape {array.shape}", mend="pass one increasing sequence of seconds")
    if not np.all(np.isfinite(array)) or np.any(np.diff(array) <= 0.0):
        raise InputError("time does not increase strictly", mend="sort the samples and drop repeated ones")
    return array


def held_forces(tau: ArrayLike | None, samples: int, n: int) -> Array | None:
    """Applied forces as shape (T, n), each row held until the next sample; (n,) is held throughout; None stays None."""
    if tau is None:
        return None
    array = np.ascontiguousarray(tau, dtype=np.float64)
    if array.shape == (n,):
        array = np.ascontiguousarray(np.broadcast_to(array, (samples, n)))
    if array.shape != (samples, n):
        raise InputError(f"tau has shape {array.shape}", mend=f"pass shape ({samples}, {n}): one row a sample")
    if not np.all(np.isfinite(array)):
        raise InputError("tau is not finite", mend="remove NaN and infinities")
    return array


def positive_step(step: float | None) -> float | None:
    """``step`` [s] if it is None or positive; InputError otherwise."""
    if step is not None and not (np.isfinite(step) and step > 0.0):
        raise InputError(f"step is {step}", mend="pass a positive number of seconds")
    return step


def finite_result(engine: str, quantity: str, answer: ArrayLike) -> Array:
    """``answer`` as an array, or EngineError if the engine answered with NaN or infinity."""
    value = np.asarray(answer, dtype=np.float64)
    if not np.all(np.isfinite(value)):
        raise EngineError(f"{engine} answered {quantity} with NaN or infinity: the mass matrix is singular there")
    return value


def installed_version(distribution: str, package: str) -> str:
    """Version of an installed distribution; EngineUnavailableError that says how to get it otherwise."""
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        how = "pip install mujoco" if distribution == "mujoco-core" else install("engines")
        raise EngineUnavailableError(f"{package} is not installed: {how}") from None
