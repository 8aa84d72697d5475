"""The gate tried on defects planted in the native engine: each must be caught, and called by its name."""

from __future__ import annotations

from dataclasses import dataclass
from textwrap import shorten
from typing import Any

import numpy as np

from harness.cases.case import NATIVE, Bench, Case, Row
from harness.cases.checks import StateAgreement, TrajectoryAgreement
from harness.cases.checks.states import random_states
from harness.cases.gate.defects import DEFECTS, Defect, SpoiledEngine
from harness.cases.run import Progress, run_case
from harness.compare.attribution import attribute
from harness.engines import registry
from harness.engines.protocol import Engine
from harness.errors import EngineUnavailableError, InputError
from harness.journal import Journal
from harness.system import System, random_chain

# Of the faults of the full self-test; what two sites explain alike is named by either.
ENOUGH_NAMED = 0.9
# Characters of what is said of one that is missed.
TOLD = 400
WHY = "as for every mechanism of this size in the suite"


def system() -> System:
    """Five joints in general position, with armature and damping, so that every term has something to say."""
    return random_chain(5, seed=5, prismatic=0.2, armature=True, damping=True)


CASE = Case(
    name="self_test",
    title="Random chain of five joints",
    source="independent engines",
    system=system,
    checks=(
        StateAgreement("acceleration", 1e-12, WHY),
        StateAgreement("mass_matrix", 1e-12, WHY),
        StateAgreement("bias", 1e-12, WHY),
        TrajectoryAgreement(1e-8, WHY, duration=1.0, rate=50.0, step=2e-4),
    ),
    group="self_test",
)


@dataclass(frozen=True)
class Trial:
    """One planted defect: whether a row failed because of it, whether it was called by its name, and what was said.

    at: the joint, body or channel that had to be named beside the term; empty for a defect that is at none, or at all alike.
    """

    defect: str
    caught: bool
    named: bool
    said: str
    at: str = ""

    def fate(self) -> str:
        """What became of one that was missed, in a line."""
        return f"caught, but said to be: {shorten(self.said, TOLD, placeholder=' …')}" if self.caught else "not caught"


@dataclass(frozen=True)
class SelfTest:
    """All trials; ``clean``: whether runs without a defect pass, and how many of them there were.

    enough: share of the defects that must be named; every one must be caught.
    """

    clean: bool
    trials: tuple[Trial, ...]
    enough: float = 1.0
    clean_runs: int = 1

    @property
    def ok(self) -> bool:
        named = sum(trial.named for trial in self.trials)
        return self.clean and all(trial.caught for trial in self.trials) and named >= self.enough * len(self.trials)

    def count(self, *, placed: bool) -> tuple[int, int]:
        """How many are named, and of how many: of the defects that are at a joint, body or channel, or of those at none."""
        chosen = [trial for trial in self.trials if bool(trial.at) is placed]
        return sum(trial.named for trial in chosen), len(chosen)

    def sentence(self) -> str:
        """The counts in words."""
        planted, caught = len(self.trials), sum(trial.caught for trial in self.trials)
        (placed, of_placed), (term, of_term) = self.count(placed=True), self.count(placed=False)
        runs = "run" if self.clean_runs == 1 else "runs"
        passed = "left the gate open" if self.clean else "did not all leave the gate open"
        return (
            f"{planted} defects planted, {caught} caught, {placed + term} named: {placed} of {of_placed} by term and joint or "
            f"body, {term} of the {of_term} that are at none by their term; {self.clean_runs} {runs} without a defect {passed}"
        )

    def as_dict(self) -> dict[str, Any]:
        """``planted``, ``caught`` and ``named`` are counts; ``named_with_place`` and ``named_by_term`` pairs of named and asked."""
        return {
            "planted": len(self.trials),
            "caught": sum(trial.caught for trial in self.trials),
            "named": sum(trial.named for trial in self.trials),
            "named_with_place": list(self.count(placed=True)),
            "named_by_term": list(self.count(placed=False)),
            "clean_passes": self.clean,
            "clean_runs": self.clean_runs,
            "defects": [vars(trial) for trial in self.trials],
        }


def self_test(
    *,
    full: bool = False,
    workers: int | None = None,
    progress: Progress | None = None,
    journal: Journal | None = None,
) -> SelfTest:
    """Plant every defect in turn; raises InputError if no engine is installed that could notice.

    full: also every fault of ``harness.cases.gate.planted`` (some minutes: kernels are compiled with faults in them), and
    runs without one, which must not close the gate. journal: keeps each as it ends, so that an interrupted one goes on.
    """
    native, judge = registry.engine(NATIVE), _independent()
    clean = all(row.verdict != "fail" for row in _rows(native, judge))
    trials = [_try(defect, native, judge) for defect in DEFECTS]
    if not full:
        return SelfTest(clean, tuple(trials))
    from harness.cases.gate.planted.full import full_trials

    planted, runs = full_trials(workers=workers, progress=progress, journal=journal)
    trials += [Trial(fate.fault, fate.closed, fate.named, fate.said, fate.at) for fate in planted]
    return SelfTest(clean and not any(fate.closed for fate in runs), tuple(trials), ENOUGH_NAMED, len(runs) + 1)


def _independent() -> Engine:
    for name in ("pinocchio", "mujoco"):
        try:
            engine = registry.engine(name)
            engine.version()
            return engine
        except EngineUnavailableError:
            continue
    raise InputError("the gate's self-test needs an independent engine", mend="install pin or mujoco: see denoc doctor")


def _rows(native: Any, judge: Engine) -> tuple[Row, ...]:
    return run_case(CASE, {NATIVE: native, judge.name: judge}).rows


def _try(defect: Defect, native: Engine, judge: Engine) -> Trial:
    spoiled = SpoiledEngine(native, defect)
    failed = [row for row in _rows(spoiled, judge) if row.verdict == "fail"]
    said = "; ".join(dict.fromkeys(row.note for row in failed if row.note))
    named = bool(failed) and _blamed(spoiled, judge) == defect.term and defect.words in said and defect.at in said
    return Trial(defect.name, bool(failed), named, said, defect.at)


def _blamed(spoiled: SpoiledEngine, judge: Engine) -> str:
    """The term that attribution puts first, or nothing."""
    true = system()
    wrong, right = spoiled.build(true), judge.build(true)
    states = random_states(Bench(CASE, true, {judge.name: right}), 8, 1.0, 1.0, 0.0)
    if not np.isfinite(wrong.forward_dynamics(states.q[0], states.qd[0], states.tau[0])).all():
        return ""
    found = attribute(right, wrong, states.q, states.qd, states.tau, allowed=1e-10)
    return found.culprit.term if found.culprit is not None else ""
