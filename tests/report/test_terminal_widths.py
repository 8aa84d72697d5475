"""No figure is cut at any width: every word of every cell of every table stands whole in what is printed."""

from __future__ import annotations

import io
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.cells import cell_len
from rich.console import Console

from harness.cases.case import Row
from harness.cases.gate import Judged, Judgement
from harness.cases.results import Results
from harness.cli import options
from harness.cli.main import status_of
from harness.report import words
from harness.report.bench import cells, print_bench
from harness.report.columns import figures, print_table
from harness.report.decay import print_bands, print_decay
from harness.report.diagnosis import print_diagnosis
from harness.report.gate import print_judgement
from harness.report.proof import print_proof
from harness.report.terminal import print_results

ROOT = Path(__file__).parents[2]
WIDTHS = (60, 80, 100, 120, options.UNLIMITED)
NOTE = "odd one out: exudyn; gravity is to blame, first at 3.25 s, elbow, where the mass matrix is nearly singular"
ROWS = (
    Row("rigid_pendulum_damped", "trajectory", ("denoc", "mujoco"), 3.5e-10, 1.0e-08, "rad/s", "book", "pass", NOTE),
    Row("rotating_cantilever", "frequency_amplitude", ("pinocchio", "exudyn_ancf"), 9.43e-9, 1.0e-08, "1", "book", "pass"),
    Row("arm", "trajectory_to_horizon", ("denoc", "pinocchio"), 2.1e-3, 1.0e-12, "m/s", "book", "fail", NOTE, {"time": 3.25}),
    Row("arm", "energy", ("denoc", "exudyn"), math.nan, 1.0e-12, "1", "book", "fail", group="models"),
    Row("arm", "all", ("denoc", "exudyn_ffrf"), None, None, "1", "", "skipped", NOTE, group="models"),
)  # fmt: skip


def printed(show, width: int) -> str:
    screen = Console(file=io.StringIO(), width=width)
    show(screen)
    text = screen.file.getvalue()
    assert max(map(cell_len, text.splitlines()), default=0) <= width
    return text


def assert_whole(text: str, *cells_of: str) -> None:
    found = re.split(r"[\s;]+", text)
    for cell in cells_of:
        for word in re.split(r"[\s;]+", cell.strip("; ")):
            assert not word or word in found, f"{word!r} is cut in\n{text}"


@pytest.mark.parametrize("width", WIDTHS)
def test_results_are_whole(width):
    rows = printed(lambda screen: print_results(Results(ROWS), screen, every_row=True), width)
    short = printed(lambda screen: print_results(Results(ROWS), screen), width)
    for row in ROWS:
        for text in [rows] + [short] * (row.verdict == "fail"):
            assert_whole(
                text, row.case, words.quantity(row.quantity), *row.engines, words.figure(row.allowed), row.note,
                words.figure(row.difference, verdict=row.verdict),
            )  # fmt: skip
    assert_whole(short, "2.1e+09 times", "not finite", "arm:", NOTE)


def test_one_reason_is_told_once_for_all_quantities_it_spoils():
    """A file read otherwise by one engine is one thing to know, in however many quantities, and how far, it shows."""
    missing = "body 'hull': mass 0 kg for 60.6 kg here"
    rows = tuple(
        Row(
            "buoy",
            name,
            ("denoc", "pinocchio"),
            None,
            None,
            "1",
            "",
            "skipped",
            f"as read, up to {far} apart: {missing}",
        )
        for name, far in (("bias", "601.7 N·m"), ("gravity", "602.4 N·m"), ("mass_matrix", "61.33 kg·m²"))
    )
    text = printed(lambda screen: print_results(Results(rows), screen), options.UNLIMITED)
    told = [line.split() for line in text.splitlines() if missing in line]
    assert [line[:3] for line in told] == [["pinocchio", "3", "buoy"]]
    # Each with its own figure where every row is asked for.
    assert_whole(
        printed(lambda screen: print_results(Results(rows), screen, every_row=True), 120), "601.7", "602.4", "61.33"
    )


def test_no_difference_is_no_share_of_nothing():
    """What is counted is allowed no difference at all: none is 0 %, and does not hide who takes most of what is allowed."""
    counted = Row("paper_rigid", "named", ("as_printed", "mujoco"), 0.0, 0.0, "1", "each misprint", "pass")
    near = Row("rigid_pendulum", "energy", ("denoc", "mujoco"), 2.5e-9, 1e-8, "1", "rounding", "pass")
    text = printed(lambda screen: print_results(Results((counted, near)), screen), 120)
    assert "25 %" in text
    assert "rigid_pendulum: energy" in text
    assert words.share(counted) == "0 %"
    assert words.share(replace(counted, difference=1.0, verdict="fail")) == "more than none"


@pytest.mark.parametrize("width", WIDTHS)
def test_the_gate_is_whole(width):
    judged = tuple(Judged(row.key, row, 1.2e-11, 3.4, NOTE) for row in ROWS[:4])
    text = printed(lambda screen: print_judgement(Judgement(judged, {}), None, screen), width)
    assert_whole(text, "1.2e-11", "3.5e-10", "9.4e-09", "2.1e-03", "not finite", "rigid_pendulum_damped", NOTE)


@pytest.mark.parametrize("width", WIDTHS)
def test_benchmarks_are_whole(width):
    rows = [
        {"what": "inverse_dynamics_batch_two_threads", "n": 1000, "peer": "pinocchio", "ours": 1.2345e-6, "theirs": 9.876e-6,
         "ratio": 8.003, "unit": "s", "wanted": 2.5, "met": True, "note": NOTE},
        {"what": "forward_dynamics_memory", "n": 10000, "peer": "mujoco", "ours": 12345.6, "theirs": None, "ratio": None,
         "unit": "MiB", "wanted": None, "met": None, "note": ""},
    ]  # fmt: skip
    text = printed(lambda screen: print_bench({"rows": rows}, screen), width)
    for row in rows:
        assert_whole(text, *cells(row))


@pytest.mark.parametrize("width", WIDTHS)
def test_a_proof_is_whole(width):
    said = {"failed": 12, "clean_false": [23, 34], "named_single": [45, 56], "false_beside_single": [67, 78]}
    document = {
        "seed": 1191924783, "cases": 201, "named_single": [172, 173], "clean_false": [0, 52], "outside_apart_told": [22, 23],
        "wilson95": {"named_single": [0.968, 0.999], "clean_false": [0.0, 0.069]}, "peers": {"mujoco.sysid": said},
    }  # fmt: skip
    text = printed(lambda screen: print_proof(document, screen), width)
    assert_whole(text, "172/173", "0/52", "22/23", "97–100 %", "0–7 %", "mujoco.sysid", "23/34", "45/56", "67/78", "12")


@pytest.mark.parametrize("width", WIDTHS)
def test_a_diagnosis_is_whole(width):
    from tests.report.test_report_diagnosis import DOCUMENT

    level = {
        "recording": "release_from_90_degrees.csv", "held_out": True, "factor": 1.153, "std": 0.0123, "shared_rmse": 0.04567,
        "levelled_rmse": 0.00789,
    }  # fmt: skip
    parameters = {
        name: {"value": value, "std": value / 100, "ci95": [0.98 * value, 1.02 * value], "unit": "N*m*s/rad"}
        for name, value in (("coulomb_torque", 0.01182), ("static_torque", 0.02345), ("stribeck_velocity", 0.6543))
    }
    finding = {
        "effect": "stribeck_friction", "site": "left_shoulder_pitch", "parameters": parameters, "evidence": {"delta_bic": 91234.0},
        "indistinguishable_from": ["base_tilt"],
    }  # fmt: skip
    document = {
        **DOCUMENT,
        "findings": [finding],
        "ranking": [
            {"effects": ["stribeck_friction@left_shoulder_pitch", "cogging_torque@elbow"], "bic": -4.1e4, "heldout_rmse": 0.00312},
            {"effects": [], "bic": -3.2e4, "heldout_rmse": 0.0765, "lost": "fits the recordings worse"},
        ],
        "quality": [{"recording": "release.csv", "channel": "left_shoulder_pitch.position", "what": NOTE, "done": NOTE}],
        "levels": {"recordings": [level], "how": NOTE},
        "replay": [{"engine": "mujoco", "channel": "pivot.position", "difference": 1.23e-5, "noise": 0.00312, "note": NOTE}],
    }  # fmt: skip
    text = printed(lambda screen: print_diagnosis(document, screen), width)
    assert_whole(
        text, "0.01182", "0.02345", "0.654", "91234", "9000", "0.00312", "0.0765", "0.0123", "0.0457", "0.00789", "1.15",
        "stribeck_friction@left_shoulder_pitch", "left_shoulder_pitch.position", "0.00310", "0.00320", "0.310", NOTE,
    )  # fmt: skip


@pytest.mark.parametrize("width", WIDTHS)
def test_tables_of_the_other_verbs_are_whole(width, capfd, monkeypatch, tmp_path):
    from harness.cases.examine import examine

    monkeypatch.setattr(options, "UNLIMITED", width)

    def said(*arguments: str) -> str:
        status_of(list(arguments))
        text = capfd.readouterr().out
        # Figures have to fit; what is one word and wider than the screen, such as a path, cannot.
        assert max(map(cell_len, text.splitlines())) <= width
        return text

    text = said("audit", str(ROOT / "models" / "toml" / "flexible_pendulum_as_printed.toml"), "--measured", "rod=37")
    assert_whole(text, "0.6 → 0.06", "0.002 → 0.001", "8000", "37.23", "40000 kg/m³")
    text = said("validate", "--list")
    assert_whole(text, "rigid_pendulum_damped", "chain_1000", "rotating_cantilever")
    # What these say is sentences, and paths that may be wider than a screen.
    monkeypatch.chdir(tmp_path)
    pendulum = str(ROOT / "models" / "urdf" / "rigid_pendulum.urdf")
    moved = ("--position", "pivot=1.2345", "--duration", "1", "--rate", "100", "--out", "r.csv")
    assert_whole(said("simulate", pendulum, *moved), "1.2345;", "r.csv")
    assert_whole(said("view", pendulum, "r.csv", "--out", "v.html"), "v.html")
    Path("found.json").write_text(Results(ROWS).to_text(), encoding="utf-8")
    assert_whole(said("report", "found.json", "--rows"), "3.5e-10", "1.0e-08", "2.1e-03", NOTE)
    if width == 60:
        text = said("doctor")
        for engine in examine():
            assert_whole(text, engine.name, engine.version or "–", engine.said)


LAW = {"value": 1.5034e-3, "std": 1.1e-5, "ci95": [1.481e-3, 1.525e-3], "unit": "N*m*s/rad"}
LOPSIDED = {"value": 0.4, "std": 10.0, "ci95": [0.005, 39.0], "unit": "N*m"}
DECAY: dict[str, Any] = {
    "channel": "pivot.position", "half_swings": 14, "from": 0.0123, "to": 7.98, "rest": 0.0012, "restoring": "sine",
    "frequency": {"small": 0.91234, "first": 0.8123}, "amplitude": {"first": 1.5, "last": 0.31},
    "decrement": {"value": 0.0812, "std": 0.0021, "damping_ratio": 0.01292, "printed": {"value": 1.234e-4}, "viscous": LAW},
    **{
        name: {"viscous": LAW, "dry": LOPSIDED, "quadratic": LAW, "rms": 1.234e-3, "noise": 1.2e-3, "memory": 0.0}
        for name in ("envelope", "linear", "likelihood")
    },
    "tried": [], "departure": None,
}  # fmt: skip
DECAY["likelihood"]["laws"] = ["viscous", "dry"]


@pytest.mark.parametrize("width", WIDTHS)
def test_a_decay_is_whole(width):
    text = printed(lambda screen: print_decay(DECAY, screen), width)
    for cell in ("0.001503 ± 1.1e-05", "0.005 … 39 (95 %), best 0.400", "0.000123", "0.00123"):
        assert any(cell in line for line in text.splitlines()), f"{cell!r} is broken in\n{text}"
    whole = {"value": 1.23456, "ci95": [1.23411, 1.23501]}
    band = {"band": "swing", "line": 12.34, **dict.fromkeys(("frequency", "amplitude", "rate", "damping_ratio"), whole)}
    text = printed(lambda screen: print_bands([band], "rad", screen), width)
    assert any("1.2346 (1.2341 … 1.2350)" in line for line in text.splitlines()), text
    assert_whole(text, "12.34")


def test_tables_are_made_in_one_place():
    """What cuts nothing is ``report/columns.py``; a table made beside it breaks figures where there is little room."""
    made = [path for path in (ROOT / "harness").rglob("*.py") if "rich.table" in path.read_text(encoding="utf-8")]
    assert made == [ROOT / "harness" / "report" / "columns.py"]


@pytest.mark.parametrize("width", WIDTHS)
def test_an_estimate_stays_on_its_line_in_whatever_column(width):
    words = "the inertia that the acceleration of the first mode of bending meets"
    rows = [(f"rod.mode{k}", words, f"1.0{k} ± 0.0019", f"{12495 + k}") for k in range(3)]
    text = printed(
        lambda screen: print_table(screen, ["of", "what is asked", "factor", "log Bayes factor"], rows), width
    )
    for row in rows:
        assert any(row[2] in line for line in text.splitlines()), text
    assert_whole(text, *(cell for row in rows for cell in row))


WORDS = st.text("abc.µ漢-1234567890", min_size=1, max_size=12)
CELLS = st.lists(WORDS, max_size=12).map(" ".join)


@settings(max_examples=150, deadline=None)
@given(
    table=st.integers(1, 6).flatmap(
        lambda n: st.lists(st.lists(CELLS, min_size=n, max_size=n), min_size=1, max_size=4)
    ),
    numbers=st.integers(0, 63),
    width=st.integers(60, 160),
)
def test_whatever_is_in_a_table_stands_whole_in_it(table, numbers, width):
    heads = [figures(f"head {k}") if numbers >> k & 1 else f"head {k}" for k in range(len(table[0]))]
    text = printed(lambda screen: print_table(screen, heads, table), width)
    assert_whole(text, *(cell for row in table for cell in row))
    # One line a row of figures alone: nothing of it slips to the next.
    narrow = [[re.sub(r"\s", "", cell)[:6] for cell in row] for row in table]
    text = printed(lambda screen: print_table(screen, heads, narrow), width)
    filled = [[cell for cell in row if cell] for row in narrow]
    lines = [line.split() for line in text.splitlines()]
    assert all(row in lines for row in filled if row)
