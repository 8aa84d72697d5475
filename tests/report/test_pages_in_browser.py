"""The pages of the suite, of the gate and of two runs compared, in a real browser: no name makes them wider than a telephone."""

from __future__ import annotations

from dataclasses import replace

import pytest

from harness.cases.between import Changed, Comparison
from harness.cases.case import Doubt, Row, Series
from harness.cases.gate import Judged, Judgement
from harness.cases.results import Results
from harness.report.comparison import comparison_html
from harness.report.html import html

# Names and paths as robots have them: one word, wider than a telephone.
LONG = "left_hand_index_finger_distal_interphalangeal_joint_flexion_extension_actuator_reflected_rotor"
PATH = "/".join([LONG] * 3) + ".urdf"
FAILED = Row(
    LONG, f"mass@{LONG}", ("denoc", "mujoco"), 2.1e-3, 1e-12, "1", LONG, "fail", f"{LONG}: {PATH}", {"time": 3.25}
)
PASSED = Row("arm", "energy", ("denoc", "exudyn"), 1e-13, 1e-12, "1", "book", "pass", PATH)
SERIES = Series(LONG, "trajectory", LONG, (0.0, 1.0, 2.0), (0.0, 1.0, 0.5), "time [s]", "angle [rad]")
RESULTS = Results(
    (FAILED, PASSED), (SERIES,), {LONG: PATH}, {LONG: PATH}, "2026-01-01T00:00:00Z", 3.0, {LONG: 1.0},
    (Doubt(LONG, "implausible", LONG, PATH),), {LONG: (PATH,), "arm": (f"read {PATH} as it stands",)},
)  # fmt: skip


def pages() -> dict[str, str]:
    judged = tuple(Judged(row.key, row, 1.2e-11, 3.4, PATH) for row in (FAILED, PASSED))
    changed = Changed(FAILED.key, "failed", replace(FAILED, verdict="pass"), FAILED)
    return {
        "suite": html(RESULTS),
        "gate": html(RESULTS, judgement=Judgement(judged, {})),
        "two runs": comparison_html(Comparison((changed,), 1, {LONG: ("1.0", PATH)})),
    }


@pytest.mark.parametrize("name", ["suite", "gate", "two runs"])
def test_no_page_is_wider_than_its_screen(open_page, name, tmp_path):
    file = tmp_path / "report.html"
    file.write_text(pages()[name], encoding="utf-8")
    for width, scheme in ((390, "dark"), (1280, "light")):
        page, said, asked = open_page(file.as_uri(), width, scheme)
        assert page.evaluate("document.documentElement.scrollWidth") == width
        assert said == [] and asked == [file.as_uri()]
