"""The augmented model as files, and its replay in another engine that can express what was found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.diagnosis import Diagnosis
from harness.effects import effect
from harness.engines.expressed import realised
from harness.engines.registry import availability, engine
from harness.errors import EngineUnavailableError, InputError
from harness.system import System
from harness.system.write import write

Array = NDArray[np.float64]

ENDINGS = (".toml", ".urdf", ".xml")
REPLAYED = 5.0  # s of motion that the engines are compared over
STEP = 1e-3  # s


@dataclass(frozen=True)
class Written:
    """A model file, and what its format could not say."""

    path: Path
    left_out: tuple[str, ...]


def write_augmented(diagnosis: Diagnosis, folder: str | Path) -> tuple[Written, ...]:
    """Write the augmented model as TOML with its uncertainties, and as URDF and MJCF as far as these can say it."""
    if diagnosis.augmented is None:
        return ()
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    out = []
    for ending in ENDINGS:
        path = target / f"augmented{ending}"
        try:
            system = diagnosis.augmented if ending == ".toml" else described(diagnosis.augmented)
            out.append(Written(path, tuple(write(system, path))))
        except InputError as error:
            if ending == ".toml":
                raise
            out.append(Written(path, (f"not written: {error}",)))
    return tuple(out)


def described(system: System) -> System:
    """The system with its effects turned into fields of the description where there are such, the others attached."""
    found = realised(system)
    outside = tuple(a for a in system.attachments if effect(a.effect).side != "dynamics")
    return replace(found, attachments=(*found.attachments, *outside))


def replay(system: System, state: Mapping[str, tuple[float, float]]) -> tuple[dict[str, Any], ...]:
    """Free motion of a system in every installed engine that can express it, against the native one.

    state: position and velocity of the joints at the start, by name. Returns, per engine, the greatest difference of a joint's
    position [rad or m], or the reason why the engine was left out.
    """
    whole = realised(system)
    time = np.arange(0.0, REPLAYED, STEP)
    native = engine("denoc").build(whole)
    n = len(native.names)
    q0, qd0 = np.zeros(n), np.zeros(n)
    for joint, (position, velocity) in state.items():
        q0[native.names.index(joint)], qd0[native.names.index(joint)] = position, velocity
    reference = native.simulate(q0, qd0, time)
    out: list[dict[str, Any]] = []
    for line in availability():
        if line.name == "denoc" or line.version is None:
            continue
        other = engine(line.name)
        reason = other.refuses(whole)
        if reason is not None:
            out.append({"engine": line.name, "difference": None, "note": reason})
            continue
        try:
            moved = other.build(whole).simulate(q0, qd0, time)
        except (InputError, EngineUnavailableError, ValueError) as error:
            out.append({"engine": line.name, "difference": None, "note": str(error)})
            continue
        columns = [j for j in range(len(native.names)) if native.names[j] in moved.names]
        theirs = [moved.names.index(native.names[j]) for j in columns]
        difference = float(np.max(np.abs(reference.position[:, columns] - moved.position[:, theirs])))
        out.append({"engine": line.name, "difference": difference, "note": ""})
    return tuple(out)
