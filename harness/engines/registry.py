"""The engines, by name; an engine that is not installed is listed all the same, with how to get it."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import cast

from harness.engines import own
from harness.engines.protocol import Engine
from harness.errors import EngineUnavailableError, InputError

# Name to (module, class): imported when first asked for, so that listing engines loads none of them.
_HOME = {
    "denoc": ("harness.engines.denoc_native", "Native"),
    "pinocchio": ("harness.engines.pinocchio", "Pinocchio"),
    "mujoco": ("harness.engines.mujoco", "Mujoco"),
    "exudyn": ("harness.engines.exudyn_rigid", "Exudyn"),
    "exudyn_ancf": ("harness.engines.exudyn_ancf", "Ancf"),
    "exudyn_ffrf": ("harness.engines.exudyn_ffrf", "Ffrf"),
    "analytic": ("harness.engines.analytic", "Analytic"),
}
# Equations that are known to be wrong: to be had by name, and never asked as a peer.
_NO_PEERS = {"as_printed": ("harness.engines.as_printed", "AsPrinted")}


@dataclass(frozen=True)
class Availability:
    """Whether an engine can be used: its version, or why not and how to get it."""

    name: str
    version: str | None
    reason: str = ""


def names() -> tuple[str, ...]:
    """Names of the engines that are asked for a comparison, the native one first, those of other packages last."""
    return (*_HOME, *own_names())


def own_names() -> tuple[str, ...]:
    """Names of the engines that other packages bring (entry points ``denoc.engines``); ours cannot be replaced by one."""
    return tuple(name for name in own.entry_points() if name not in _HOME and name not in _NO_PEERS)


def every_name() -> tuple[str, ...]:
    """Names of all engines, those that are no peers to anyone included."""
    return (*_HOME, *_NO_PEERS, *own_names())


def engine(name: str) -> Engine:
    """The engine of that name, installed or not; InputError if there is none."""
    if name in own_names():
        return cast(Engine, own.from_entry_point(own.entry_points()[name]))
    homes = {**_HOME, **_NO_PEERS}
    if name not in homes:
        raise InputError(f"no engine is named {name!r}", mend=f"one of {', '.join((*homes, *own_names()))}")
    module, kind = homes[name]
    made: Engine = getattr(import_module(module), kind)()
    return made


def engines() -> tuple[Engine, ...]:
    """All engines, installed or not, the native one first."""
    return tuple(engine(name) for name in names())


def availability() -> tuple[Availability, ...]:
    """One line an engine, for tables: installed with its version, or missing with the reason."""
    lines = []
    for name in names():
        try:
            lines.append(Availability(name, engine(name).version()))
        except EngineUnavailableError as error:
            lines.append(Availability(name, None, str(error)))
    return tuple(lines)


def available() -> tuple[Engine, ...]:
    """The engines that are installed, the native one first."""
    return tuple(engine(line.name) for line in availability() if line.version is not None)
