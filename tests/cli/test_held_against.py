"""``denoc diagnose --compare`` and ``--transfer`` as a user meets them: files, JSON, one line for bad input."""

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from harness.cli.main import status_of

SCHEMAS = Path(__file__).parents[2] / "docs" / "schemas"
URDF = """<robot name="rig"><link name="base"/><link name="rod"><inertial><origin xyz="0 0 -0.15"/><mass value="0.2"/>
<inertia ixx="1.5e-3" iyy="1.5e-3" izz="1e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="{joint}" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
<dynamics damping="{damping}"/></joint></robot>"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two short swings of a damped linear oscillator (closed form, small angles) and models of it."""
    made = tmp_path_factory.mktemp("rig")
    inertia, moment, damping = 1.5e-3 + 0.2 * 0.15**2, 0.2 * 9.81 * 0.15, 2e-3
    time = np.arange(0.0, 3.0, 0.02)
    decay = 0.5 * damping / inertia
    rate = np.sqrt(moment / inertia - decay**2)
    rng = np.random.default_rng(0)
    # Of a joint that the models have not: left out, and said to be.
    for k, angle in enumerate((0.05, 0.04, 0.03), 1):
        q = angle * np.exp(-decay * time) * (np.cos(rate * time) + decay / rate * np.sin(rate * time))
        table = np.column_stack([time, q + 1e-4 * rng.standard_normal(len(time)), 0.1 * np.sin(time)])
        np.savetxt(made / f"run{k}.csv", table, delimiter=",", header="time,pivot.position,elbow.position", comments="")
    for name, joint, own in (("good", "pivot", 2e-3), ("bad", "pivot", 8e-3), ("other", "hinge", 2e-3)):
        (made / f"{name}.urdf").write_text(URDF.format(joint=joint, damping=own))
    return made


def call(folder, *arguments):
    runs = [str(folder / f"run{k}.csv") for k in (1, 2, 3)]
    return status_of(["diagnose", *runs, *arguments])


def test_documents_and_pages_are_written(folder, tmp_path, capfd):
    models = [str(folder / "good.urdf"), str(folder / "bad.urdf")]
    assert (
        call(
            folder,
            "--compare",
            *models,
            "--transfer",
            models[1],
            "--out",
            str(tmp_path),
            "--json",
            str(tmp_path / "all.json"),
        )
        == 0
    )
    shown, noted = capfd.readouterr()
    assert "good.urdf" in shown and "viscous damping at pivot" in shown
    assert noted.count("note: run1: elbow.position: is of a joint that the model has not") == 1
    for name in ("arbitration", "transfer"):
        document = json.loads((tmp_path / f"{name}.json").read_text())
        schema = json.loads((SCHEMAS / f"denoc.{name}-1.json").read_text())
        jsonschema.validate(document, schema)
        assert sum("elbow.position" in note for note in document["notes"]) == 3
        page = (tmp_path / f"{name}.html").read_text()
        assert "viscous damping at pivot" in page and 'class="plot"' in page
    whole = json.loads((tmp_path / "all.json").read_text())
    assert whole["schema"] == "denoc.arbitration/1" and whole["transfer"]["schema"] == "denoc.transfer/1"
    (damping,) = [row for row in whole["numbers"] if row["number"] == "viscous damping at pivot"]
    assert damping["says"] == "good.urdf"
    assert abs(damping["value"] - 2e-3) < 4.0 * damping["std"] < 5e-4


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), ("--model", "--compare")),
        (("--compare", "good.urdf", "other.urdf"), ("other.urdf", "'pivot'", "hinge")),
        (("--compare", "good.urdf", "none.urdf"), ("none.urdf",)),
        (("--compare", "good.urdf", "good.urdf"), ("good.urdf", "twice")),
        (("--transfer", "good.urdf", "--tolerance", "0.1"), ("--tolerance", "--model")),
    ],
)
def test_bad_input_is_one_line(folder, capfd, arguments, words):
    named = [str(folder / a) if a.endswith(".urdf") else a for a in arguments]
    assert call(folder, *named) == 2
    told = capfd.readouterr().err.strip()
    assert len(told.splitlines()) == 1, told
    for word in words:
        assert word in told
