"""What an answer was made from, and how its estimates hang together."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from types import SimpleNamespace

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, releases

import harness
from harness.diagnose.answer.correlations import correlations
from harness.diagnose.answer.provenance import provenance

NOISE = 1e-3
ORDINARY = ("coulomb_friction", "viscous_damping")


class Member:
    """As much of a candidate as correlations ask for."""

    def __init__(self, key: str, *names: str) -> None:
        self.key, self.effect = key, SimpleNamespace(parameter_names=names)


def fitted(matrix: np.ndarray, free: list[bool], *members: Member) -> SimpleNamespace:
    spans = np.cumsum([0, *(len(m.effect.parameter_names) for m in members)])
    hypothesis = SimpleNamespace(members=members, span=lambda k: slice(int(spans[k]), int(spans[k + 1])))
    return SimpleNamespace(
        x=np.zeros(len(free)), free=np.array(free), linear=SimpleNamespace(matrix=matrix), hypothesis=hypothesis
    )


def test_correlation_of_two_columns_is_minus_the_cosine_of_their_angle():
    # Of least squares with columns a and b the estimates correlate by −a·b/(|a||b|); no nominal quantity, so no prior.
    a, b = np.array([1.0, 0.0, 2.0]), np.array([2.0, 1.0, 0.5])
    fit = fitted(
        np.stack([a, b], axis=1),
        [True, True],
        Member("coulomb_friction@pivot", "torque"),
        Member("drag@pivot", "coefficient"),
    )
    told = correlations(SimpleNamespace(nominal=()), fit, ["coulomb_friction@pivot", "drag@pivot"])
    assert told["parameters"] == ["coulomb_friction@pivot.torque", "drag@pivot.coefficient"]
    assert told["matrix"][0][1] == pytest.approx(-a @ b / np.linalg.norm(a) / np.linalg.norm(b), abs=1e-12)


def test_a_nominal_quantity_is_told_where_an_estimate_leans_on_it():
    # One nominal quantity with a unit prior, the same column as the effect's: of information [[1 + s², s²], [s², s²]] the
    # correlation is −s/√(1 + s²); an orthogonal one has none.
    s = 3.0
    predictor = SimpleNamespace(
        nominal=(SimpleNamespace(kind="mass", name="rod"), SimpleNamespace(kind="length", name="rod"))
    )
    matrix = np.array([[s, 0.0, s], [0.0, 5.0, 0.0]])
    told = correlations(predictor, fitted(matrix, [True] * 3, Member("gain@pivot", "gain")), ["gain@pivot"])
    assert told["parameters"] == ["gain@pivot.gain", "mass of rod"]
    assert told["matrix"][0][1] == pytest.approx(-s / np.sqrt(1.0 + s * s), abs=1e-9)


def test_what_stands_at_a_bound_has_no_correlation():
    fit = fitted(np.eye(2), [True, False], Member("a@pivot", "one", "two"))
    assert correlations(SimpleNamespace(nominal=()), fit, ["a@pivot"]) is None


def test_an_answer_says_what_it_was_made_from():
    runs = releases(Rig(dry=0.004), (1.2, 0.8), NOISE, 2)
    found = harness.diagnose(runs, model=nominal(), only=ORDINARY)
    told = found.to_json()["provenance"]
    assert told["version"] == harness.__version__
    assert datetime.now(UTC) - datetime.fromisoformat(told["created"]) < timedelta(minutes=10)
    assert [row["role"] for row in told["recordings"]] == ["training", "held out"]
    assert [row["samples"] for row in told["recordings"]] == [run.samples for run in runs]
    # What was measured is shown as it was, sample by sample.
    curve = next(r for r in found.curves.residuals if r.recording == runs[0].name)
    assert np.isin(curve.measured, runs[0].channels[0].values).all()


def test_a_single_recording_serves_for_both():
    (run,) = releases(Rig(), (1.0,), NOISE, 2)
    told = provenance(nominal(), ["rig.urdf"], [run], None)
    assert [row["role"] for row in told["recordings"]] == ["both"] and told["model"]["file"] == "rig.urdf"
