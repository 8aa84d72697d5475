"""The benchmark of known interventions, on a rig of two states that SciPy integrates: a pendulum whose weight is added to."""

from __future__ import annotations

import json
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import harness
from harness.errors import InputError

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
ROTOR, DAMPING, GRAVITY = 0.004, 0.006, 9.81  # kg·m², N·m·s/rad, m/s²: in no drawing
LENGTH, MASS, ADDED = 0.2, 0.4, 0.15  # m, kg, kg

MODEL = f"""
name = "rig"
gravity = [0.0, 0.0, -{GRAVITY}]
[[joint]]
name = "pivot"
type = "revolute"
parent = "base"
child = "arm"
axis = [0, 1, 0]
[[link]]
name = "arm"
mass = {MASS}
com = [0, 0, -{LENGTH}]
inertia = [1e-6, 1e-6, 1e-9]
end = [0, 0, -{LENGTH}]
"""

KNOWN = """
source = "SciPy"
[state.light]
model = "light/model.toml"
calibrate = ["light/run1.csv", "light/run2.csv"]
[[case]]
given = "light"
recordings = ["heavy/run1.csv", "heavy/run2.csv"]
kind = "free"
what = "0.15 kg added"
effect = "payload_mass"
site = "arm"
parameters = { mass = 0.15 }
like = { mass = 0.5 }
"""


def swing(mass: float, start: float, seed: int) -> str:
    """What is recorded of a textbook pendulum with a rotor at its pivot, 4 s at 50 Hz, noise of 1 mrad."""
    inertia = mass * LENGTH**2 + ROTOR

    def rate(_: float, y: np.ndarray) -> list[float]:
        return [y[1], -(mass * GRAVITY * LENGTH * np.sin(y[0]) + DAMPING * y[1]) / inertia]

    time = np.arange(0.0, 4.0, 0.02)
    angle = solve_ivp(rate, (0.0, 4.0), [start, 0.0], t_eval=time, rtol=1e-10, atol=1e-12).y[0]
    angle = angle + 1e-3 * np.random.default_rng(seed).standard_normal(len(time))
    return "time,pivot.position\n" + "\n".join(f"{t:.2f},{q:.6f}" for t, q in zip(time, angle, strict=True))


@pytest.fixture
def scripts(monkeypatch: pytest.MonkeyPatch):
    """The benchmark's scripts, which find their neighbours where they lie."""
    monkeypatch.setattr(sys, "path", [str(BENCHMARKS), *sys.path])
    import known_interventions
    import known_interventions_score
    import known_interventions_table

    return known_interventions, known_interventions_score, known_interventions_table


@pytest.fixture
def rigs(tmp_path: Path) -> Path:
    """A folder of recordings with one rig in two states."""
    root = tmp_path / "recordings" / "rig"
    for state, mass in (("light", MASS), ("heavy", MASS + ADDED)):
        (root / state).mkdir(parents=True)
        for number, start in enumerate((1.3, 0.7), 1):
            (root / state / f"run{number}.csv").write_text(swing(mass, start, number))
    (root / "light" / "model.toml").write_text(MODEL)
    (root / "known.toml").write_text(KNOWN)
    return tmp_path / "recordings"


def test_a_state_is_known_by_its_own_recordings(scripts, rigs: Path) -> None:
    # Rotor and damping as they were integrated; 1 mrad over 400 samples shows both to well below a per cent.
    command, *_ = scripts
    (case,) = command.cases_of(rigs)
    model, recordings = case.given
    joint = command.calibrated(harness.load(model), recordings).joint("pivot")
    assert joint.armature == pytest.approx(ROTOR, rel=0.01)
    assert joint.damping == pytest.approx(DAMPING, rel=0.02)
    assert joint.friction == pytest.approx(0.0, abs=1e-4)


def test_a_weight_that_was_added_is_named_with_its_size(
    scripts, rigs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    command, *_ = scripts
    work, plan, table = tmp_path / "work", tmp_path / "plan.json", tmp_path / "table.json"
    command.prepare(list(command.cases_of(rigs)), work, plan)
    (line,) = command.planned(plan)
    # What the diagnosing process is given says nothing of the change.
    given = work / "cases" / line["case"]
    assert {f.name for f in given.iterdir()} == {"model.toml", "run1.csv", "run2.csv"}
    assert f"{MASS + ADDED}" not in (given / "model.toml").read_text()
    # The whole catalogue takes minutes; what is tested here is how the benchmark asks and counts.
    few = partial(harness.diagnose, only=["payload_mass", "viscous_damping"])
    monkeypatch.setattr(harness, "diagnose", few)
    command.run([line["case"]], work, 600.0)
    command.score(plan, work, table)
    document = json.loads(table.read_text(encoding="utf-8"))
    (row,) = document["rows"]
    # In a free swing a payload shows by its ratio to the rotor, as does a centre of mass that moved: one class.
    assert row["named"] in ("exactly", "in class")
    assert document["shares"]["named"]["hits"] == 1
    for size in row["sizes"]:
        assert size["holds"] == (size["ci95"][0] <= ADDED <= size["ci95"][1])
        assert size["value"] == pytest.approx(ADDED, abs=0.02)
        assert size["holds_like"] is False  # 0.5 kg is no size of it
    assert row["plain_fit"] == [pytest.approx(ADDED, rel=0.05)]

    sealed = work / "sealed" / f"{line['case']}.json"
    sealed.write_text(sealed.read_text(encoding="utf-8").replace("0.15", "0.16"), encoding="utf-8")
    with pytest.raises(InputError, match="changed after"):
        command.score(plan, work, table)
    with pytest.raises(InputError, match="sealed"):
        command.prepare(list(command.cases_of(rigs)), work, plan)


ANSWER = {
    "rig": "rig", "kind": "free", "what": "0.15 kg added", "effect": "payload_mass", "site": "arm", "parameters": {"mass": 0.15},
    "like": {},
}  # fmt: skip


def finding(effect: str, site: str = "arm", grade: str = "likely", alike: tuple[str, ...] = (), **values) -> dict:
    parameters = {
        name: {"value": low / 2 + high / 2, "ci95": [low, high], "unit": "kg"} for name, (low, high) in values.items()
    }
    return {
        "effect": effect, "site": site, "grade": grade, "indistinguishable_from": list(alike), "parameters": parameters,
    }  # fmt: skip


@pytest.mark.parametrize(
    "findings, named, holds",
    [
        ([finding("payload_mass", mass=(0.1, 0.2))], "exactly", [True]),
        ([finding("payload_mass", mass=(0.2, 0.3))], "exactly", [False]),
        ([finding("payload_mass", site="other", mass=(0.1, 0.2))], "false", []),
        ([finding("viscous_damping", "pivot"), finding("com_offset", alike=("payload_mass@arm",))], "in class", []),
        ([finding("viscous_damping", "pivot")], "false", []),
        ([finding("payload_mass", grade="possible", mass=(0.1, 0.2))], "silent", []),
        ([], "silent", []),
    ],
)
def test_what_counts_as_named(scripts, findings: list, named: str, holds: list[bool]) -> None:
    _, judge, _ = scripts
    row = judge.scored("rig-1", ANSWER, {"findings": findings, "verdict": "explained", "summary": "", "seconds": 1.0})
    assert row["named"] == named
    assert [size["holds"] for size in row["sizes"]] == holds
    told = judge.shares([row])
    assert sum(told[key]["hits"] for key in ("named", "false_headline", "cannot_tell", "failed")) == 1


@pytest.mark.parametrize(
    "findings, told",
    [
        ([finding("payload_mass", grade="possible")], "payload_mass@arm"),
        ([finding("com_offset", grade="possible", alike=("payload_mass",))], "com_offset@arm"),
        ([finding("viscous_damping", "pivot"), finding("payload_mass", grade="possible")], "payload_mass@arm"),
        (
            [
                finding("payload_mass", mass=(0.1, 0.2)),
                finding("com_offset", grade="possible", alike=("payload_mass",)),
            ],
            None,
        ),
        ([finding("viscous_damping", "pivot", grade="possible")], None),
    ],
)
def test_what_is_no_more_than_possible_is_counted_apart(scripts, findings: list, told: str | None) -> None:
    _, judge, _ = scripts
    row = judge.scored("rig-1", ANSWER, {"findings": findings, "verdict": "explained", "summary": "", "seconds": 1.0})
    assert row["possible"] == told
    assert judge.shares([row])["told_as_possible"]["hits"] == (told is not None)


def test_a_diagnosis_that_fails_is_counted(scripts) -> None:
    _, judge, _ = scripts
    row = judge.scored("rig-1", ANSWER, {"error": "ValueError: of any kind"})
    assert (row["named"], row["summary"]) == ("failed", "ValueError: of any kind")
    told = judge.shares([row])
    assert (told["failed"]["hits"], told["named"]["hits"], told["named"]["of"]) == (1, 0, 1)


def test_page_and_readme_say_what_was_counted(scripts, tmp_path: Path) -> None:
    # As it stands in the repository: a figure that is told is one that was scored.
    *_, pages = scripts
    root = BENCHMARKS.parent
    document = json.loads((root / "reference" / "known_interventions.json").read_text(encoding="utf-8"))
    page = (root / "docs" / "known_interventions.md").read_text(encoding="utf-8")
    assert f"{pages.summary(document)}\n\n{pages.table(document['rows'])}" in page
    assert pages.sentence(document) in (root / "README.md").read_text(encoding="utf-8")
