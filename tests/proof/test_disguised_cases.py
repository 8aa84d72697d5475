"""What an export tells by its models: who knows how cases are drawn, and reads no recording, must not know what is concealed."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

from harness.proof.concealments import CONCEALMENTS
from harness.proof.draw import DISGUISED, Case, draw_case
from harness.proof.rigs import Rig
from harness.proof.run import FULL, tasks
from harness.proof.scene import Scene

LARGE = 0.03  # of the inertia about the joint, above which no rotor of an undisguised rig without concealment is


def _large(rig: Rig) -> bool:
    return any(s.armature > LARGE * s.inertia_about_joint for s in rig.segments)


def _told(case: Case) -> tuple[bool, bool]:
    assert isinstance(case.rig, Rig)
    model = tomllib.loads(case.rig.toml())
    return _large(case.rig), bool(model.get("effect"))


def test_clean_rigs_have_what_only_concealments_had() -> None:
    count = 200
    plain = np.array([_told(draw_case("clean", 5, k, short=True)) for k in range(count)])
    told = np.array([_told(draw_case("clean", 5, k, short=True, disguised=True)) for k in range(count)])
    assert not plain.any()
    # Binomial, within four standard deviations.
    spread = 4.0 * np.sqrt(DISGUISED * (1.0 - DISGUISED) / count)
    assert np.all(np.abs(told.mean(axis=0) - DISGUISED) < spread)
    # Among the cases of a proof whose models state an effect, or have a large rotor, most conceal nothing of the kind.
    clean = FULL["clean"]
    single = FULL["single"] / len(CONCEALMENTS)
    assert DISGUISED * clean > single * sum(bool(c.stated) for c in CONCEALMENTS.values())
    assert DISGUISED * clean > single * sum(c.needs_armature for c in CONCEALMENTS.values())


def test_what_is_stated_acts_as_stated() -> None:
    case = next(c for c in (draw_case("clean", 5, k, short=True, disguised=True) for k in range(60)) if c.rig.stated)
    ((name, site, values),) = case.rig.stated
    assert case.planted == () and site in case.rig.joints and name in {"coulomb_friction", "end_stop"}
    scene, bare = case.scene, Scene(case.rig, case.scene.runs, case.scene.sensor)
    instants = np.arange(0.0, scene.runs[0].duration, 0.01)
    column = f"{case.rig.joints[0]}.position"
    assert isinstance(scene, Scene) and (scene.dry or scene.torques)
    assert np.max(np.abs(scene.record(0, instants)[column] - bare.record(0, instants)[column])) > 1e-4
    assert values == dict(case.rig.stated[0][2])


def test_no_law_is_stated_beside_one_of_its_family() -> None:
    for k in range(60):
        case = draw_case("single", 8, k, effects=("sensor_offset",), target=50.0, short=True, disguised=True)
        if case.rig.stated:
            break
    else:
        pytest.fail("nothing was stated in sixty draws")
    assert case.planted[0].effect == "sensor_offset" and case.visibility[0] > 25.0


def test_draws_of_a_seed_without_disguise_stay_as_they_were() -> None:
    one, other = draw_case("clean", 3, 2, short=True), draw_case("clean", 3, 2, short=True, disguised=True)
    assert [s.length for s in one.rig.segments] == [s.length for s in other.rig.segments]
    assert one.rig.axis == other.rig.axis and one.rig.tolerance == other.rig.tolerance


def test_strips_whose_model_says_what_they_lack_are_not_exported() -> None:
    shown = {t.effect for t in tasks(FULL, disguised=True) if t.kind == "flexible single"}
    assert {t.effect for t in tasks(FULL) if t.kind == "flexible single"} - shown == {
        "higher_mode",
        "geometric_stiffening",
    }
