"""The augmented model in other engines and in other formats."""

from dataclasses import replace

import numpy as np
import pytest

from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.answer.replay import Opening, replay, replayable
from harness.report.diagnosis import write_diagnosis
from harness.system import Attachment, load

TIME = np.arange(0.0, 1.0, 0.01)
DRAG = Attachment("quadratic_drag", "shoulder", {"coefficient": 0.02})
SOFT = Attachment("joint_flexibility", "elbow", {"stiffness": 20.0, "damping": 0.05})
PLAY = Attachment("backlash", "shoulder", {"gap": 0.02})
BIASED = Attachment("sensor_offset", "shoulder.position", {"offset": 0.1})


def arm(*attachments):
    return replace(load("models/urdf/double_pendulum.urdf"), attachments=attachments)


def opening(noise=1e-3):
    tau = 0.2 * np.sin(np.outer(TIME, [3.0, 5.0]))
    return Opening(
        "run2", {"shoulder": 0.6, "elbow": -0.3, "elbow_coupling": 1e-3}, {"shoulder": 0.5}, TIME, tau,
        {"shoulder.position": noise, "elbow.position": noise},
    )  # fmt: skip


def answer(system, **fields):
    finding = {"effect": "quadratic_drag", "site": "shoulder", "parameters": {}, "indistinguishable_from": []}
    finding |= {"evidence": {"delta_bic": 99.0}}
    return Diagnosis(
        "explained", "…", (), (), [finding], (), (), {"significant": False}, {}, augmented=system, **fields
    )


def test_engines_that_know_the_effects_move_as_the_native_one():
    found = {row["engine"]: row for row in replay(arm(DRAG, SOFT, BIASED), opening())}
    for engine in ("mujoco", "exudyn", "pinocchio"):
        assert found[engine]["difference"] < 1e-5, engine
        assert found[engine]["note"] == ""
    assert "exudyn_ancf" not in found


def test_an_engine_without_the_effect_says_so():
    rubbing = Attachment("dahl_friction", "shoulder", {"torque": 0.05, "stiffness": 5.0})
    found = {row["engine"]: row for row in replay(arm(rubbing), opening())}
    assert found["mujoco"]["difference"] is None
    assert "dahl_friction" in found["mujoco"]["note"]


def test_a_difference_beyond_the_noise_is_told():
    # Teeth hit at other instants with other steps, which shows beside noise of a picoradian.
    rows = [row for row in replay(arm(PLAY), opening(noise=1e-12)) if row["difference"] is not None]
    assert rows
    assert all(row["note"] == "apart by more than the noise" for row in rows)


@pytest.mark.parametrize(
    ("attachments", "can"), [((DRAG,), True), ((BIASED,), False), ((), False), ((DRAG, BIASED), True)]
)
def test_only_dynamics_are_run_again(attachments, can):
    assert replayable(arm(*attachments)) is can


def test_an_effect_of_the_users_own_is_not_run_again():
    assert not replayable(arm(DRAG, Attachment("my_law", "shoulder", {"size": 1.0})))


def test_the_answer_carries_the_replay_once_asked_for():
    found = answer(arm(DRAG), opening=opening())
    assert "replay" not in found.to_json()
    rows = found.replayed().to_json()["replay"]
    assert {"engine", "channel", "difference", "noise", "note"} == set(rows[0])


def test_the_model_is_written_in_every_format_with_what_each_leaves_out(tmp_path):
    said = []
    system = arm(DRAG, Attachment("coulomb_friction", "elbow", {"torque": 0.03}))
    paths = write_diagnosis(answer(system), tmp_path, said=said.append)
    assert [path.name for path in paths][2:] == ["augmented.toml", "augmented.urdf", "augmented.xml"]
    for path in paths[2:]:
        again = load(path)
        attached = {a.effect for a in again.attachments}
        # TOML keeps effects as they were found; the others have words for dry friction alone.
        assert attached == ({"quadratic_drag", "coulomb_friction"} if path.suffix == ".toml" else set())
        assert again.joint("elbow").friction == pytest.approx(0.0 if path.suffix == ".toml" else 0.03)
    assert any("augmented.urdf leaves out effect 'quadratic_drag'" in line for line in said)


def test_without_findings_there_is_no_other_model(tmp_path):
    found = replace(answer(arm()), findings=())
    (tmp_path / "augmented.urdf").write_text("of an earlier diagnosis")
    names = [path.name for path in write_diagnosis(found, tmp_path)]
    assert "augmented.urdf" not in names
    assert not (tmp_path / "augmented.urdf").exists()
