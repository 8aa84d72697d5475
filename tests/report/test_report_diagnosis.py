"""A diagnosis as a page and on the terminal, from the document of the contract."""

from __future__ import annotations

import io
import re

from diagnosed import document
from lxml import html as lxml_html
from rich.console import Console

from harness.report.bench import bench_files, print_bench
from harness.report.diagnosis import print_diagnosis
from harness.report.diagnosis.page import diagnosis_html
from harness.report.diagnosis.sections.answer import paragraphs
from harness.report.diagnosis.sections.findings import by_parameter
from harness.report.proof import print_proof
from harness.report.proof_page import proof_html

NASTY = "<b>bold</b>"
DOCUMENT = {
    "schema": "denoc.diagnosis/1",
    "verdict": "partly_explained",
    "summary": f"Dry friction {NASTY}.",
    "noise": [{"channel": "pivot.position", "std": 0.0031, "unit": "rad"}],
    "mismatch": [
        {
            "channel": "pivot.position", "side": "dynamics", "site": "pivot", "time": [[4.1, 16.0]], "frequency_hz": [0.4, 1.1],
            "region": {}, "severity": 57.2, "what": NASTY,
        }
    ],
    "findings": [
        {
            "effect": "coulomb_friction", "site": "pivot",
            "parameters": {"torque": {"value": 0.0118, "std": None, "ci95": [0.0114, 0.0122], "unit": "N*m"}},
            "evidence": {"delta_bic": 912.0, "probability": 0.999}, "indistinguishable_from": ["base_tilt"],
        },
        {
            "effect": "geometric_stiffening", "site": "rod", "parameters": {}, "evidence": {"delta_bic": 12.0, "probability": 0.9},
            "indistinguishable_from": [],
        },
    ],
    "ranking": [
        {"effects": ["coulomb_friction@pivot"], "bic": -4.1e4, "heldout_rmse": 0.0031},
        {"effects": [], "bic": None, "heldout_rmse": None},
    ],
    "fit": [
        {
            "channel": "pivot.position", "unit": "rad", "nominal": {"train_rmse": 0.31, "heldout_rmse": None},
            "augmented": {"train_rmse": 0.0031, "heldout_rmse": 0.0032}, "noise_floor": 0.0031,
        }
    ],
    "remainder": {"significant": False},
    "next_experiment": {"what": "release from 0.3 rad", "separates": ["coulomb_friction"]},
}  # fmt: skip


def held_out(before: float, after: float) -> str:
    row = {
        "channel": "pivot.position", "unit": "rad", "nominal": {"heldout_rmse": before}, "augmented": {"heldout_rmse": after},
        "noise_floor": 0.00095,
    }  # fmt: skip
    return paragraphs({**DOCUMENT, "fit": [row], "explained_share": 1.0 - (after / before) ** 2})[1]


def test_an_error_that_stays_is_not_said_to_fall():
    """A late release, say, is nothing in data held out that go on from where the release is long past."""
    assert "is 0.000953 rad with or without" in held_out(0.0009530, 0.0009532)
    assert "%" not in held_out(0.0009530, 0.0009532)
    assert "is 0.00200 rad, before it was 0.00100" in held_out(0.001, 0.002)
    assert "falls from 0.0200 to 0.00100 rad (noise 0.000950). That removes 99.8 % of" in held_out(0.02, 0.001)


def test_one_figure_is_spelled_one_way():
    """On the terminal and on the page: 8529221 here and 8.53e+06 there look like two."""
    finding = {**DOCUMENT["findings"][0], "evidence": {"delta_bic": 8529221.0}}
    ranking = [{"effects": ["coulomb_friction@pivot"], "bic": -8529221.0, "heldout_rmse": 0.0031}]
    ranking.append({"effects": [], "bic": 0.0, "heldout_rmse": 0.31})
    document = {**DOCUMENT, "findings": [finding], "ranking": ranking}
    screen = Console(file=io.StringIO(), width=160)
    print_diagnosis(document, screen)
    for text in (screen.file.getvalue(), lxml_html.fromstring(diagnosis_html(document)).text_content()):
        assert text.count("8.53e6") == 2 and "8529221" not in text
        assert "e+06" not in text


def test_how_firmly_a_finding_is_held_stands_on_terminal_and_page():
    first, other = DOCUMENT["findings"][0], {**DOCUMENT["findings"][0], "site": "elbow"}
    document = {**DOCUMENT, "findings": [{**first, "grade": "established"}, {**other, "grade": "possible"}]}
    screen = Console(file=io.StringIO(), width=200)
    print_diagnosis(document, screen)
    (head,) = (line for line in screen.file.getvalue().splitlines() if line.startswith("effect"))
    rows = [line for line in screen.file.getvalue().splitlines() if line.startswith("coulomb_friction ")]
    assert [row[head.index("grade") :].split()[0] for row in rows] == ["established", "possible"]
    text = lxml_html.fromstring(diagnosis_html(document)).text_content()
    assert "established" in text and "possible" in text
    # Of findings without one, as an older build told them, there is no such column.
    screen = Console(file=io.StringIO(), width=200)
    print_diagnosis(DOCUMENT, screen)
    assert "grade" not in screen.file.getvalue()


def test_the_page_shows_everything_and_escapes_it():
    page = diagnosis_html(DOCUMENT)
    text = lxml_html.fromstring(page).text_content()
    for word in (
        "Partly explained",
        "coulomb friction",
        "0.0114 … 0.0122",
        "geometric stiffening",
        "release from 0.3 rad",
        NASTY,
    ):
        assert word in text
    assert NASTY not in page
    assert not re.findall(r"""(?:src|href)\s*=\s*["'](?!#)""", page)


def test_what_there_was_no_time_for_is_said_in_words():
    text = lxml_html.fromstring(diagnosis_html(document())).text_content()
    assert "Not tried: sets with backlash at pivot." in text
    assert "may_change" not in text


def test_the_page_of_a_consistent_model():
    document = {
        **DOCUMENT,
        "verdict": "consistent",
        "mismatch": [],
        "findings": [],
        "ranking": [],
        "next_experiment": {},
    }
    text = lxml_html.fromstring(diagnosis_html(document)).text_content()
    assert "Consistent" in text
    assert "Where the model leaves" not in text


def test_levels_of_friction_are_shown_where_there_are_any():
    rows = [
        {"recording": NASTY, "held_out": False, "factor": 1.153, "std": 0.0123, "shared_rmse": 0.0456, "levelled_rmse": 0.00789},
        {"recording": "last", "held_out": True, "factor": None, "std": None, "shared_rmse": 0.0111, "levelled_rmse": 0.00222},
    ]  # fmt: skip
    levels = {"joints": ["pivot"], "chance": 1e-9, "recordings": rows, "laws": [], "how": "Fitted to the training."}
    document = {**DOCUMENT, "levels": levels}
    page = diagnosis_html(document)
    screen = Console(file=io.StringIO(), width=200)
    print_diagnosis(document, screen)
    for text in (lxml_html.fromstring(page).text_content(), screen.file.getvalue()):
        for word in (
            NASTY,
            "last (held out)",
            "1.15",
            "0.0123",
            "0.0456",
            "0.00789",
            "0.00222",
            "Fitted to the training.",
        ):
            assert word in text
    assert NASTY not in page
    assert "recording by recording" not in diagnosis_html(DOCUMENT)


def test_what_recordings_that_disagree_say_by_themselves_is_shown():
    def number(value):
        return {"value": value, "std": 0.001, "ci95": [value - 0.002, value + 0.002], "unit": "m"}

    drag = {"value": 2e-4, "std": 1e-5, "ci95": [1.8e-4, 2.2e-4], "unit": "N*m*s/rad"}
    rows = [
        {"recording": name, "times_noise": 1.03,
         "parameters": {"viscous_damping@pivot.coefficient": drag, "com_offset@rod.offset": number(value)}}
        for name, value in ((NASTY, 0.0321), ("last", 0.0111))
    ]  # fmt: skip
    apart = {
        "effects": ["viscous_damping@pivot", "com_offset@rod"], "times_noise_together": 37.2, "recordings": rows,
        "differing": ["com_offset@rod.offset"],
    }  # fmt: skip
    document = {**DOCUMENT, "disagreement": apart}
    page = diagnosis_html(document)
    screen = Console(file=io.StringIO(), width=200)
    print_diagnosis(document, screen)
    parsed = lxml_html.fromstring(page)
    for text in (parsed.text_content(), screen.file.getvalue()):
        for word in (NASTY, "last", "com_offset@rod.offset [m]", "0.0321 (0.0301 … 0.0341)", "0.0111", "1.03"):
            assert word in text
    assert "37.2" in parsed.text_content() and NASTY not in page
    # What differs comes first, and is set off.
    strong = [e.text_content() for e in parsed.xpath("//strong")]
    assert any("0.0321" in told for told in strong) and not any("0.0002" in told for told in strong)
    assert "disagree with one another" not in diagnosis_html(DOCUMENT)


def test_repeatability_is_read_however_it_is_told():
    row = {"value": 0.1, "ci95": [0.0, 0.2]}
    wanted = {"torque": [{"recording": "a", **row}]}
    assert by_parameter([{"recording": "a", "parameters": {"torque": row, "other": {"value": None}}}]) == wanted
    assert by_parameter({"torque": [{"recording": "a", **row}]}) == wanted
    (told,) = by_parameter([{"recording": "a", "parameter": "torque", **row}])["torque"]
    assert (told["recording"], told["value"]) == ("a", 0.1)
    assert by_parameter(None) == {}


def test_the_terminal_says_the_same():
    screen = Console(file=io.StringIO(), width=200)
    print_diagnosis(DOCUMENT, screen)
    text = screen.file.getvalue()
    for word in (
        "partly explained",
        NASTY,
        "coulomb_friction",
        "0.0118",
        "base_tilt",
        "release from 0.3 rad",
        "0.0032",
    ):
        assert word in text


def test_benchmarks_are_shown_with_their_ratios():
    rows = [
        {"what": "forward_dynamics", "n": n, "peer": "pinocchio", "ours": 1e-7 * n, "theirs": 3e-7 * n, "ratio": 3.0, "unit": "s",
         "wanted": 2.5, "met": True, "note": ""}
        for n in (1, 7)
    ]  # fmt: skip
    rows.append(
        {**rows[0], "peer": "mujoco", "ours": None, "theirs": None, "ratio": None, "met": None, "note": "a | b"}
    )
    document = {"schema": "denoc.bench/1", "machine": {"cpu": "x"}, "rows": rows}
    files = bench_files(document)
    assert "forward dynamics" in files["report.html"] and "<svg" in files["report.html"]
    assert "a \\| b" in files["bench.md"]
    screen = Console(file=io.StringIO(), width=200)
    print_bench(document, screen)
    assert "700 ns" in screen.file.getvalue()


def test_the_proof_has_its_pictures():
    document = {
        "schema": "denoc.proof/1", "seed": 7, "cases": 12, "named_single": [9, 10], "clean_false": [0, 2], "coverage95": 0.94,
        "wilson95": {"named_single": [0.6, 0.98], "clean_false": [0.0, 0.66]},
        "confusion": {"coulomb_friction": {"coulomb_friction": 5, "explained": 1}, "nothing": {"consistent": 2}},
        "detection": {"coulomb_friction": [[k + 1.0, k > 2] for k in range(10)], "base_tilt": []},
    }  # fmt: skip
    page = proof_html(document)
    text = lxml_html.fromstring(page).text_content()
    assert page.count("<svg") == 2
    assert "9 of 10" in text and "60–98 %" in text and "seed 7" in text
    assert "<svg" not in proof_html({**document, "confusion": {}, "detection": {}})


def test_the_proof_lists_its_cases_and_its_peers():
    said = {"asked": 4, "failed": 1, "clean_false": [2, 3], "named_single": [0, 1], "false_beside_single": [1, 1]}
    case = {
        "name": "outside-3", "kind": "outside", "planted": [], "outside": "sloshing_bob", "found": [], "visibility": [41.2],
        "verdict": "unexplained", "floor": float("nan"), "seconds": 3.0, "error": "", "right": True,
    }  # fmt: skip
    document = {
        "schema": "denoc.proof/1", "seed": 7, "cases": 1, "named_single": [0, 0],
        "peers": {"mujoco.sysid": {**said, "claims": {"nothing": {"coulomb_friction": 2, "nothing": 1}}}}, "scores": [case],
    }  # fmt: skip
    text = lxml_html.fromstring(proof_html(document)).text_content()
    assert "sloshing bob" in text and "unexplained" in text
    assert "2 of 3" in text and "coulomb friction 2" in text
    screen = Console(file=io.StringIO(), width=200)
    print_proof(document, screen)
    assert "mujoco.sysid" in screen.file.getvalue() and "2/3" in screen.file.getvalue()
