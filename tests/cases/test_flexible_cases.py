"""The flexible cases run and pass; a beam that is two per cent too stiff is caught by each of their checks."""

import math
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("exudyn")

from harness.cases.beams import PAPER_MASS, cantilever, flexible_pendulum, strip, two_strips
from harness.cases.case import NATIVE, Bench, Case, Row, Series
from harness.cases.checks.beam_frequency import BeamFrequencyTruth
from harness.cases.checks.deflection import Accuracy, DeflectionAgreement, with_modes
from harness.cases.discover import built_in
from harness.cases.flexible_pendulum import ANCF
from harness.cases.run import run_case
from harness.cases.user_beams import beam_checks
from harness.engines import registry
from harness.engines.denoc_native import Native
from harness.engines.exudyn_ancf import Ancf

SHORT = DeflectionAgreement(
    peer=ANCF,
    position=(("pivot", -math.pi / 2.0),),
    accuracies=(Accuracy(None, 0.01, 1e-4, "eight cables at 50 µs", frequency=0.3),),
    duration=0.25,
    step=5e-5,
    elements=8,
)


def stiffer(system, factor=1.02):
    """The system with every beam's bending stiffness multiplied."""
    for link in system.links:
        if link.beam is not None:
            beam = replace(link.beam, bending_stiffness=factor * link.beam.bending_stiffness)
            system = system.replace_link(replace(link, beam=beam))
    return system


def bench(system, native_system, check):
    case = Case("planted", "", "", lambda: system, (check,), group="flexible", engines=(NATIVE, ANCF))
    models = {NATIVE: Native().build(native_system), ANCF: Ancf().build(system)}
    return Bench(case, system, models)


def rows(items):
    return {item.quantity: item for item in items if isinstance(item, Row)}


@pytest.mark.parametrize(
    "name",
    [
        "flexible_pendulum_as_printed",
        "frequencies_clamped_free",
        "frequencies_pinned_free",
        "frequencies_pinned_hub",
        "frequencies_tip_mass",
        "rotating_cantilever",
        "spin_up",
    ],
)
def test_quick_cases_pass(name):
    case = built_in()[name]
    outcome = run_case(case, {engine: registry.engine(engine) for engine in case.engines})
    assert outcome.rows
    assert [(row.quantity, row.note) for row in outcome.rows if row.verdict != "pass"] == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["flexible_pendulum", "flexible_pendulum_unstiffened", "two_flexible_links", "ten_links_alternating"]
)
def test_long_cases_pass(name):
    case = built_in()[name]
    outcome = run_case(case, {engine: registry.engine(engine) for engine in case.engines})
    assert [(row.quantity, row.note) for row in outcome.rows if row.verdict != "pass"] == []
    figures = {series.figure for series in outcome.series}
    assert {"tip_deflection", "spectrum"} <= figures


def test_a_short_fall_agrees_and_a_stiffer_beam_does_not():
    system = flexible_pendulum(strip(mass=PAPER_MASS, modes=5))
    good = rows(SHORT.run(bench(system, system, SHORT)))
    assert {row.verdict for row in good.values()} == {"pass"}
    # Two per cent of stiffness are one per cent of frequency, 0.37 Hz: after 0.25 s the phase is half a radian off.
    bad = rows(SHORT.run(bench(system, stiffer(system), SHORT)))
    assert bad["tip_deflection_5_modes"].verdict == "fail"
    assert bad["vibration_5_modes"].verdict == "fail"
    first = bad["tip_deflection_5_modes"].first_divergence
    assert first["signal"] == "rod.tip_deflection"
    assert 0.0 < first["time"] < 0.25


def test_a_stiffer_beam_misses_the_closed_form():
    system = cantilever(strip(modes=2))
    truth = BeamFrequencyTruth((9.05978562, 56.7767073), 1e-6, "", cites="")
    good = rows(truth.run(bench(system, system, truth)))
    bad = rows(truth.run(bench(system, stiffer(system, 1.0001), truth)))
    assert good["frequency"].verdict == "pass"
    assert bad["frequency"].verdict == "fail"
    assert "mode" in bad["frequency"].note


def test_a_missing_mode_is_told():
    system = cantilever(strip(modes=1))
    truth = BeamFrequencyTruth((9.05978562, 56.7767073), 1e-6, "", cites="")
    row = rows(truth.run(bench(system, system, truth)))["frequency"]
    assert row.verdict == "fail"
    assert "no mode at" in row.note


def test_series_show_both_engines():
    system = flexible_pendulum(strip(mass=PAPER_MASS))
    check = replace(SHORT, duration=0.05, also_modes=(2,))
    lines = [item for item in check.run(bench(system, system, check)) if isinstance(item, Series)]
    assert {line.label.split(":")[0] for line in lines if line.figure == "tip_deflection"} == {NATIVE, ANCF}
    (convergence,) = (line for line in lines if line.figure == "convergence")
    assert convergence.x == (1.0, 2.0)
    assert all(len(line.x) == len(line.y) for line in lines)


def test_with_modes_changes_every_beam_and_nothing_else():
    system = with_modes(two_strips(2), 4)
    assert [link.beam.modes for link in system.links] == [4, 4]
    assert np.array_equal(system.links[0].inertia, two_strips(2).links[0].inertia)


def test_checks_of_a_users_mechanism_follow_its_beams():
    assert beam_checks(two_strips(1).rigid()) == ()
    (check,) = beam_checks(two_strips(1))
    assert check.peer == ANCF
    assert [accuracy.modes for accuracy in check.accuracies] == [5, None]
    (check,) = beam_checks(flexible_pendulum(strip(stiffening=False, modes=6)))
    assert check.peer == "exudyn_ffrf"
    assert len(check.accuracies) == 1
    # A beam ten times as long and as thick swings ten times as slowly, and is watched ten times as long.
    long = strip()
    beam = replace(
        long.beam, length=3.0, thickness=0.01, mass=1e3 * long.mass, bending_stiffness=1e4 / 10.0 * 4.1666667
    )
    (slow,) = beam_checks(flexible_pendulum(replace(long, beam=beam)))
    (fast,) = beam_checks(flexible_pendulum(long))
    assert slow.duration > 3.0 * fast.duration
    assert slow.step / slow.duration == pytest.approx(fast.step / fast.duration)
