"""What in a folder is a unit, and what its recordings are."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.cli.main import status_of
from harness.errors import InputError
from harness.fleet.kept import begin
from harness.fleet.question import Question
from harness.fleet.units import units_in


def put(*paths: Path) -> None:
    for path in paths:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("time,pivot.position\n0,1\n", encoding="utf-8")


def test_files_and_folders_are_units(tmp_path):
    home = tmp_path / "fleet"
    put(home / "b.csv", home / "a.csv.gz", home / "arm7" / "run2.csv", home / "arm7" / "run1.csv", home / "arm7" / "model.toml",
        home / "arm7" / "README.txt", home / "README.txt", home / "photo.png", home / ".hidden.csv", home / "bag" / "metadata.yaml",
        home / "bag" / "bag_0.db3", home / "out" / "x.csv")  # fmt: skip
    (home / "empty").mkdir()
    units, others = units_in(home, but=home / "out")
    assert [u.name for u in units] == ["a.csv.gz", "arm7", "b.csv", "bag", "empty"]
    arm = units[1]
    assert [Path(r).name for r in arm.recordings] == ["run1.csv", "run2.csv"]
    assert arm.model is not None and Path(arm.model).name == "model.toml"
    assert [f[0] for f in arm.files()] == ["run1.csv", "run2.csv", "model.toml"]
    # A ROS 2 bag is one recording, made of all its files.
    assert units[3].recordings == (str((home / "bag").resolve()),)
    assert [f[0] for f in units[3].files()] == ["bag_0.db3", "metadata.yaml"]
    assert units[4].recordings == ()
    assert others == ["README.txt", "photo.png"]


@pytest.mark.parametrize(
    ("name", "what"), [("nowhere", "no such folder"), ("file.csv", "is a file"), ("bare", "no unit")]
)
def test_a_folder_without_units_is_said_in_a_line(tmp_path, name, what):
    put(tmp_path / "file.csv")
    (tmp_path / "bare").mkdir()
    with pytest.raises(InputError, match=what):
        units_in(tmp_path / name)


def test_answers_to_another_question_are_left_alone(tmp_path):
    model = tmp_path / "model.toml"
    model.write_text("one", encoding="utf-8")
    asked = Question(str(model), tolerance=0.01)
    begin(tmp_path / "out", asked)
    begin(tmp_path / "out", asked)
    with pytest.raises(InputError, match="another tolerance"):
        begin(tmp_path / "out", Question(str(model), tolerance=0.02))
    model.write_text("two", encoding="utf-8")
    with pytest.raises(InputError, match="another model"):
        begin(tmp_path / "out", asked)
    put(tmp_path / "mine" / "thesis.csv")
    with pytest.raises(InputError, match="holds no fleet's answers"):
        begin(tmp_path / "mine", asked)


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (("--fleet", "{}", "--holdout", "x.csv"), "--holdout does not go with --fleet"),
        (("--fleet", "{}", "run.csv"), "recordings are given beside --fleet"),
        (("--fleet", "{}", "--model", "a.urdf", "--model", "b.urdf"), "2 models"),
        (("--fleet", "{}", "--model", "a.urdf"), "a.urdf: cannot be read"),
        (("--fleet", "{}/nowhere", "--model", "a.urdf"), "no such folder"),
        (("--fleet", "{}", "--time-limit", "-1"), "time limit"),
        (("run.csv", "--model", "a.urdf", "--dask", "tcp://h:1"), "--dask is for --fleet"),
        (("--model", "a.urdf"), "no recording given"),
    ],
)
def test_what_does_not_go_together_is_said_in_a_line(arguments, what, tmp_path, capfd, monkeypatch):
    put(tmp_path / "fleet" / "run.csv")
    monkeypatch.chdir(tmp_path)
    given = [a.replace("{}", str(tmp_path / "fleet")) for a in arguments]
    assert status_of(["diagnose", *given, "--out", str(tmp_path / "out")]) == 2
    said = capfd.readouterr().err.strip().splitlines()
    assert what in said[-1]
    assert not (tmp_path / "out").exists()
