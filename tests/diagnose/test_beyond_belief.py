"""Beside a remainder, a number many times what its effect is named for is possible at most: the model is far off elsewhere."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.claims import grades
from harness.diagnose.claims.grades import ESTABLISHED, LIKELY, POSSIBLE, effect_says_not_what, grade
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.problem.candidates import candidates


@pytest.mark.parametrize(
    ("offset", "remainder", "expected"),
    [
        # A centre of mass a tenth of the link off is usual, one eleven lengths off is no such thing; the link is 0.3 m long.
        (0.03, True, LIKELY),
        (0.3, True, LIKELY),
        (-3.3, True, POSSIBLE),
        (3.3, True, POSSIBLE),
        (3.3, False, ESTABLISHED),
    ],
)
def test_a_size_beyond_belief(offset: float, remainder: bool, expected: str) -> None:
    known = {c.key: c for c in candidates(nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0))}
    claim = SimpleNamespace(candidate=known["com_offset@rod"])
    outcome = SimpleNamespace(force=None)
    conclusion = SimpleNamespace(hurried=False, remains=SimpleNamespace(significant=remainder))
    values = {"offset": Estimate(offset, 0.01, offset - 0.02, offset + 0.02)}
    assert grade(outcome, conclusion, claim, values, []) == expected


@pytest.mark.parametrize(("level", "expected"), [(1.0, LIKELY), (3.0, POSSIBLE)])
def test_what_there_was_no_time_to_weigh_is_possible_and_likely_at_most_where_it_leaves_noise_alone(
    level: float, expected: str
) -> None:
    known = {c.key: c for c in candidates(nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0))}
    claim = SimpleNamespace(candidate=known["com_offset@rod"])
    values = {"offset": Estimate(0.03, 0.001, 0.028, 0.032)}
    assert grade(*cut_short(claim, level=level), claim, values, []) == expected


@pytest.mark.parametrize(
    ("bent", "gain", "expected"), [(False, 1e4, LIKELY), (True, 1e4, POSSIBLE), (False, 500.0, POSSIBLE)]
)
def test_what_is_cut_short_is_possible_beside_a_bent_model_and_where_it_is_smaller_than_the_noise(
    bent: bool, gain: float, expected: str
) -> None:
    # A thousand samples of noise leave a thousand squares.
    known = {c.key: c for c in candidates(nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0))}
    claim = SimpleNamespace(candidate=known["com_offset@rod"])
    values = {"offset": Estimate(0.03, 0.001, 0.028, 0.032)}
    assert grade(*cut_short(claim, bent=bent, gain=gain), claim, values, []) == expected


def cut_short(
    claim: SimpleNamespace, *, level: float = 1.0, bent: bool = False, gain: float = 1e4
) -> tuple[SimpleNamespace, SimpleNamespace]:
    """An outcome and its conclusion when the time was up, of sets that leave noise."""
    claim.gain = gain
    study = SimpleNamespace(
        likelihood=SimpleNamespace(rounded=1.0, colours=(), problem=SimpleNamespace(channels=())),
        stretched=lambda fitted: bent,
    )
    conclusion = SimpleNamespace(
        hurried=True, level=level, remains=SimpleNamespace(significant=False), best=SimpleNamespace(cost=1000.0)
    )
    return SimpleNamespace(force=None, evidence=None, study=study), conclusion


@pytest.mark.parametrize(("offset", "expected"), [(0.03, LIKELY), (-0.14, LIKELY), (-0.25, POSSIBLE)])
def test_an_unusual_size_is_possible_while_there_was_no_time_to_ask_what_else_it_could_be(
    offset: float, expected: str
) -> None:
    # Usual is a tenth of the link's 0.3 m; the near end of the last interval is 7.7 times that.
    known = {c.key: c for c in candidates(nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0))}
    claim = SimpleNamespace(candidate=known["com_offset@rod"])
    values = {"offset": Estimate(offset, 0.01, offset - 0.02, offset + 0.02)}
    assert grade(*cut_short(claim), claim, values, []) == expected


@pytest.mark.parametrize(("stiffness", "expected"), [(1e4, LIKELY), (3e-3, POSSIBLE)])
def test_of_a_stiffness_what_gives_far_is_unusual_and_not_what_is_stiff(stiffness: float, expected: str) -> None:
    # A stop usually gives some hundredths of a radian under the weight of 0.15 N·m that leans on it, not fifty radians.
    known = {c.key: c for c in candidates(nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0))}
    claim = SimpleNamespace(candidate=known["end_stop@pivot"])
    conclusion = SimpleNamespace(hurried=False, remains=SimpleNamespace(significant=True))
    values = {
        "angle": Estimate(0.4, 0.01, 0.38, 0.42),
        "stiffness": Estimate(stiffness, 0.1 * stiffness, 0.8 * stiffness, 1.2 * stiffness),
    }
    assert grade(SimpleNamespace(force=None), conclusion, claim, values, []) == expected


@pytest.mark.parametrize(
    ("key", "values", "vaguely"),
    [
        # A weight of 3 kg that may be a ton, and one of 3 kg that may be 20.
        ("payload_mass@rod", {"mass": Estimate(3.0, 100.0, 0.0, 946.0)}, True),
        ("payload_mass@rod", {"mass": Estimate(3.0, 8.0, 0.0, 20.0)}, False),
        # Less than nothing is as far.
        ("com_offset@rod", {"offset": Estimate(-0.01, 0.1, -0.2, 0.19)}, True),
        # A gain is absent at one.
        ("sensor_gain@pivot.position", {"gain": Estimate(1.001, 0.01, 0.98, 1.022)}, True),
        ("sensor_gain@pivot.position", {"gain": Estimate(1.1, 0.01, 1.08, 1.12)}, False),
        # A stop that may be anywhere beyond its place is known to be no nearer.
        (
            "end_stop@pivot",
            {"angle": Estimate(0.4, None, 0.35, 1e9), "stiffness": Estimate(1.0, 50.0, 0.0, 99.0)},
            False,
        ),
    ],
)
def test_numbers_that_are_not_known_to_a_factor_of_ten_say_not_what_is_there(
    key: str, values: dict[str, Estimate], vaguely: bool
) -> None:
    known = {c.key: c for c in candidates(nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0))}
    member = known[key]
    told = {p.name: values.get(p.name, Estimate(1.0, 0.01, 0.98, 1.02)) for p in member.effect.parameters}
    assert effect_says_not_what(member, told) == vaguely
    conclusion = SimpleNamespace(hurried=False, remains=SimpleNamespace(significant=False))
    claim = SimpleNamespace(candidate=member)
    expected = POSSIBLE if vaguely else ESTABLISHED
    assert grade(SimpleNamespace(force=None), conclusion, claim, told, []) == expected


@pytest.mark.parametrize(
    ("beside_a_force", "expected"),
    [(None, ESTABLISHED), ((-8e-3, -4e-3), POSSIBLE), ((-12e-3, -9e-3), ESTABLISHED)],
)
def test_what_free_runs_say_is_no_more_than_possible_where_sets_beside_a_force_have_it_elsewhere(
    monkeypatch: pytest.MonkeyPatch, beside_a_force: tuple[float, float] | None, expected: str
) -> None:
    known = {c.key: c for c in candidates(nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0))}
    claim = SimpleNamespace(candidate=known["viscous_damping@pivot"], index=0, gain=50.0, of_class=1.0, probability=1.0)
    monkeypatch.setattr(grades, "of_other_sets", lambda *_: beside_a_force)
    outcome = SimpleNamespace(force=True, evidence=True)
    remains = SimpleNamespace(significant=True, excess=1.0)
    conclusion = SimpleNamespace(hurried=False, by_free_runs=True, best=None, remains=remains)
    values = {"coefficient": Estimate(-0.01, 2.5e-4, -0.0105, -0.0095)}
    rows = [{"parameters": {"coefficient": {"value": -0.01, "ci95": [-0.011, -0.009]}}}]
    assert grade(outcome, conclusion, claim, values, rows) == expected
