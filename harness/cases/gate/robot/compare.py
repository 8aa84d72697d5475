"""A robot held against what was recorded of it: one row a kind of number, and the engines at the recorded states."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Case, Row
from harness.cases.checks.finer import ADAPTIVE, finer, step_of
from harness.cases.checks.states import States, difference_of, evaluate, where
from harness.cases.gate.robot.record import DURATION, FIGURES, sample_times
from harness.cases.run import engine_names
from harness.cases.tolerances import acceleration_allowed
from harness.cases.users import read
from harness.compare import quantities
from harness.compare.divergence_shape import left_line
from harness.compare.parting import Motion, parting
from harness.engines import registry
from harness.engines.protocol import EngineError, EngineModel
from harness.errors import EngineUnavailableError, InputError
from harness.system import System
from harness.system.rotation import to_rpy

RECORDED = "recorded"
SAME = 1e-9
STEP = 2e-4  # s, of engines with a fixed one
WHY = "the same description gives the same numbers; conversions of units and of rotations round"


@dataclass(frozen=True)
class Kind:
    """Numbers of a description that belong to one row; owner: ``links`` or ``joints``; names of its members."""

    quantity: str
    owner: str
    members: tuple[str, ...]


KINDS = (
    Kind("masses", "links", ("mass", "gravcomp")),
    Kind("centres_of_mass", "links", ("com",)),
    Kind("inertias", "links", ("inertia",)),
    Kind("beams", "links", ("beam",)),
    Kind("frames", "joints", ("type", "parent", "child", "xyz", "rotation", "axis", "axis2", "pitch", "mimic")),
    Kind("joint_laws", "joints", ("armature", "damping", "friction", "stiffness", "rest_position")),
    Kind("limits", "joints", ("lower", "upper", "effort", "velocity")),
)
# What a scene has by name beside these.
BESIDE = ("actuators", "stops", "keyframes", "loops")


def of_description(row: Row) -> bool:
    """Whether a row says which number of a model's file is another than was recorded: what others come of."""
    return row.engines == (NATIVE, RECORDED) and "value" in (row.first_divergence or {})


def compare(
    name: str,
    path: Path,
    held: Mapping[str, Any],
    now: Mapping[str, Any],
    engines: Sequence[str],
    *,
    allow: Sequence[Path] = (),
) -> list[Row]:
    """Rows of a robot against what is recorded of it: ``held`` when it was accepted, ``now`` of the file as it is.

    A row of the description tells every number that changed, with both values, and has the first one's link or joint in
    ``first_divergence``. engines: by name, as in ``validate``; allow: folders beside its own that it may name files in.
    Raises InputError if ``held`` is damaged.
    """
    system = read(path, allow=allow)
    bench = Bench(Case(name, system.name, str(path), lambda: system, (), group="models"), system, {})
    try:
        rows = [_described(bench, kind, held, now) for kind in KINDS]
        rows += [_scene(bench, held, now), *_dynamics(bench, system, held, engines)]
    except (KeyError, TypeError, AttributeError, IndexError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"what is recorded of {name} is damaged: {error}", mend="accept the model again, or restore the file"
        ) from error
    return rows


def _described(bench: Bench, kind: Kind, held: Mapping[str, Any], now: Mapping[str, Any]) -> Row:
    before, after = held[kind.owner], now[kind.owner]
    word = kind.owner.removesuffix("s")
    changes: list[tuple[float, str, str, str]] = []
    for name in before.keys() | after.keys():
        if name not in after or name not in before:
            changes.append((1.0, name, "", f"{word} {name!r} is {'gone' if name not in after else 'new'}"))
            continue
        for member in kind.members:
            for label, a, b in _leaves(member, before[name].get(member), after[name].get(member)):
                apart = _apart(a, b)
                if apart > SAME:
                    changes.append((apart, name, label, _changed(label, f"{word} {name!r}", a, b)))
    return _row(bench, kind.quantity, word, changes)


def _changed(label: str, owner: str, a: Any, b: Any) -> str:
    """What changed from what to what: of a tensor the components that did, of a rotation its angles, as in URDF."""
    try:
        x, y = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    except (TypeError, ValueError):
        x = y = np.zeros(0)
    if label == "inertia" and x.shape == y.shape == (3, 3):
        scale = max(np.abs(x).max(), np.abs(y).max())
        pairs = [(i, j) for i in range(3) for j in range(i, 3) if abs(x[i, j] - y[i, j]) > SAME * scale]
        told = ", ".join(f"{'xyz'[i]}{'xyz'[j]} {_said(float(x[i, j]))} → {_said(float(y[i, j]))}" for i, j in pairs)
        return f"inertia of {owner}: {told}"
    if label == "rotation" and x.shape == y.shape == (3, 3):
        before, after = (_said([round(float(angle), 9) + 0.0 for angle in to_rpy(turn)]) for turn in (x, y))
        if before != after:
            return f"rotation of {owner} (roll, pitch, yaw): {before} → {after} rad"
    return f"{label} of {owner}: {_said(a)} → {_said(b)}"


def _leaves(label: str, a: Any, b: Any) -> Iterator[tuple[str, Any, Any]]:
    """Members of nested tables one by one; a list of numbers is one value."""
    if isinstance(a, dict) and isinstance(b, dict):
        for key in a.keys() | b.keys():
            yield from _leaves(f"{label}.{key}", a.get(key), b.get(key))
    else:
        yield label.replace("_", " "), a, b


def _scene(bench: Bench, held: Mapping[str, Any], now: Mapping[str, Any]) -> Row:
    changes = []
    # Files of earlier versions do not say whether limits act, nor what there is beside.
    for member in ("gravity", "base", "attachments", "coordinates", *({"limits_act"} & held.keys())):
        apart = _apart(held[member], now[member])
        if apart > SAME:
            changes.append(
                (apart, "", member, f"{member.replace('_', ' ')}: {_said(held[member])} → {_said(now[member])}")
            )
    for member in BESIDE:
        if member in held:
            changes += _beside(member.removesuffix("s"), held[member], now[member])
    return _row(bench, "scene", "base", changes)


def _beside(word: str, held: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[tuple[float, str, str, str]]:
    """What changed of a kind of things that are kept by name: each that is gone or new, and every number."""
    for name in sorted(held.keys() | now.keys()):
        if name not in now or name not in held:
            yield 1.0, "", word, f"{word} {name!r} is {'gone' if name not in now else 'new'}"
            continue
        for label, a, b in _leaves("", held[name], now[name]):
            if (apart := _apart(a, b)) > SAME:
                yield apart, "", word, f"{label.strip('. ')} of {word} {name!r}: {_said(a)} → {_said(b)}"


def _row(bench: Bench, quantity: str, word: str, changes: list[tuple[float, str, str, str]]) -> Row:
    changes.sort(key=lambda change: (-change[0], change[1], change[2]))
    note = "; ".join(change[3] for change in changes[:6])
    if len(changes) > 6:
        note += f"; and {len(changes) - 6} more"
    place = None
    if changes:
        place = {word: changes[0][1] or "base", "value": changes[0][2]}
    worst = changes[0][0] if changes else 0.0
    return bench.row(quantity, (NATIVE, RECORDED), worst, SAME, why=WHY, note=note, first_divergence=place)


def _apart(a: Any, b: Any) -> float:
    """How far two values are apart, relative to the larger; 1 where they cannot be subtracted."""
    if a == b:
        return 0.0
    try:
        x, y = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    except (TypeError, ValueError):
        return 1.0
    # None becomes nan: a limit that was infinite.
    if x.shape != y.shape or not (np.isfinite(x) == np.isfinite(y)).all():
        return 1.0
    x, y = np.nan_to_num(x), np.nan_to_num(y)
    scale = max(np.abs(x).max(initial=0.0), np.abs(y).max(initial=0.0))
    return float(np.abs(x - y).max(initial=0.0) / scale) if scale > 0.0 else 0.0


def _said(value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        text = ", ".join(_said(item) for item in value[:9]) + (" …" if len(value) > 9 else "")
        return f"[{text}]"
    return str(value)[:80]


def _dynamics(bench: Bench, system: System, held: Mapping[str, Any], engines: Sequence[str]) -> Iterator[Row]:
    """Every engine that takes the robot, at the states that were recorded, against what the native one gave there."""
    if "states" not in held:
        return
    states = States(**{name: np.asarray(held["states"][name], dtype=np.float64) for name in ("q", "qd", "qdd", "tau")})
    if list(system.coordinate_names) != held["coordinates"]:
        yield bench.row(
            "recorded_states",
            (NATIVE, RECORDED),
            1.0,
            0.0,
            why=WHY,
            note="the robot has other coordinates than the recorded one",
        )
        return
    for name, model in _models(system, engines):
        for quantity in FIGURES:
            yield from _figure(bench, name, model, quantity, states, held)
        if name == NATIVE:
            yield from _frequencies(bench, model, held)
        yield from _run(bench, name, model, held)


def _models(system: System, engines: Sequence[str]) -> Iterator[tuple[str, EngineModel]]:
    for name in engine_names(engines or None):
        engine = registry.engine(name)
        try:
            engine.version()
            if engine.refuses(system) is None:
                yield name, engine.build(system)
        except (InputError, EngineUnavailableError):
            continue  # said by the comparison of the engines themselves


def _figure(
    bench: Bench, name: str, model: EngineModel, quantity: str, states: States, held: Mapping[str, Any]
) -> Iterator[Row]:
    try:
        values = evaluate(quantity, model, states)
        mass = np.array([model.mass_matrix(q) for q in states.q]) if quantity == "acceleration" else None
    except (InputError, EngineError):
        return
    recorded = np.asarray(held["figures"][quantity], dtype=np.float64)
    if recorded.shape != values.shape:
        raise ValueError(f"{quantity} has shape {recorded.shape}")
    apart = difference_of(quantity, mass, recorded, values)
    worst = int(np.argmax(apart))
    # Ten times what engines may differ by: that they do is a row of its own.
    allowed = max(SAME, 10.0 * acceleration_allowed(states.q.shape[1])[0])
    place = None if apart[worst] <= allowed else where(bench.system, quantity, worst, recorded[worst], values[worst])
    why = "recorded at these states when the model was accepted; engines and processors round"
    yield bench.row(
        f"recorded_{quantity}", (name, RECORDED), float(apart[worst]), allowed, why=why, first_divergence=place
    )


def _frequencies(bench: Bench, model: EngineModel, held: Mapping[str, Any]) -> Iterator[Row]:
    if "frequencies" not in held:
        return
    before = np.asarray(held["frequencies"], dtype=np.float64)
    after = np.asarray(model.frequencies(np.zeros(len(model.names))))
    note, apart = "", np.inf
    if before.shape == after.shape:
        apart = float(quantities.relative(before[None], after[None])[0]) if len(before) else 0.0
    else:
        note = f"{len(before)} modes swing in the recorded robot, {len(after)} in this one"
    changed = [f"{a:.6g} → {b:.6g} Hz" for a, b in zip(before, after, strict=False) if abs(a - b) > 1e-7 * abs(a)]
    note = "; ".join(filter(None, [note, *changed[:4]])) if apart > 1e-7 else note
    why = "square roots of small eigenvalues, about zero position; recorded when the model was accepted"
    if not np.isfinite(apart):
        apart = 1.0
    yield bench.row("recorded_frequencies", (NATIVE, RECORDED), apart, 1e-7, why=why, note=note)


def _late_friction(bench: Bench, model: EngineModel, q0: Array) -> float:
    """How far a run [rad or m] may be off by dry friction that turns over up to two steps late, as a soft constraint's does.

    For so long it pushes the wrong way, by twice its level, and the velocity that this makes is carried through the run.
    """
    inverse = np.abs(np.linalg.inv(model.mass_matrix(q0)))
    joints = [joint for joint in bench.system.movable_joints if joint.friction and joint.simple]
    pushed = sum(inverse[:, model.names.index(joint.name)].max() * joint.friction for joint in joints)
    return float(2.0 * pushed * 2.0 * STEP * DURATION)


def _recorded(system: System, q0: Array, qd0: Array, time: Array, position: Array) -> Motion:
    """What is recorded, with what the native engine's tolerance leaves open of it."""
    try:
        native = registry.engine(NATIVE).build(system)
        run = native.simulate(q0, qd0, time)
        again = finer(system, NATIVE, native, q0, qd0, run, None)
    except (InputError, EngineError):
        again = None
    if again is not None and again.position is not None:
        again = replace(again, position=position + (again.position - run.position))
    return Motion(RECORDED, position, again)


def _run(bench: Bench, name: str, model: EngineModel, held: Mapping[str, Any]) -> Iterator[Row]:
    if "run" not in held:
        return
    q0, qd0 = (np.asarray(held["run"][key], dtype=np.float64) for key in ("q0", "qd0"))
    time = sample_times()
    try:
        run = model.simulate(q0, qd0, time, step=step_of(name, STEP))
    except (InputError, EngineError):
        return
    found = run.position
    recorded = np.asarray(held["run"]["position"], dtype=np.float64)
    if recorded.shape != found.shape:
        raise ValueError(f"the run has shape {recorded.shape}")
    apart = np.abs(found - recorded)
    # Fixed steps are certain to less than adaptive ones; the motion is short, so that neither is amplified far.
    allowed = 1e-7 if name in ADAPTIVE else 1e-5 + _late_friction(bench, model, q0)
    place: dict[str, object] | None = None
    note = ""
    if not apart.max() <= allowed:
        again = finer(bench.system, name, model, q0, qd0, run, step_of(name, STEP))
        held_to = _recorded(bench.system, q0, qd0, time, recorded)
        parted = parting(time, held_to, Motion.of(name, run, again, run.position_names), allowed)
        note = parted.words
        place = left_line(time, run.position_names, recorded, found, allowed, parted.begins)
        place = {**(place or {}), **parted.place(time)}
    why = "the free motion of one second that was recorded when the model was accepted"
    yield bench.row(
        "recorded_trajectory",
        (name, RECORDED),
        float(apart.max()),
        allowed,
        unit="rad",
        why=why,
        note=note,
        first_divergence=place,
    )
