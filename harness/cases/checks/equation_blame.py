"""Which term of the equation of motion, and which number of the description, an engine has otherwise at given states."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from harness.cases.case import NATIVE, Array, Bench
from harness.cases.checks.beam_blame import by_forces
from harness.compare.answers import Completed, Few
from harness.compare.attribution import Attribution, attribute
from harness.compare.closed_blame import blame_closed
from harness.compare.parameters import Explanation, explain
from harness.compare.single_answer import weight_or_spring
from harness.engines.protocol import EngineError, EngineModel
from harness.errors import EngineUnavailableError, InputError, UnsupportedError
from harness.system import System

# Coordinates up to which a number that explains a difference is looked for: the time goes with their square.
MOST_EXPLAINED = 12


@dataclass(frozen=True)
class Told:
    """What is to blame for a difference of two engines.

    words: as a sentence, empty where it cannot be told. place: ``term``, and the link or joint that it is at. agree: whether the
    accelerations agree, so that what fails is no term of the equation of motion.
    """

    words: str = ""
    place: dict[str, object] = field(default_factory=dict)
    agree: bool = False


def blamed(bench: Bench, name: str, q: Array, qd: Array, tau: Array, allowed: float = 1e-10) -> Told:
    """Which term of the native dynamics differs from another engine's; q, qd, tau: states to ask at, shape (B, n).

    The number of the description that would explain it, where one does, stands before the term of the equation of motion.
    """
    said: list[str] = []
    place: dict[str, object] = {}
    if bench.system.loops:
        return _closed(bench, name, q, qd, tau, allowed)
    try:
        ours = bench.models[NATIVE]
        theirs = Completed(bench.models[name], ours)
        found = attribute(theirs, ours, q, qd, tau, allowed=max(allowed, 1e-10), called=(name, NATIVE))
    except (UnsupportedError, EngineError, np.linalg.LinAlgError):
        return Told()
    if not found.blames:
        return Told(agree=found.difference <= allowed)
    found = weight_told_apart(found, theirs, bench.system, q)
    culprit = found.blames[0]
    place = {"term": culprit.term, "at": culprit.coordinate}
    if culprit.term != "solution" and bench.system.flexible:
        told, site = _bent(bench, name, q, qd)
        said += [told] if told else []
        place |= site
    elif culprit.term != "solution":
        explained = _explained(bench, name, q, qd, tau)
        if explained:
            said.append(" or ".join(one.sentence() for one in explained))
            place |= explained[0].place
    said.append(f"{NATIVE} against {name}: {found.sentence()}")
    if culprit.term == "solution":
        part, site = _in_solution(ours, theirs, q, qd, tau)
        said += [part] if part else []
        place |= site
    return Told("; ".join(said), place)


def _in_solution(
    ours: EngineModel, theirs: EngineModel, q: Array, qd: Array, tau: Array
) -> tuple[str, dict[str, object]]:
    """The term that an engine's forward dynamics alone has wrong, worked out from its accelerations."""
    found = [model.forward_dynamics(*state) for model in (ours, theirs) for state in zip(q, qd, tau, strict=True)]
    if not np.isfinite(found).all():
        return "", {}
    for right, wrong in ((theirs, ours), (ours, theirs)):
        alone = Completed(Few(wrong.names, forward_dynamics=wrong.forward_dynamics), right)
        inner = attribute(right, alone, q, qd, tau, derived=True)
        if inner.culprit is not None:
            place: dict[str, object] = {"part": inner.culprit.term, "at": inner.culprit.coordinate}
            return f"in its accelerations {inner.sentence()}", place
    return "", {}


def _closed(bench: Bench, name: str, q: Array, qd: Array, tau: Array, allowed: float) -> Told:
    """The same of a closed mechanism, whose terms at accelerations that would open its loops nobody can ask for."""
    try:
        found = blame_closed(bench.models[name], bench.models[NATIVE], q, qd, tau, allowed=max(allowed, 1e-10))
    except (UnsupportedError, EngineError, np.linalg.LinAlgError):
        return Told()
    if not found.term:
        return Told(agree=True)
    return Told(f"{NATIVE} against {name}: {found.words}", {"term": found.term})


def weight_told_apart(found: Attribution, theirs: Completed, system: System, q: Array) -> Attribution:
    """The same, with gravity blamed as gravity or a spring where springs act that one of the two tells with its weight alone."""
    if not (system.flexible or any(joint.stiffness for joint in system.joints)) or theirs.weighs_apart(q[0]):
        return found
    blames = tuple(weight_or_spring(blame) if blame.term == "gravity" else blame for blame in found.blames)
    return replace(found, blames=blames)


def _bent(bench: Bench, name: str, q: Array, qd: Array) -> tuple[str, dict[str, object]]:
    """The number of a beam, or of what it is mounted on, that would explain a difference of forces."""
    try:
        return by_forces(bench, name, q, qd)
    except (InputError, EngineError, np.linalg.LinAlgError):
        return "", {}


def _explained(bench: Bench, name: str, q: Array, qd: Array, tau: Array) -> list[Explanation]:
    """Numbers of the description that the native engine seems to take otherwise."""
    # Several checks of a case ask, and the answer is one.
    if name not in bench.explained:
        from harness.engines.registry import names

        if name in names():
            found = explained_by(bench.system, bench.models[NATIVE], q, qd, bench.seed, trusted=name)
        else:
            # What a test hands over is not built anew: it is what the trusted one is moved towards.
            own = Completed(bench.models[name], bench.models[NATIVE])
            found = explained_by(bench.system, own, q, qd, bench.seed)
        bench.explained[name] = found
    return bench.explained[name]


def explained_by(
    system: System, other: EngineModel, q: Array, qd: Array, seed: int, *, trusted: str = NATIVE
) -> list[Explanation]:
    """Numbers of the description that would make a trusted engine answer as ``other`` does; none of what is too large or bends.

    q, qd: states to ask at, shape (B, n). seed: of the accelerations that they are asked with.
    """
    if len(system.coordinate_names) > MOST_EXPLAINED or system.flexible or not system.simple:
        return []
    from harness.engines.registry import engine

    rng = np.random.default_rng(seed)
    # As many forces as four times the largest group has numbers.
    count = max(3, -(-40 // qd.shape[1]))
    q, qd = q[:count], qd[:count]
    # Accelerations that have nothing to do with the forces, and velocities too where all are at rest.
    accelerations = rng.standard_normal(qd.shape)
    moving = qd if np.abs(qd).max() > 0.1 else rng.standard_normal(qd.shape)
    try:
        return explain(engine(trusted).build, system, other, q, moving, accelerations)
    except (InputError, EngineError, EngineUnavailableError, np.linalg.LinAlgError):
        return []
