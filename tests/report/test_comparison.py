"""Two results files held against one another: every kind of change is told once, the gravest first."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness.cases.between import KINDS, between
from harness.cases.case import Row
from harness.cases.gate import Judged, Judgement
from harness.cases.results import Results
from harness.cli.main import status_of
from harness.report.comparison import comparison_html, comparison_markdown, headline, lines, of
from harness.report.html import html


def row(case: str, difference: float | None, allowed: float | None = 1e-8, verdict: str = "pass", **more: Any) -> Row:
    return Row(case, "trajectory", ("denoc", "mujoco"), difference, allowed, "rad", "", verdict, **more)


WHY = "the masses differ: mass of link <upper> explains it"
BEFORE = Results(
    (
        row("same", 1e-9), row("fails", 1e-9), row("lost", 1e-9), row("gone", 1e-9), row("limit", 1e-9), row("grew", 1e-9),
        row("still", 1e-3, verdict="fail"), row("mended", 1e-3, verdict="fail"), row("shrank", 9e-9),
    ),
    versions={"mujoco": "3.2"},
)  # fmt: skip
AFTER = Results(
    (
        row("same", 1.5e-9), row("new", 1e-9), row("shrank", 1e-9), row("mended", 1e-9), row("still", 1e-3, verdict="fail"),
        row("grew", 6e-9), row("limit", 1e-9, 1e-6), row("lost", None, None, "skipped", note="mujoco is not installed"),
        row("fails", 3e-4, verdict="fail", note=WHY, first_divergence={"time": 3.2, "joint": "elbow"}),
    ),
    versions={"mujoco": "3.3"},
)  # fmt: skip


def test_every_kind_of_change_is_told_once_and_in_order() -> None:
    found = between(BEFORE, AFTER)
    assert [(one.kind, one.key.split("/")[0]) for one in found.changed] == [
        ("failed", "fails"), ("lost", "lost"), ("gone", "gone"), ("loosened", "limit"), ("grew", "grew"), ("failing", "still"),
        ("mended", "mended"), ("shrank", "shrank"), ("new", "new"),
    ]  # fmt: skip
    assert list(KINDS) == [one.kind for one in found.changed]
    assert found.same == 1
    assert found.worse
    assert found.versions == {"mujoco": ("3.2", "3.3")}
    assert headline(found).endswith("one row is as it was.")


def test_what_changed_in_a_file_stands_before_what_comes_of_it_and_engines_that_say_the_same_are_one_row() -> None:
    def rows(verdict: str, by: float, mass: float, **place: Any) -> Results:
        figures = [
            Row(
                "arm", "recorded_gravity", (name, "recorded"), by, 1e-9, "1", "", verdict, first_divergence={"state": 3}
            )
            for name in ("denoc", "pinocchio", "mujoco")
        ]
        said = replace(figures[0], quantity="masses", difference=mass, note="mass of link 'upper': 2 → 2.1", **place)
        return Results((*figures, said))

    place = {"first_divergence": {"link": "upper", "value": "mass"}}
    found = between(rows("pass", 2e-16, 0.0), rows("fail", 0.3, 0.05, **place))
    assert [one.key.split("/")[1] for one in found.changed] == ["masses", *["recorded_gravity"] * 3]
    shown = lines(found.changed)
    assert [row[2:6] for row in shown] == [
        ("masses", "denoc · recorded", "0", "5.0e-02"),
        ("recorded gravity", "denoc, pinocchio, mujoco · recorded", "2.0e-16", "3.0e-01"),
    ]
    assert "4 pass no more" in comparison_html(found)


def test_a_run_against_itself_changes_nothing() -> None:
    found = between(AFTER, AFTER)
    assert [one.kind for one in found.changed] == ["failing", "failing"]
    assert not found.worse


def test_where_when_and_why_are_on_the_page_and_escaped() -> None:
    page, text = comparison_html(between(BEFORE, AFTER)), comparison_markdown(between(BEFORE, AFTER))
    for words in ("passes no more", "time 3.2 s, joint elbow", "allowed 1.0e-08 rad → 1.0e-06 rad"):
        assert words in page
        assert words in text
    assert "&lt;upper&gt;" in page
    assert "<upper>" not in page
    assert page.index("1 passes no more") < page.index("1 is not compared any more") < page.index("1 is new")


def test_the_command_compares_two_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, results in (("before", BEFORE), ("after", AFTER)):
        (tmp_path / f"{name}.json").write_text(results.to_text())
    before, after = str(tmp_path / "before.json"), str(tmp_path / "after.json")
    assert status_of(["report", after, "--against", before, "--out", str(tmp_path / "out")]) == 1
    told = capsys.readouterr().out
    assert told.startswith("Of the rows, 1 passes no more")
    document = json.loads((tmp_path / "out" / "comparison.json").read_text())
    assert document["schema"] == "denoc.comparison/1"
    assert document["rows"][0]["first_divergence"] == {"time": 3.2, "joint": "elbow"}
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "comparison.html",
        "comparison.md",
        "comparison.json",
    }
    assert status_of(["report", after, "--against", after]) == 0
    assert status_of(["report", after, "--against", str(tmp_path / "none.json")]) == 2


def test_the_page_of_a_gate_begins_with_what_closes_it() -> None:
    failed = AFTER.rows[-1]
    judgement = Judgement(
        (
            Judged(failed.key, failed, 1e-9, 3e-4, "left the line: 3.00e-04 where 1e-08 is allowed"),
            Judged("a/b/c+d", AFTER.rows[0]),
        ),
        {"mujoco": ("3.2", "3.3")},
    )
    page = html(AFTER, judgement=judgement)
    assert "<title>DeNOC gate" in page
    assert "Closed: 1 of 2 rows." in page
    places = [
        page.index(words)
        for words in ("<td>left the line</td>", ">3.0e-04<", "time 3.2 s, joint elbow", "&lt;upper&gt; explains")
    ]
    assert places == sorted(places)
    assert places[-1] < page.index("Summary</h2>")


def test_one_row_passes_and_several_pass():
    assert [of("mended", count) for count in (1, 4)] == ["passes now", "pass now"]
    assert [of("new", 2), of("loosened", 2), of("failing", 2), of("grew", 2)] == [
        "are new", "have another limit", "fail in both", "grew",
    ]  # fmt: skip
