"""An effect that is either there or not goes through the machinery of those that have a size."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.diagnose.prediction.coordinates import internal_bounds, start_vector
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.score_tests import brought_near, may_reverse
from harness.effects.catalogue import effect
from harness.effects.scale import references
from harness.system import load

MODEL = Path(__file__).resolve().parents[2] / "models" / "toml" / "flexible_pendulum.toml"


def test_geometric_stiffening_has_no_size_to_bound_or_to_shrink() -> None:
    system = load(MODEL)
    (link,) = [link for link in system.links if link.beam is not None]
    system = system.replace_link(replace(link, beam=replace(link.beam, geometric_stiffening=False)))
    candidate = Candidate(effect("geometric_stiffening"), link.name, references(system, link.name))
    low, high = internal_bounds(candidate)
    assert low.shape == high.shape == start_vector(candidate).shape == (0,)
    assert brought_near(candidate, np.empty(0), 0.1).shape == (0,)
    assert not may_reverse(candidate)
