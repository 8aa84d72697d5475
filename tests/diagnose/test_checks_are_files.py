"""Residual checks and reasons to doubt are files: the catalogues and the folders agree, and checks are told by their names."""

from __future__ import annotations

from pathlib import Path

import pytest
from simulated_recordings import Rig, double_pendulum, nominal, releases

from harness import diagnose
from harness.diagnose.criticism import checks as checks_package
from harness.diagnose.criticism import doubts as doubts_package
from harness.diagnose.criticism.check import Asked, Check
from harness.diagnose.criticism.checks.catalogue import checks
from harness.diagnose.criticism.doubts.catalogue import reasons
from harness.diagnose.criticism.reason import Reason


@pytest.mark.parametrize(
    ("package", "kind", "registered"),
    [(checks_package, Check, checks()), (doubts_package, Reason, reasons())],
    ids=["checks", "doubts"],
)
def test_every_file_is_registered_and_holds_one(package: object, kind: type, registered: dict[str, object]) -> None:
    folder = Path(str(package.__file__)).parent  # type: ignore[attr-defined]
    files = {path.stem for path in folder.glob("*.py")} - {"__init__", "catalogue"}
    assert set(registered) == files
    assert all(isinstance(one, kind) for one in registered.values())
    names = [
        one.name if isinstance(one, Check) else one.what
        for one in registered.values()
        if isinstance(one, Check | Reason)
    ]
    assert len(set(names)) == len(files)


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
