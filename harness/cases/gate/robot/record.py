"""What is kept of a robot: its description, and its dynamics at recorded states, as plain values for JSON."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from harness.cases.case import NATIVE, Bench, Case
from harness.cases.checks.states import evaluate, random_states
from harness.cases.users import read
from harness.engines import registry
from harness.engines.protocol import EngineError, EngineModel
from harness.errors import InputError
from harness.system import Actuator, Beam, Frame, Joint, Link, Stops, System

STATES = 4
DURATION, RATE = 1.0, 20.0
ROUNDING = 1e-12  # relative, of numbers of an actuator
# Quantities recorded at every state; what a robot's mass matrix holds shows in its inverse dynamics.
FIGURES = ("acceleration", "inverse_dynamics", "gravity", "energy")


def record(path: Path, *, allow: Sequence[Path] = ()) -> dict[str, Any]:
    """A robot as it is now.

    ``links`` and ``joints`` by name with every number of the description in SI units (null where a limit is infinite),
    ``gravity``, ``attachments``; what acts in single runs alone (``actuators``, ``stops``, ``keyframes``) and ``loops``, by name;
    random ``states`` inside the joints' limits and ``figures`` of the native dynamics there; ``frequencies`` [Hz] about zero; a
    free ``run`` of one second from the first state. What the native dynamics cannot do is left out, and said in ``left_out``.
    allow: folders beside its own that it may name files in. Raises InputError for an unreadable model.
    """
    system = read(path, allow=allow)
    kept: dict[str, Any] = {
        "links": {
            link.name: _values(link, (f.name for f in fields(Link) if f.name not in ("name", "end")))
            for link in system.links
        },
        "joints": {
            joint.name: _values(joint, (f.name for f in fields(Joint) if f.name != "name")) for joint in system.joints
        },
        "base": system.base,
        "gravity": _plain(system.gravity),
        "attachments": [
            {"effect": a.effect, "site": a.site, "parameters": dict(sorted(a.parameters.items()))}
            for a in system.attachments
        ],
        "actuators": {a.name: _actuator(a) for a in system.actuators},
        "stops": {stop.joint: _stop(stop) for stop in system.limits},
        "keyframes": {frame.name: _values(frame, ("position", "velocity", "command")) for frame in system.keyframes},
        "loops": {
            loop.name: _values(loop, (f.name for f in fields(loop) if f.name != "name")) for loop in system.loops
        },
        "limits_act": system.limits_act,
        "coordinates": list(system.coordinate_names),
        "left_out": [],
    }
    native = registry.engine(NATIVE)
    reason = native.refuses(system)
    if reason:
        kept["left_out"].append(f"its dynamics: {reason}")
        return kept
    model = native.build(system)
    # Drawn by the file's name, so that two recordings of one robot ask at the same states.
    bench = Bench(Case(path.stem, system.name, str(path), lambda: system, ()), system, {NATIVE: model})
    states = random_states(bench, STATES, 1.0, 1.0, 1e-3)
    kept["states"] = {name: _plain(getattr(states, name)) for name in ("q", "qd", "qdd", "tau")}
    kept["figures"] = {quantity: _plain(evaluate(quantity, model, states)) for quantity in FIGURES}
    kept.update(_motion(model, system, np.asarray(states.q[0]), 0.1 * np.asarray(states.qd[0]), kept["left_out"]))
    return kept


def sample_times() -> np.ndarray:
    """When the run is sampled [s]."""
    return np.linspace(0.0, DURATION, round(DURATION * RATE) + 1)


def _motion(model: EngineModel, system: System, q0: Any, qd0: Any, left_out: list[str]) -> dict[str, Any]:
    kept: dict[str, Any] = {}
    try:
        kept["frequencies"] = _plain(model.frequencies(np.zeros(len(q0))))
    except (InputError, EngineError, np.linalg.LinAlgError) as error:
        left_out.append(f"frequencies: {error}")
    try:
        run = model.simulate(q0, qd0, sample_times())
        kept["run"] = {"q0": _plain(q0), "qd0": _plain(qd0), "position": _plain(run.position)}
    except (InputError, EngineError) as error:
        left_out.append(f"run: {error}")
    return kept


def _actuator(actuator: Actuator) -> dict[str, Any]:
    """Its numbers, which were found by trying it: what rounding leaves of one that is zero is zero."""
    kept = _values(actuator, (f.name for f in fields(Actuator) if f.name not in ("name", "note")))
    numbers = [abs(value) for value in kept.values() if isinstance(value, float)]
    floor = ROUNDING * max(numbers, default=0.0)
    return {name: 0.0 if isinstance(x, float) and abs(x) < floor else x for name, x in kept.items()}


def _stop(stop: Stops) -> dict[str, Any]:
    """How soft a limit is, in what does not hang on the mechanism's inertia as well; its ends are the joint's."""
    return {
        "stiffness_over_inertia": _plain(stop.stiffness / stop.inertia),
        "damping_over_inertia": _plain(stop.damping / stop.inertia),
    }


def _values(owner: Any, names: Iterable[str]) -> dict[str, Any]:
    return {name: _plain(getattr(owner, name)) for name in names}


def _plain(value: Any) -> Any:
    """A value as JSON has it; infinities and what is not known are null."""
    if isinstance(value, Beam | Frame):
        return _values(value, (f.name for f in fields(value)))
    if isinstance(value, Mapping):
        return {str(name): _plain(item) for name, item in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, bool) or value is None:
        return value
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, int):
        return value
    return str(value)
