"""What an engine's equation lacks, by recordings that other engines made: the misprints left in are the truth."""

from __future__ import annotations

import json
import math
from functools import cache
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from harness.cases.paper import equations
from harness.cases.pendulums import paper_pendulum
from harness.cli.main import status_of
from harness.compare.balance import asked, balance, derivatives
from harness.engines import registry
from harness.engines.as_printed import AsPrinted
from harness.engines.printed_terms import slips
from harness.recording.recording import Channel, Recording
from harness.system.write_toml import to_toml


def by_mujoco(noise=2e-4, damping=1e-3):
    system = paper_pendulum(damping=damping)
    time = np.linspace(0.0, 4.0, 2001)
    run = registry.engine("mujoco").build(system).simulate(np.array([1.2]), np.zeros(1), time)
    angle = run.position[:, 0] + noise * np.random.default_rng(4).normal(size=time.size)
    return system, Recording("swing", "", time, (Channel("pivot.position", "pivot", "position", "rad", angle),))


def rigid(left):
    system, recording = by_mujoco()
    mended = tuple(slip.name for slip in slips(7) if slip.name not in left)
    native = registry.engine("denoc").build(system)
    return balance(recording, system, AsPrinted(mended).build(system), native)


@cache
def by_elements():
    pytest.importorskip("exudyn")
    return equations.recorded(duration=0.8, elements=4)


def flexible(*left):
    return equations.doubted(by_elements(), tuple(slip.name for slip in slips(10) if slip.name not in left))


@pytest.mark.parametrize(
    ("slip", "term"), [("gravity_doubled", "gravity"), ("inertia_factor_twice", "inertia by pivot")]
)
def test_one_misprint_of_the_rigid_equation_is_asked_for(slip, term):
    found = rigid((slip,))
    assert [mend.name for mend in found.mends] == [term]
    low, high = found.mends[0].ci95
    assert low < 1.0 < high
    assert high - low < 0.1


def test_of_a_mended_equation_nothing_is_asked():
    assert rigid(()).mends == ()
    assert flexible().mends == ()


def test_gravity_that_is_doubled_is_told_as_twice_what_it_should_be():
    """1 + ρ l² / (ρ l²/2 + m_p l) by hand; with 0.18 kg and 0.02 kg at the tip that is (0.18 + 0.02) / (0.09 + 0.02)."""
    assert rigid(("gravity_doubled",)).mends[0].words == (
        f"gravity is {0.20 / 0.11:.3g} times what it should be in the equation of pivot"
    )


@pytest.mark.parametrize(
    ("slip", "row", "term", "words"),
    [
        ("elastic_stiffness_missing", "rod.mode1", "stiffness", "the elastic stiffness is missing"),
        ("gravity_on_mode_missing", "rod.mode1", "gravity", "gravity is missing"),
        ("gravity_doubled", "pivot", "gravity", "gravity is 2 times what it should be"),
        # 1 / ρ, and ρ is 0.060 kg over 0.30 m.
        ("modal_inertia_without_density", "rod.mode1", "inertia by rod.mode1", "rod.mode1 meets is 5 times"),
    ],
)
def test_one_misprint_of_the_flexible_equation_is_asked_for(slip, row, term, words):
    found = flexible(slip)
    assert [(mend.row, mend.name) for mend in found.mends] == [(row, term)]
    assert words in found.mends[0].words
    low, high = found.mends[0].ci95
    assert low < 1.0 < high


def test_with_the_units_mended_elastic_stiffness_is_missing():
    found = equations.doubted(by_elements(), equations.UNITS)
    told = {(mend.row, mend.name): mend for mend in found.mends}
    assert set(told) == {("pivot", "gravity"), ("rod.mode1", "gravity"), ("rod.mode1", "stiffness")}
    assert told["rod.mode1", "stiffness"].words.startswith("the elastic stiffness is missing")
    assert told["rod.mode1", "stiffness"].factor == pytest.approx(1.0, abs=0.2)


def test_factors_of_a_made_up_sum_are_found_with_their_intervals():
    """A force made of a few of several columns and coloured noise: the columns taken are named, and the intervals hold."""
    rng, inside, wrong = np.random.default_rng(21), 0, 0
    for _ in range(30):
        columns = {str(k): rng.normal(size=800).cumsum() / 20.0 for k in range(5)}
        factors = {str(k): 1.0 + 0.2 * rng.normal() for k in (0, 2)}
        noise = np.convolve(rng.normal(size=820), np.ones(21) / 5.0, mode="valid")
        found = asked(columns, sum(factors[k] * columns[k] for k in factors) + noise, noise)
        wrong += set(found) != set(factors)
        inside += all(abs(found[k][0] - factors[k]) < 1.96 * found[k][1] for k in factors if k in found)
    assert wrong <= 3
    assert inside >= 25


def test_derivatives_of_two_waves_are_theirs():
    time = np.linspace(0.0, 4.0, 8001)
    signal = np.cos(2.0 * math.pi * time) + 0.01 * np.sin(2.0 * math.pi * 35.0 * time)
    _, first, second = derivatives(time, signal, 150.0)
    inner = slice(800, -800)
    true = -2.0 * math.pi * np.sin(2.0 * math.pi * time) + 0.7 * math.pi * np.cos(70.0 * math.pi * time)
    assert first[inner] == pytest.approx(true[inner], abs=1e-3)
    curved = -((2.0 * math.pi) ** 2) * np.cos(2.0 * math.pi * time) - 49.0 * math.pi**2 * np.sin(70.0 * math.pi * time)
    assert second[inner] == pytest.approx(curved[inner], abs=0.3)


@pytest.fixture
def files(tmp_path):
    """A swing that MuJoCo made, and its model."""
    _, recording = by_mujoco(damping=0.0)
    path = tmp_path / "swing.csv"
    rows = [f"{t:.6f},{x:.9f}" for t, x in zip(recording.time, recording.channels[0].values, strict=True)]
    path.write_text("\n".join(["time,pivot.position", *rows]) + "\n", encoding="utf-8")
    model = tmp_path / "rigid.toml"
    model.write_text(to_toml(paper_pendulum())[0], encoding="utf-8")
    return str(path), str(model)


def test_the_command_tells_it_to_persons_and_programs(files, tmp_path, capsys):
    recording, model = files
    out = tmp_path / "out"
    assert status_of(["diagnose", recording, "--model", model, "--engine", "as_printed", "--out", str(out)]) == 0
    assert "do not balance along the recording" in capsys.readouterr().out
    told = json.loads((out / "balance.json").read_text(encoding="utf-8"))
    schema = json.loads(Path("docs/schemas/denoc.balance-1.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator(schema).validate(told)
    assert {mend["term"] for mend in told["mends"]} <= {"gravity", "inertia by pivot"}
    assert (out / "balance.svg").read_text(encoding="utf-8").startswith("<svg")
    assert status_of(["diagnose", recording, "--model", model, "--engine", "as_printed", "--strict"]) == 1
    assert status_of(["diagnose", recording, "--model", model, "--engine", "mujoco", "--strict"]) == 0
    assert "asks for no change" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--engine", "denoc"], "leave out --engine"),
        (["--engine", "as_printd"], "as_printed"),
        (["--engine", "as_printed", "--fit-effort"], "does not go with --engine"),
        (["--engine", "exudyn_ancf"], "cannot run it"),
        (["--engine", "as_printed", "--map", "pivot.position=ignore"], "pivot.position"),
    ],
)
def test_what_cannot_be_asked_is_one_line(files, arguments, words, capsys):
    recording, model = files
    assert status_of(["diagnose", recording, "--model", model, *arguments]) == 2
    told = capsys.readouterr().err
    assert words in told
    assert told.count("\n") == 1
