"""All faults planted in turn: in the code, in the description that the native engine gets, and none at all."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from harness.cases.case import NATIVE, Case
from harness.cases.checks import StateAgreement
from harness.cases.gate.accepted import DEFAULT
from harness.cases.gate.defects import Defect, SpoiledEngine
from harness.cases.gate.planted.blamed import Blamed
from harness.cases.gate.planted.copy import PACKAGE, file_of, spoiled_copy
from harness.cases.gate.planted.patch import Patch
from harness.cases.gate.planted.patches import PATCHES
from harness.cases.run import Progress, run_case
from harness.compare.parameters import Group, groups, moved
from harness.engines import registry
from harness.errors import InputError
from harness.journal import Journal
from harness.parallel import parallel_map
from harness.system import System, random_chain, random_tree

CLEAN = 50
# Characters kept of what is said of one.
SAID = 6000
# A kernel in space and one in the plane are compiled anew: minutes on a busy machine.
LONGEST = 1200.0
WHY = "as for every mechanism of this size in the suite"
MECHANISMS: dict[str, Callable[[], System]] = {
    "chain": partial(random_chain, 4, seed=21, prismatic=0.0, armature=True, damping=True),
    "tree": partial(random_tree, 5, seed=23, prismatic=0.3, armature=True, damping=True),
}


@dataclass(frozen=True)
class Fault:
    """What is planted: a patch of the code, or a group of numbers of a mechanism off; neither: a clean run by its seed."""

    name: str
    patch: Patch | None = None
    mechanism: str = ""
    group: Group | None = None
    seed: int = 0


@dataclass(frozen=True)
class Fate:
    """Whether the gate closed, whether it named the fault, and what it said.

    at: the joint, link or channel that had to be named beside the term; empty for a fault that is at none.
    """

    fault: str
    closed: bool
    named: bool
    said: str
    at: str = ""


def faults() -> list[Fault]:
    """All of them, those of the code first: they take longest."""
    found = [Fault(patch.name, patch=patch) for patch in PATCHES]
    for mechanism, build in MECHANISMS.items():
        found += [
            Fault(f"{mechanism}: {group.said()}", mechanism=mechanism, group=group)
            for group in groups(build())
            if _seen(build(), group)
        ]
    return found


def _seen(system: System, group: Group) -> bool:
    """Whether the dynamics hang on a group: where a first joint stands, or what a slider's inertia is, no motion tells."""
    judge = registry.engine("pinocchio").build
    rng = np.random.default_rng(1)
    n = len(system.coordinate_names)
    q, qd, qdd = rng.standard_normal((3, n))
    right = judge(system).inverse_dynamics(q, qd, qdd)
    wrong = judge(moved(system, group, np.full(group.size, 1e-3))).inverse_dynamics(q, qd, qdd)
    return bool(np.abs(wrong - right).max() > 1e-9 * np.abs(right).max())


def full_trials(
    *, workers: int | None = None, progress: Progress | None = None, only: str = "", journal: Journal | None = None
) -> tuple[list[Fate], list[Fate]]:
    """Every fault tried, and the clean runs; only: those whose name contains it; journal: where each is kept as it ends.

    Raises InputError without Pinocchio, which is what the native engine is held against here, and without the accepted
    figures of the suite.
    """
    if not (PACKAGE.parent / DEFAULT).exists():
        raise InputError("the accepted figures of the suite are not here", mend="run in a checkout of the repository")
    registry.engine("pinocchio").version()
    planted = [fault for fault in faults() if only in fault.name]
    for fault in planted:
        if fault.patch is not None:
            file_of(fault.patch)  # not hours later
    clean = [] if only else [Fault(f"clean {seed}", seed=seed) for seed in range(CLEAN)]
    known = {} if journal is None else journal.found
    ended = {fault.name: Fate(**known[key]) for fault in (*planted, *clean) if (key := f"fault {fault.name}") in known}
    count = len(ended)

    def done(_: int, fate: Fate) -> None:
        nonlocal count
        count += 1
        if journal is not None:
            journal.add(f"fault {fate.fault}", vars(fate))
        if progress is not None:
            progress(count, len(planted) + len(clean), fate.fault)

    left = [fault for fault in (*planted, *clean) if fault.name not in ended]
    ended |= {fate.fault: fate for fate in parallel_map(try_fault, left, workers=workers, done=done)}
    fates = [ended[fault.name] for fault in (*planted, *clean)]
    return fates[: len(planted)], fates[len(planted) :]


def try_fault(fault: Fault) -> Fate:
    """One of them."""
    if fault.patch is not None:
        return _in_code(fault.patch)
    if fault.group is not None:
        return _in_description(fault.name, MECHANISMS[fault.mechanism](), fault.group)
    return _clean(fault.name, fault.seed)


def _in_code(patch: Patch) -> Fate:
    with tempfile.TemporaryDirectory(prefix="planted-") as folder:
        place = spoiled_copy(patch, Path(folder))
        environment = {**os.environ, "PYTHONPATH": str(place), "PYTHONDONTWRITEBYTECODE": "1", "OMP_NUM_THREADS": "1"}
        environment.pop("NUMBA_CACHE_DIR", None)
        command = [
            sys.executable,
            "-m",
            "harness.cases.gate.planted.child",
            str(PACKAGE.parent / DEFAULT),
            *patch.cases,
        ]
        try:
            run = subprocess.run(
                command, cwd=place, env=environment, capture_output=True, text=True, check=False, timeout=LONGEST
            )
            found = [
                Blamed(one["key"], tuple(one["terms"]), tuple(one["places"]), one["said"])
                for one in json.loads(run.stdout.strip().splitlines()[-1])
            ]
        except subprocess.TimeoutExpired:
            return Fate(patch.name, False, False, f"no answer in {LONGEST:g} s", patch.expected.at)
        except (IndexError, ValueError):
            # A copy that cannot even run lets nothing through; but nobody is told what it is.
            said = " ".join(run.stderr.split())[-300:]
            return Fate(patch.name, run.returncode != 0, False, said, patch.expected.at)
    said = " | ".join(one.said for one in found)
    return Fate(patch.name, bool(found), patch.expected.met(found), said[:SAID], patch.expected.at)


def _in_description(name: str, system: System, group: Group) -> Fate:
    rng = np.random.default_rng(len(name))
    size = 1e-3 if group.member == "inertia" else 1e-2
    by = size * rng.uniform(0.5, 1.0, group.size)
    spoil: Callable[[System], System] = lambda given: moved(given, group, by)  # noqa: E731
    case = Case(name, name, "planted", lambda: system, (StateAgreement("acceleration", 1e-12, WHY),))
    native: Any = SpoiledEngine(registry.engine(NATIVE), Defect(name, "", "", spoil=spoil))
    rows = run_case(case, {NATIVE: native, "pinocchio": registry.engine("pinocchio")}).rows
    failed = [row for row in rows if row.verdict == "fail"]
    said = "; ".join(row.note for row in failed)
    return Fate(name, bool(failed), group.said() in said, said[:SAID], "" if group.owner == "base" else group.name)


def _clean(name: str, seed: int) -> Fate:
    """The suite's kind of check on another mechanism and other states: the gate must stay open."""
    system = random_tree(6, seed=1000 + seed, prismatic=0.3, armature=True, damping=True)
    checks = tuple(StateAgreement(of, 1e-12, WHY) for of in ("acceleration", "inverse_dynamics", "mass_matrix", "bias"))
    checks = tuple(replace(check, conditioned=check.quantity in ("acceleration", "mass_matrix")) for check in checks)
    case = Case(name, name, "clean", lambda: system, checks)
    engines = {NATIVE: registry.engine(NATIVE), "pinocchio": registry.engine("pinocchio")}
    failed = [row for row in run_case(case, engines).rows if row.verdict == "fail"]
    return Fate(name, bool(failed), False, "; ".join(f"{row.key}: {row.note}" for row in failed)[:SAID])
