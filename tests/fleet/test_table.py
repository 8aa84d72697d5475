"""One table of many answers: effects by unit and grade, spread, outliers, failures; and memory that does not grow with them."""

from __future__ import annotations

import json
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from fleets import answer

from harness.fleet.kept import answer_file, answers, write
from harness.fleet.table import Table
from harness.fleet.units import Unit
from harness.report.fleet import fleet_html, print_fleet

TORQUE, BETWEEN, STD = 0.01, 1e-3, 1e-4


def filled(units: int, seed: int = 3) -> Table:
    rng = np.random.default_rng(seed)
    table = Table()
    for k in range(units):
        table.add(f"unit{k}", answer(TORQUE + BETWEEN * rng.standard_normal() + STD * rng.standard_normal(), std=STD))
    return table


def test_numbers_are_spread_as_they_were_drawn():
    table = filled(400)
    table.add("heavy", answer(0.03, std=STD))
    table.add("broken", {**answer(0.0), "diagnosis": None, "failed": "broken.csv: the file is empty (record again)"})
    table.add("guess", answer(9.0, grade="possible"))
    table.add("odd", answer(0.02, effect="constant_torque"))
    table.add("missing", None)
    found = table.document()
    assert (found["units"], found["diagnosed"], found["verdicts"]) == (405, 403, {"explained": 403})
    assert [row["unit"] for row in found["failed"]] == ["broken", "missing"]
    friction = found["effects"][0]
    assert (friction["effect"], len(friction["established"]), friction["possible"]) == (
        "coulomb_friction",
        401,
        ["guess"],
    )
    number = found["parameters"][0]
    assert (number["number"], number["outliers"]) == (401, 1)
    # Standard errors of a median, and of a standard deviation, from 400 draws: 6 % and 3.5 % of the spread.
    assert number["median"] == pytest.approx(TORQUE, abs=3 * 0.063 * BETWEEN)
    assert number["between"]["robust"] == pytest.approx(BETWEEN, rel=0.2)
    assert [row["unit"] for row in found["outliers"]] == ["heavy"]
    assert found["outliers"][0]["z"] == pytest.approx((0.03 - TORQUE) / BETWEEN, rel=0.2)
    assert [(row["unit"], row["others"]) for row in found["rare"]] == [("odd", 0)]


def test_a_phase_has_no_median():
    table = Table()
    for k in range(12):
        told = answer(0.01)
        told["diagnosis"]["findings"][0]["parameters"]["phase"] = {
            "value": 3.1 * (-1) ** k,
            "std": 0.1,
            "ci95": None,
            "unit": "rad",
        }
        table.add(str(k), told)
    phase = next(row for row in table.document()["parameters"] if row["parameter"] == "phase")
    assert (phase["number"], phase["median"], phase["outliers"]) == (12, None, None)


def test_numbers_at_their_bound_count_without_an_interval():
    table = filled(20)
    told = answer(0.01)
    told["diagnosis"]["findings"][0]["parameters"]["torque"]["std"] = None
    table.add("bound", told)
    number = table.document()["parameters"][0]
    assert (number["number"], number["with_interval"]) == (21, 20)


def kept(folder: Path, count: int) -> list[Unit]:
    units = [Unit(f"unit{k}.csv", ()) for k in range(count)]
    (folder / "units").mkdir(parents=True)
    rng = np.random.default_rng(1)
    for unit in units:
        # As long as what a diagnosis of one pendulum is told in.
        told = answer(TORQUE + BETWEEN * rng.standard_normal(), std=STD)
        told["diagnosis"]["ranking"] = [{"effects": [f"effect{j}@pivot"], "bic": float(j)} for j in range(80)]
        write(answer_file(folder, unit.name), told)
    return units


def peak(folder: Path, units: list[Unit]) -> int:
    tracemalloc.start()
    table = Table()
    for name, told in answers(folder, units):
        table.add(name, told)
    found = table.document()
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert found["diagnosed"] == len(units)
    return most


def test_memory_is_that_of_the_numbers_and_not_of_the_answers(tmp_path):
    """Ten times the units take no more than their names and numbers, some hundred bytes each: answers pass through one by one."""
    few, many = kept(tmp_path / "few", 200), kept(tmp_path / "many", 2000)
    size = answer_file(tmp_path / "few", few[0].name).stat().st_size
    peak(tmp_path / "few", few)  # what is loaded once
    grown = peak(tmp_path / "many", many) - peak(tmp_path / "few", few)
    assert size > 3000
    assert grown < 300 * 1800


def test_the_document_is_told_on_terminal_and_page():
    from rich.console import Console

    table = filled(40)
    table.add("<heavy>", answer(0.03, std=STD))
    document = {**table.document(), "source": "fleet", "model": None, "others": []}
    console = Console(width=200, record=True)
    print_fleet(document, console)
    text = console.export_text()
    assert "41 of 41 units diagnosed" in text and "<heavy>" in text and "coulomb_friction" in text
    page = fleet_html(json.loads(json.dumps(document)))
    assert "&lt;heavy&gt;" in page and "<heavy>" not in page and "Paule and Mandel" in page and "<svg" in page
