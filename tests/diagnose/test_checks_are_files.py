"""Checks, reasons to doubt and ways to rewrite a set are files that the catalogues name; checks are told by their names."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest
from simulated_recordings import Rig, double_pendulum, nominal, releases

from harness import diagnose
from harness.diagnose.criticism import checks as checks_package
from harness.diagnose.criticism import doubts as doubts_package
from harness.diagnose.criticism.check import Asked, Check
from harness.diagnose.criticism.checks.catalogue import checks
from harness.diagnose.criticism.doubts.catalogue import reasons
from harness.diagnose.criticism.reason import Reason
from harness.diagnose.selection import beginnings as beginnings_package
from harness.diagnose.selection import openings as openings_package
from harness.diagnose.selection import rewrites as rewrites_package
from harness.diagnose.selection import scans as scans_package
from harness.diagnose.selection.beginning import Beginning
from harness.diagnose.selection.beginnings.catalogue import beginnings
from harness.diagnose.selection.opening import Opening
from harness.diagnose.selection.openings.catalogue import openings
from harness.diagnose.selection.rewrite import Rewrite, Turn
from harness.diagnose.selection.rewrites.catalogue import rewrites
from harness.diagnose.selection.scan import Scan
from harness.diagnose.selection.scans.catalogue import scans
from harness.effects.catalogue import catalogue


@pytest.mark.parametrize(
    ("package", "kind", "registered"),
    [
        (checks_package, Check, checks()),
        (doubts_package, Reason, reasons()),
        (rewrites_package, Rewrite, rewrites()),
        (beginnings_package, Beginning, beginnings()),
        (openings_package, Opening, openings()),
        (scans_package, Scan, scans()),
    ],
    ids=["checks", "doubts", "rewrites", "beginnings", "openings", "scans"],
)
def test_every_file_is_registered_and_holds_one(package: ModuleType, kind: type, registered: dict[str, object]) -> None:
    folder = Path(str(package.__file__)).parent
    files = {path.stem for path in folder.glob("*.py")} - {"__init__", "catalogue"}
    assert set(registered) == files
    assert all(isinstance(one, kind) for one in registered.values())
    names = [getattr(one, "name", None) or getattr(one, "what", name) for name, one in registered.items()]
    assert len(set(names)) == len(files)


def test_scans_are_of_effects() -> None:
    assert set(scans()) <= set(catalogue())


def test_every_turn_has_a_way_to_rewrite_a_set() -> None:
    assert {turn for way in rewrites().values() for turn in way.turns} == set(Turn)


def test_every_check_of_every_fit_is_told_by_its_name() -> None:
    # Of two joints, so that a check of every joint tells each; of two channels of one kind, so that one may leak into the other.
    system, runs = double_pendulum(0.01, 5e-4, 3)
    told = diagnose(runs, model=system, only=["viscous_damping"]).remainder["tests"]
    of_every_fit = [check for check in checks().values() if check.asked is Asked.OF_EVERY_FIT]
    for check in of_every_fit:
        own = [test["what"] for test in told if test["what"].startswith(check.name)]
        assert own, check.name
        if check.every_joint:
            assert {what.rsplit(" at ", 1)[1] for what in own} == {"shoulder", "elbow"}
    starts = tuple(check.name for check in of_every_fit)
    assert all(test["what"].startswith(starts) for test in told)


def test_what_is_asked_of_the_set_that_is_told_is_told_by_its_name_too() -> None:
    # An inertia about the joint that is a third off is far outside the tolerance, and nothing that may be named makes up for it.
    found = diagnose(
        releases(Rig(inertia=0.01, viscous=2e-3), (1.2, 0.7), 1e-3, 2, duration=6.0),
        model=nominal(),
        only=["viscous_damping"],
    )
    whats = {test["what"] for test in found.remainder["tests"]}
    assert checks()["nominal_tolerance"].name in whats
    assert checks()["vertical_shaking"].name in whats
