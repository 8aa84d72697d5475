"""What efforts tell of an arm stands in where a limit leaves its motion without an answer, and says so."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest
from simulated_recordings import recording

from harness import diagnose
from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.answer.explain import untried
from harness.diagnose.inverse import efforts_first as module
from harness.diagnose.inverse.efforts_first import UNRUN, ByEfforts, by_efforts, instead
from harness.diagnose.prediction.coordinates import from_internal
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.deadline import Deadline, NotTried
from harness.diagnose.selection.model_error import _as_found
from harness.system import Joint, JointType, Link, System

NAMES = ("a", "b", "c", "d")


def arm() -> System:
    """Four links in a row, each 0.2 m on."""
    links: list[Link] = []
    joints: list[Joint] = []
    for k, name in enumerate(NAMES):
        below = links[-1].name if links else "base"
        links.append(
            Link(f"link_{name}", mass=0.5, com=np.array([0.0, 0.0, -0.1]), inertia=np.diag([2e-3, 2e-3, 1e-4]))
        )
        place, axis = np.array([0.0, 0.0, -0.2 if k else 0.0]), np.array([0.0, 1.0, 0.0])
        joints.append(Joint(name, JointType.CONTINUOUS, below, links[-1].name, xyz=place, axis=axis))
    return System(name="arm", base="base", links=tuple(links), joints=tuple(joints))


def answer(verdict: str, *grades: str | None, not_tried: tuple[NotTried, ...] = ()) -> Diagnosis:
    findings = [
        {"effect": "viscous_damping", "site": "b", "parameters": {}} | ({"grade": g} if g else {}) for g in grades
    ]
    return Diagnosis(
        verdict=verdict, summary="It is said.", noise=[], mismatch=[], findings=findings, ranking=[],
        fit=[{"channel": "a.effort"}], remainder={}, next_experiment={}, quality=[], not_tried=not_tried,
    )  # fmt: skip


LEFT = (NotTried("all of it", "everything"),)


@pytest.mark.parametrize(
    ("found", "taken"),
    [
        (answer("explained", "certain"), False),
        (answer("consistent"), False),  # all was tried, nothing is missing
        (answer("partly_explained", "likely", not_tried=LEFT), False),  # something is claimed
        (answer("unexplained", not_tried=LEFT), True),
        (answer("unexplained", "possible", not_tried=LEFT), True),
        (None, True),
    ],
)
def test_the_efforts_answer_stands_in_only_where_nothing_is_claimed(found, taken):
    by_effort = answer("explained", "established")
    told = instead(found, by_effort)
    assert told is not None
    if not taken:
        assert told is found
        return
    # Nor is anything established.
    assert [{**f, "grade": "established"} for f in told.findings] == by_effort.findings and not told.complete
    assert [f["grade"] for f in told.findings] == ["likely"]
    assert told.not_tried[-1].what.endswith(UNRUN.what)
    # Looked at from one side only, nothing is called explained.
    assert told.verdict == "partly_explained"
    why = "no time to run the motion" if found is None else "the time was up before the motion claimed anything"
    assert why in told.summary and UNRUN.what in told.summary
    assert instead(found, None) is found
    # Of two answers that claim nothing the motion's own says what is left, and where.
    for nothing in (answer("consistent"), answer("unexplained", "possible")):
        instead_of_it = instead(found, nothing)
        assert instead_of_it is found if found is not None else instead_of_it is not None


def test_what_was_left_untried_is_told_in_one_sentence():
    by_effort = answer("explained", None, not_tried=LEFT)
    told = instead(None, replace(by_effort, summary=f"It is said. {untried(LEFT)}"))
    assert told is not None
    assert told.summary.count("The time was up") == 1
    assert told.summary.endswith(f"It is said. {untried((*LEFT, UNRUN))}")


def runs(system: System, joints: tuple[str, ...] = NAMES):
    time = np.arange(0.0, 4.0, 0.01)
    channels = {f"{n}.position": 0.3 * np.sin(2.0 * time + k) for k, n in enumerate(NAMES)}
    channels |= {f"{n}.effort": np.cos(2.0 * time + k) for k, n in enumerate(joints)}
    return [recording("run", time, channels)]


def test_efforts_are_asked_first_only_under_a_limit_and_where_all_are_known(monkeypatch):
    asked = []

    def record(system, recordings, held, **options):
        asked.append(options["deadline"])
        return answer("explained", None)

    monkeypatch.setattr(module, "diagnose_effort", record)
    system = arm()
    options = {"only": (), "tell": lambda _: None}
    assert by_efforts(system, runs(system), None, deadline=Deadline(), **options).instead(None) is None
    some = by_efforts(system, runs(system, NAMES[:3]), None, deadline=Deadline(60.0), **options)
    assert some.instead(None) is None
    assert not asked
    whole = Deadline(60.0)
    assert by_efforts(system, runs(system), None, deadline=whole, **options).early is not None
    (part,) = asked
    assert not part.over
    # An interrupt ends both: what may go on then is done within seconds.
    whole.interrupt()
    assert part.over and whole.over


def test_of_two_joints_efforts_are_asked_last_and_only_where_the_motion_claims_nothing(monkeypatch):
    asked = []

    def record(system, recordings, held, **options):
        asked.append(options["deadline"])
        return answer("explained", None)

    monkeypatch.setattr(module, "diagnose_effort", record)
    system = arm()
    two = replace(system, links=system.links[:2], joints=system.joints[:2])
    whole = Deadline(60.0)
    efforts = by_efforts(two, runs(two), None, only=(), tell=lambda _: None, deadline=whole)
    # Some of the time is left for them.
    assert efforts.motion is not whole and efforts.motion.limited
    claimed = answer("partly_explained", "likely", not_tried=LEFT)
    assert efforts.instead(claimed) is claimed
    assert not asked
    told = efforts.instead(answer("unexplained", "possible", not_tried=LEFT))
    assert told is not None and told.not_tried[-1].what == f"further {UNRUN.what}"
    (part,) = asked
    assert not part.over
    # Once is enough, and after an interrupt nothing is begun.
    assert efforts.instead(None) is not None and len(asked) == 1
    again = by_efforts(two, runs(two), None, only=(), tell=lambda _: None, deadline=whole)
    whole.interrupt()
    assert again.instead(None) is None and again.motion.over and len(asked) == 1


def test_a_limit_too_short_for_the_motion_still_has_the_efforts_answer(monkeypatch):
    def told(*_, deadline: Deadline, **__):
        return ByEfforts(None, deadline, deadline, answer("explained", None))

    monkeypatch.setattr(import_module("harness.diagnose.diagnose"), "by_efforts", told)
    system = arm()
    found = diagnose(runs(system), system, time_limit=0.01)
    assert [f["site"] for f in found.findings] == ["b"]
    assert not found.complete
    assert found.provenance is not None


def test_what_efforts_find_is_a_set_that_the_motion_begins_with(monkeypatch):
    """Asked for once, with a limit or without, and only where it is wanted; of nothing where efforts cannot be asked."""
    asked = []

    def record(system, recordings, held, **options):
        asked.append(options["deadline"])
        found = answer("partly_explained", "established")
        found.findings[0]["parameters"] = {"coefficient": {"value": 0.4, "ci95": [0.3, 0.5]}}
        return found

    monkeypatch.setattr(module, "diagnose_effort", record)
    system = arm()
    options = {"only": (), "tell": lambda _: None}
    unhurried = by_efforts(system, runs(system), None, deadline=Deadline(), **options)
    assert not asked
    for _ in range(2):
        assert unhurried.laws() == {"viscous_damping@b": {"coefficient": 0.4}}
    assert len(asked) == 1
    assert by_efforts(system, runs(system, NAMES[:3]), None, deadline=Deadline(), **options).laws() == {}
    # An arm under a limit has been asked before.
    hurried = by_efforts(system, runs(system), None, deadline=Deadline(60.0), **options)
    assert hurried.laws() == unhurried.laws()
    assert len(asked) == 2


def test_a_set_begins_with_the_numbers_that_were_found_elsewhere():
    """As many of them as stand together: of friction that falls with speed and its special case the one that comes first."""
    rig = System(
        "rig", (Joint("a", JointType.REVOLUTE, "base", "l", axis=np.array([0.0, 1.0, 0.0])),), (arm().links[0],)
    )
    rig = replace(rig, links=(replace(rig.links[0], name="l"),))
    known = candidates(rig, runs(rig, ("a",)))
    begun = []

    def fit(hypothesis, starts, near):
        begun.append((hypothesis, starts[0]))
        return hypothesis

    study = SimpleNamespace(predictor=SimpleNamespace(nominal=("mass", "length")), candidates=known, fit=fit)
    laws = {
        "viscous_damping@a": {"coefficient": 0.4},
        "coulomb_friction@a": {"torque": 0.2},
        "stribeck_friction@a": {"coulomb_torque": 0.1, "static_torque": 0.3, "stribeck_velocity": 0.5},
        "viscous_damping@nowhere": {"coefficient": 1.0},
    }
    _as_found(study, laws, None)
    ((hypothesis, x),) = begun
    assert hypothesis.keys == ("viscous_damping@a", "coulomb_friction@a")
    assert x[:2].tolist() == [0.0, 0.0]
    values = [from_internal(m, x[2:][[k]]) for k, m in enumerate(hypothesis.members)]
    assert np.concatenate(values) == pytest.approx([0.4, 0.2])
    assert _as_found(study, {}, None) == []
