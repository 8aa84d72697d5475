"""One's own engine held against the others, as an assertion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from harness.cases.case import NATIVE, Case, Check, Row
from harness.cases.checks import StateAgreement, TrajectoryAgreement
from harness.cases.results import Results
from harness.cases.run import run_case, versions
from harness.cases.tolerances import acceleration_allowed
from harness.cases.users import read
from harness.engines import registry
from harness.engines.own import own_engine
from harness.engines.protocol import Engine
from harness.errors import EngineUnavailableError, InputError
from harness.report import words
from harness.system import System

QUANTITIES = ("acceleration", "inverse_dynamics", "mass_matrix", "bias", "gravity", "energy", "trajectory")
WITNESSES = ("pinocchio", "mujoco")
# How far from their neutral positions, and how fast, joints start at most [rad or m, rad/s or m/s]: where weight and springs
# hold them nothing would move, and every integrator would agree.
APART, SPEED = 0.2, 0.5


def assert_dynamics_agree(
    engine: Any,
    model: str | Path | System,
    *,
    quantities: Sequence[str] = QUANTITIES,
    against: Sequence[str] = WITNESSES,
    states: int = 8,
    allowed: float | None = None,
    duration: float = 1.0,
    allowed_trajectory: float = 1e-5,
    step: float | None = 1e-3,
) -> Results:
    """Assert that an engine has the dynamics that the native engine has, at random states and over a free motion.

    engine: an object or class with ``build(system)``, a function from a system to a model (``docs/own_engine.md``), or the
    name of an engine. model: URDF, MJCF or TOML file, or a System. quantities: of ``QUANTITIES``; what the engine has no
    method for is passed over, but one of them it must have. against: engines that vote on who stands alone.
    states: random states, within the joints' limits. allowed: relative difference; rounding of double precision by the
    number of joints unless given. duration [s] of the motion, which starts a little off the neutral positions and moving,
    allowed_trajectory [rad or m] in it, step [s] of fixed ones.
    Returns the rows. Raises AssertionError with the rows that fail, the term of the dynamics to blame and the joint it is at;
    InputError if nothing can be compared.
    """
    # What pytest shows is the line of the test and the message.
    __tracebackhide__ = True
    system = model if isinstance(model, System) else read(Path(model))
    mine = registry.engine(engine) if isinstance(engine, str) else cast(Engine, own_engine(engine))
    name = mine.name
    mine.version()
    reason = mine.refuses(system)
    if reason:
        raise InputError(f"{name} does not take {system.name}: {reason}", mend="give a mechanism that it takes")
    if unknown := [quantity for quantity in quantities if quantity not in QUANTITIES]:
        raise InputError(f"no quantity is named {unknown[0]!r}", mend=f"of {', '.join(QUANTITIES)}")
    engines: dict[str, Engine] = {NATIVE: registry.engine(NATIVE), name: mine}
    for witness in against:
        if witness not in engines and _there(registry.engine(witness), system):
            engines[witness] = registry.engine(witness)
    if name == NATIVE:
        engines = dict(sorted(engines.items(), key=lambda item: item[0] != NATIVE))
    checks = _checks(system, quantities, states, allowed, duration, allowed_trajectory, step)
    case = Case(system.name, system.name, str(system.source or system.name), lambda: system, checks, group="models")
    outcome = run_case(case, engines)
    rows = tuple(row for row in outcome.rows if name in row.engines or name == NATIVE)
    results = Results(rows, outcome.series, versions(), {case.name: case.title}, seconds=outcome.seconds)
    if results.failed:
        raise AssertionError(message(name, system.name, results.failed))
    if not any(row.verdict == "pass" for row in rows):
        said = "; ".join(dict.fromkeys(row.note for row in rows if row.note))
        raise InputError(f"nothing of {name} could be compared: {said}", mend="give it one of the methods")
    return results


def _there(engine: Engine, system: System) -> bool:
    try:
        engine.version()
        return engine.refuses(system) is None
    except EngineUnavailableError:
        return False


def _start(system: System) -> tuple[tuple[tuple[str, float], ...], tuple[tuple[str, float], ...]]:
    """Positions and velocities of the joints at the beginning of the motion, by name; the same ones every time."""
    rng = np.random.default_rng(0)
    position, velocity = [], []
    for joint in system.movable_joints:
        velocity += [(name, SPEED * float(rng.uniform(-1.0, 1.0))) for name in joint.velocity_names]
        # Of a mechanism with loops the positions stay those that the file closes it at.
        if not joint.simple or joint.mimic is not None or system.loops:
            continue
        neutral = float(np.clip(0.0, joint.lower, joint.upper))
        low, high = max(neutral - APART, joint.lower), min(neutral + APART, joint.upper)
        # Not up to the very limits: engines that know them as constraints would push there.
        position.append((joint.name, low + (high - low) * float(rng.uniform(0.05, 0.95))))
    return tuple(position), tuple(velocity)


def _checks(
    system: System,
    quantities: Sequence[str],
    states: int,
    allowed: float | None,
    duration: float,
    line: float,
    step: float | None,
) -> tuple[Check, ...]:
    n = len(system.coordinate_names)
    position, velocity = _start(system)
    usual, why = acceleration_allowed(n)
    exact = "one pass over the links without division: rounding of double precision"
    checks: list[Check] = []
    for quantity in quantities:
        if quantity == "trajectory":
            checks.append(
                TrajectoryAgreement(
                    line, "steps of the engine's own", position, velocity, duration=duration, rate=50.0, step=step
                )
            )
            continue
        conditioned = quantity in ("acceleration", "mass_matrix")
        own = usual if quantity == "acceleration" else 1e-12 if n <= 50 else 1e-11
        check = StateAgreement(quantity, own if allowed is None else allowed, why if conditioned else exact, states)
        checks.append(replace(check, conditioned=conditioned and allowed is None))
    return tuple(checks)


def message(engine: str, system: str, failed: Sequence[Row]) -> str:
    """What an assertion says: a line a row that fails, with where, when and why."""
    lines = [f"{engine} does not have the dynamics of {system}:"]
    for row in failed:
        figure = f"{words.figure(row.difference, verdict=row.verdict)} where {words.figure(row.allowed)} is allowed"
        place = words.divergence(row)
        lines.append(
            f"  {words.quantity(row.quantity)} [{' · '.join(row.engines)}]: {figure}" + (f", {place}" * bool(place))
        )
        lines += [f"    {part}" for part in row.note.split("; ") if part]
    return "\n".join(lines)
