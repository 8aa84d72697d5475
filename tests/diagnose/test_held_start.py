"""Recordings that begin before the hand has let go, each at a time of its own.

Such recordings of a right model once ended in a base that gives, told as certain, since one delay for all recordings was all
that the catalogue has.
"""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, double_pendulum, nominal, recording, swing

from harness import diagnose
from harness.diagnose.conditioning.held_start import hold, released
from harness.recording import Recording

RATE = 200.0


def held_recordings(
    rig: Rig, holds: tuple[float, ...], noise: float, *, seed: int = 3, duration: float = 8.0
) -> list[Recording]:
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, duration, 1.0 / RATE)
    out = []
    for k, (angle, held) in enumerate(zip((1.3, -0.8, 0.5), holds, strict=False)):
        since = np.maximum(time - held, 0.0)
        moving = since > 0.0
        angles = np.full(len(time), angle)
        angles[moving] = swing(rig, angle, np.concatenate([[0.0], since[moving]]))[1:]
        noisy = angles + noise * rng.standard_normal(len(time))
        out.append(recording(f"run{k}", time, {"pivot.position": noisy}))
    return out


@pytest.mark.parametrize(
    ("noise", "held"), [(1e-5, 0.1), (1e-3, 0.1), (1e-5, 0.7), (1e-3, 0.7), (1e-2, 0.7), (1e-3, 3.0), (1e-2, 3.0)]
)
def test_the_letting_go_is_found_within_its_uncertainty(noise: float, held: float) -> None:
    for seed in range(5):
        (run,) = held_recordings(Rig(viscous=0.002, dry=0.01), (held,), noise, seed=seed)
        found = hold(run)
        assert found is not None
        assert found.time == pytest.approx(held, abs=max(5.0 * found.std, 0.2 / RATE))
        assert found.std < 0.02


def test_what_moves_at_once_is_not_held() -> None:
    for seed in range(5):
        for run in held_recordings(Rig(viscous=0.002), (0.0, 0.0, 0.0), 3e-3, seed=seed):
            assert hold(run) is None
    _, runs = double_pendulum(0.01, 1e-3, seed=2)
    assert all(hold(run) is None for run in runs)


def test_holds_of_different_lengths_are_left_out_and_a_note_tells() -> None:
    runs = held_recordings(Rig(dry=0.02), (0.4, 0.0, 1.1), 1e-3)
    cut = released(runs)
    assert cut[1] is runs[1]
    for before, after, held in ((runs[0], cut[0], 0.4), (runs[2], cut[2], 1.1)):
        note = after.quality[-1]
        assert note.kind == "held_start"
        assert note.size == pytest.approx(held, abs=0.01)
        assert after.time[0] == 0.0
        assert after.start == pytest.approx(held, abs=0.015)
        assert after.samples + note.count == before.samples
    assert all(a is b for a, b in zip(released(cut), cut, strict=True))


def test_one_delay_of_all_recordings_is_a_question_for_the_fit() -> None:
    for runs in (held_recordings(Rig(), (0.5, 0.5, 0.5), 1e-3), held_recordings(Rig(), (0.05, 0.05), 3e-3)):
        assert all(a is b for a, b in zip(released(runs), runs, strict=True))
    (single,) = held_recordings(Rig(), (0.5,), 1e-3)
    assert released([single]) == [single]


def test_driven_recordings_are_left_alone() -> None:
    runs = held_recordings(Rig(), (0.4, 1.1), 1e-3)
    push = np.where(runs[0].time > 0.4, 0.1, 0.0)
    driven = recording("driven", runs[0].time, {"pivot.position": runs[0].channels[0].values, "pivot.effort": push})
    assert released([driven, runs[1]]) == [driven, runs[1]]


def test_nothing_but_what_is_missing_is_told() -> None:
    found = diagnose(held_recordings(Rig(dry=0.012, viscous=0.003), (0.35, 0.9), 1e-3), model=nominal())
    assert found.verdict == "explained"
    values = {f["effect"]: next(iter(f["parameters"].values()))["value"] for f in found.findings}
    assert values == {
        "coulomb_friction": pytest.approx(0.012, rel=0.05),
        "viscous_damping": pytest.approx(0.003, rel=0.05),
    }


def test_a_right_model_stays_clean() -> None:
    found = diagnose(held_recordings(Rig(viscous=0.0), (0.2, 0.0, 0.6), 2e-3), model=nominal())
    assert found.verdict == "consistent"
    assert found.findings == []
