"""The report's files: complete, escaped, whole or not at all, and self-contained."""

from __future__ import annotations

import csv
import io
import math
import re
from dataclasses import replace

import pytest
from junitparser import JUnitXml
from lxml import etree
from lxml import html as lxml_html

from harness.cases.case import Row, Series
from harness.cases.results import Results
from harness.errors import InputError
from harness.report.html import html
from harness.report.junit import junit
from harness.report.markdown import markdown
from harness.report.table_csv import table_csv
from harness.report.terminal import print_results
from harness.report.write import FILES, write_reports
from harness.whole_files import staged, write_folder, write_whole

NASTY = '<script>alert("x")</script> | a & b'
PASSED = Row("swing", "mass_matrix", ("denoc", "mujoco"), 3e-10, 1e-8, "rad", "because", "pass", source="a book")
FAILED = Row(
    NASTY,
    "trajectory",
    ("denoc", "pinocchio"),
    2e-3,
    1e-8,
    "rad",
    NASTY,
    "fail",
    NASTY,
    {"time": 3.25, "joint": NASTY},
    NASTY,
)
SKIPPED = Row("swing", "all", ("denoc", "far"), None, None, "1", "", "skipped", "not installed")
LINES = tuple(
    Series(
        "swing",
        figure,
        f"{engine}: pivot",
        (0.0, 1.0, 2.0),
        (0.1, 0.2, shift),
        "time [s]",
        "angle [rad]",
        NASTY,
        log=log,
    )
    for figure, log in (("trajectory", ""), ("divergence", "y"), ("frequency_amplitude", ""), ("never_heard_of", "xy"))
    for engine, shift in (("denoc", 0.3), ("mujoco", 0.31))
)
RESULTS = Results(
    (PASSED, FAILED, SKIPPED),
    LINES,
    {"numpy": "2.0"},
    {"swing": "A swing", NASTY: NASTY},
    "2026-01-02",
    12.0,
    {"swing": 1.5},
)


def test_html_opens_without_a_network_and_runs_nothing():
    page = html(RESULTS)
    assert "<script" not in page
    # Namespaces of SVG are names, not addresses that are fetched.
    fetched = re.findall(r"""(?:src|href)\s*=\s*["']([^"'#][^"']*)["']|url\(["']?([^#)"']+)|@import\s+(\S+)""", page)
    assert fetched == []


def test_html_shows_every_row_and_every_picture():
    tree = lxml_html.fromstring(html(RESULTS))
    verdicts = [row.get("class") for row in tree.iterfind(".//tbody/tr") if row.get("class")]
    assert sorted(verdicts) == ["fail", "pass", "skipped"]
    # One picture for the group's distances, one for each figure of the case.
    assert len(tree.findall(".//figure")) == 5
    assert NASTY in tree.text_content()
    assert tree.find(".//details[@open]") is not None


def test_identifiers_inside_the_pictures_are_not_shared():
    page = html(RESULTS)
    defined = re.findall(r'<clipPath id="([^"]+)"', page)
    assert len(defined) == len(set(defined))


def test_pictures_follow_the_page_in_light_and_dark():
    page = html(RESULTS)
    assert "prefers-color-scheme: dark" in page
    assert "var(--ink)" in page
    for stand_in in ("#010203", "#020304", "#030405"):
        assert stand_in not in page


def test_html_of_nothing_says_so():
    assert "Nothing could be compared" in html(Results(()))


def test_a_difference_that_is_no_number_is_drawn_and_named():
    page = html(Results((Row("swing", "period", ("denoc", "x"), math.nan, 1e-8, "1", "", "fail"),)))
    assert "not finite" in page


def test_markdown_keeps_its_columns():
    text = markdown(RESULTS)
    table = [line for line in text.splitlines() if line.startswith("|")]
    rows = [line for line in table if "✓" in line or "✗" in line]
    assert len(rows) == 2
    for row in rows:
        assert len(re.findall(r"(?<!\\)\|", row)) == 10
    assert "<script" not in text


def test_csv_keeps_every_digit_and_every_row():
    rows = list(csv.DictReader(io.StringIO(table_csv(RESULTS), newline="")))
    assert len(rows) == 3
    assert float(rows[0]["difference"]) == PASSED.difference
    assert rows[1]["case"] == NASTY
    assert rows[0]["engines"] == "denoc+mujoco"


def test_csv_gives_a_spreadsheet_no_formula():
    row = Row("=1+1", "q", ("a",), 1.0, 2.0, "1", "", "pass", "@SUM(A1)")
    (read,) = csv.DictReader(io.StringIO(table_csv(Results((row,))), newline=""))
    assert (read["case"], read["note"]) == ("'=1+1", "'@SUM(A1)")


def test_junit_counts_what_failed():
    document = JUnitXml.fromstring(junit(RESULTS))
    assert (document.tests, document.failures, document.skipped) == (3, 1, 1)
    assert NASTY in {suite.name for suite in document}


def test_junit_survives_control_characters():
    row = Row("bell\x07", "q", ("a",), 1.0, 2.0, "1", "", "fail", "null \x00 byte")
    assert JUnitXml.fromstring(junit(Results((row,)))).failures == 1


def test_terminal_shows_a_line_a_group_then_what_failed_and_what_could_not_be():
    from rich.console import Console

    def shown(*rows, **options):
        screen = Console(file=io.StringIO(), width=200)
        print_results(Results(rows), screen, **options)
        return screen.file.getvalue().splitlines()

    close = Row("swing", "period", ("denoc", "mujoco"), 9e-9, 1e-8, "1", "", "pass")
    lines = shown(PASSED, close, SKIPPED)
    (group,) = [line for line in lines if line.startswith("Rigid pendulums")]
    # One case, two rows compared, none failed, one not possible; 9e-9 of 1e-8.
    assert re.split(r"  +", group)[1:] == ["1", "2", "0", "1", "90 %", "swing: period, denoc · mujoco"]
    assert not any("mass matrix" in line for line in lines)
    assert re.split(r"  +", next(line for line in lines if line.startswith("far "))) == [
        "far", "1", "swing", "not installed"
    ]  # fmt: skip
    lines = shown(PASSED, close, FAILED, SKIPPED)
    assert any("2.0e-03" in line and NASTY in line and "3.25" in line for line in lines)
    assert lines[-1] == "1 of 3 comparisons failed; 1 was not possible."
    assert sum("swing" in line for line in shown(PASSED, close, FAILED, SKIPPED, every_row=True)) == 3


def test_terminal_gives_each_model_of_the_users_a_line():
    from rich.console import Console

    rows = [replace(PASSED, case=name, group="models") for name in ("arm", "leg")]
    screen = Console(file=io.StringIO(), width=200)
    print_results(Results(tuple(rows)), screen)
    assert [line.split()[0] for line in screen.file.getvalue().splitlines()[1:3]] == ["arm", "leg"]


def test_every_format_is_written(tmp_path):
    written = write_reports(RESULTS, tmp_path / "new" / "folder")
    assert {path.name for path in written} == {"results.json", "results.md", "results.csv", "junit.xml", "report.html"}
    assert sorted(p.name for p in (tmp_path / "new" / "folder").iterdir()) == sorted(path.name for path in written)
    assert len(FILES) == 5


def test_an_unknown_format_is_refused():
    with pytest.raises(InputError, match="did you mean 'html'"):
        write_reports(RESULTS, "anywhere", ["htm"])


def test_what_breaks_while_writing_leaves_the_old_file(tmp_path):
    file = tmp_path / "out.txt"
    write_whole(file, "old")
    with pytest.raises(RuntimeError), staged(file) as temporary:
        temporary.write_text("half")
        raise RuntimeError("power cut")
    assert file.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["out.txt"]


def test_places_that_cannot_be_written_to_are_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="not a folder"):
        write_folder(tmp_path / "file", {"a": "b"})
    with pytest.raises(InputError, match="is a folder"):
        write_whole(tmp_path, "x")
    with pytest.raises(InputError, match="cannot be written"):
        write_whole(tmp_path / "file" / "below" / "x.txt", "x")


def test_pictures_stand_alone(tmp_path):
    written = write_reports(RESULTS, tmp_path, ["svg"])
    assert len(written) == 5
    for path in written:
        text = path.read_text()
        assert "var(--" not in text
        etree.fromstring(text.encode())
