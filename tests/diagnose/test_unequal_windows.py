"""Windows of unequal length run together, and predict what they predict apart."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, releases

from harness.denoc.lanes.model import LaneModel
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import ABREAST, UNEQUAL, Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.score_tests import carry_state

# Samples of a recording of 1000: in no order, the last one too short to run beside the longest.
WINDOWS = [Window(0, 0, 300), Window(1, 0, 1000), Window(0, 300, 900), Window(1, 200, 900), Window(0, 900, 1000)]


def lanes(moved: int) -> list[tuple[int, Window, np.ndarray]]:
    """Every window from several states, so that more run than fit abreast."""
    return [(0, window, np.array([0.3 + 0.1 * k, 0.2 * w])) for w, window in enumerate(WINDOWS) for k in range(moved)]


FREE = [[], ["coulomb_friction"], ["coulomb_friction", "sensor_lowpass"], ["base_compliance"]]
DRIVEN = [[], ["coulomb_friction"], ["actuator_delay", "sensor_lowpass"], ["clock_skew"], ["base_compliance"]]


@pytest.mark.parametrize(
    ("driven", "names"), [*((False, names) for names in FREE), *((True, names) for names in DRIVEN)]
)
def test_together_as_apart(driven: bool, names: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    system, time = nominal(), 0.01 * np.arange(1000)
    recordings = releases(Rig(viscous=0.002), (0.6, -0.4), 1e-3, seed=2, duration=10.0, rate=100.0)
    if driven:
        angles = {"pivot.position": 0.1 * np.sin(time)}
        recordings = [
            recording(f"run{k}", time, angles | {"pivot.effort": 0.1 * np.cos((k + 1) * time)}) for k in (0, 1)
        ]
    predictor = Predictor(pose(system, recordings))
    known = candidates(system, recordings)
    members = tuple(next(c for c in known if c.effect.name == name) for name in names)
    hypothesis = Hypothesis(members)
    starts = [to_internal(m, np.array([p.start_values(m.references)[0] for p in m.effect.parameters])) for m in members]
    x = np.concatenate([np.zeros(len(predictor.nominal)), *starts])[None]
    asked = [(0, window, carry_state(predictor, Hypothesis(), hypothesis, state)) for _, window, state in lanes(3)]
    runs: list[int] = []
    simulate = LaneModel.simulate

    def counted(self: LaneModel, rows: np.ndarray, *how: object, **options: object):
        runs.append(len(rows))
        return simulate(self, rows, *how, **options)

    monkeypatch.setattr(LaneModel, "simulate", counted)
    together = predictor.predict(hypothesis, x, asked)
    assert len(asked) > ABREAST
    assert max(w.size for w in WINDOWS) > UNEQUAL * min(w.size for w in WINDOWS)
    if predictor.state_size(hypothesis) == 2 and names != ["clock_skew"]:
        assert sorted(runs) == [3, 12]  # those that are too short run by themselves
    sensed = any(m.effect.sensor is not None for m in members)
    for lane, found in zip(asked, together, strict=True):
        (alone,) = predictor.predict(hypothesis, x, [lane])
        assert found.shape == (len(predictor.problem.channels), lane[1].size)
        # Motions are the same to the last bit; what sensors make of several at once is rounded otherwise.
        assert np.allclose(found, alone, rtol=0.0, atol=1e-12 if sensed else 0.0)
