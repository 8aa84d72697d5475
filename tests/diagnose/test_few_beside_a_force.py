"""Few effects that suffice on short windows: noise is the measure of whole runs, unless a force shows there beside them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from harness.diagnose.selection import model_error as module
from harness.diagnose.selection.model_error import begun_ordinary

SAMPLES = 1000.0
USUAL = 100.0 * SAMPLES
FEW: Any = SimpleNamespace(hypothesis="few", x=None, beginning=lambda windows: None)


@pytest.mark.parametrize(
    ("left", "force", "beside_a_force"),
    [
        (None, True, True),  # no few effects suffice
        (1.0 * SAMPLES, True, False),  # the truth leaves noise on whole runs as well
        (40.0 * SAMPLES, True, False),  # or far less than ordinary dissipation: more effects may follow
        (
            90.0 * SAMPLES,
            True,
            True,
        ),  # as good as nothing is gained there, and a force is likelier than noise of that colour
        (90.0 * SAMPLES, False, False),  # noise of that colour is
    ],
)
def test_few_effects_are_held_against_whole_runs(monkeypatch, left, force, beside_a_force):
    costs = {"usual": USUAL, "few": left}

    def fitted(name):
        return SimpleNamespace(hypothesis=name, x=None, states=None, windows=())

    sensors = SimpleNamespace(samples=lambda windows: SAMPLES)

    def under(likelihood, fit):
        return costs[fit.hypothesis], ()

    study = SimpleNamespace(
        likelihood=SimpleNamespace(as_scattered=sensors), windows=(), empty=lambda: fitted("nothing"),
        fit=lambda hypothesis, starts, near: fitted(hypothesis), residuals_under=under,
    )  # fmt: skip
    monkeypatch.setattr(module, "everywhere", lambda study, short: fitted("usual"))
    monkeypatch.setattr(module, "answers", lambda study, fit, period: ["way"])
    monkeypatch.setattr(module, "weighed", lambda study, ways, fit: SimpleNamespace(force="force" if force else None))
    begun = []

    def searched(study, fits, *_, **__):
        begun.append([fit.hypothesis for fit in fits])
        return "answer"

    monkeypatch.setattr(module, "under_model_error", searched)
    few = None if left is None else FEW
    found = begun_ordinary(study, None, 1.0, None, lambda what: None, None, [], lambda: few)
    assert found == ("answer" if beside_a_force else None)
    # What sufficed is among what the search begins from.
    assert begun == ([["usual", "nothing", *(["few"] if few else [])]] if beside_a_force else [])
