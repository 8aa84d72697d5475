"""A proof's folder whose files are damaged is told in one line that names the file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from harness.cli.main import status_of
from harness.proof.seal import digest

ANSWER = json.dumps({"kind": "clean", "planted": [], "visibility": []})
FOUND = {"verdict": "consistent", "findings": [], "mismatch": [], "fit": [], "seconds": float("nan")}
DAMAGE = [
    "", "null", "[]", "7", '"text"', "{", "[" * 100_000, '{"a": 1' + 5000 * "0" + "}", '{"a": 1, "a": 2}', "\ud800",
]  # fmt: skip


def _proof(folder: Path) -> None:
    """A proof of one case, as `denoc prove` leaves it."""
    for name in ("sealed", "found"):
        (folder / name).mkdir()
    (folder / "sealed" / "clean-0.json").write_text(ANSWER)
    (folder / "digests.json").write_text(json.dumps({"clean-0": digest(ANSWER)}))
    (folder / "plan.json").write_text(json.dumps({"seed": 2**127 + 1, "counts": {"clean": 1}, "short": True}))
    (folder / "found" / "clean-0.json").write_text(json.dumps(FOUND))


def test_a_whole_folder_is_scored(tmp_path: Path) -> None:
    _proof(tmp_path)
    assert status_of(["prove", "--score", str(tmp_path)]) == 0


@pytest.mark.parametrize(
    ("file", "text"),
    [
        *((file, text) for file in ("plan.json", "digests.json", "found/clean-0.json") for text in DAMAGE),
        ("plan.json", "{}"),
        ("plan.json", '{"seed": -1, "counts": {"clean": 1}}'),
        ("plan.json", '{"seed": "1", "counts": {"clean": 1}}'),
        ("plan.json", '{"seed": 1, "counts": {"cleanest": 1}}'),
        ("plan.json", '{"seed": 1, "counts": {"clean": -1}}'),
        ("plan.json", '{"seed": 1, "counts": [1]}'),
        ("digests.json", '{"clean-0": 1}'),
        ("digests.json", '{"../clean-0": "sha"}'),
        ("found/clean-0.json", "{}"),
        ("found/clean-0.json", '{"verdict": "consistent", "findings": 3}'),
        ("found/clean-0.json", '{"verdict": "explained", "findings": [{"effect": "com_offset"}]}'),
        ("found/clean-0.json", '{"verdict": "consistent", "findings": [], "fit": [1]}'),
        ("found/clean-0.json", '{"verdict": "consistent", "findings": [], "seconds": "x"}'),
    ],
)
def test_a_damaged_file_is_named_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], file: str, text: str
) -> None:
    _proof(tmp_path)
    (tmp_path / file).write_bytes(text.encode("utf-8", "surrogatepass"))
    assert status_of(["prove", "--score", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert Path(file).name in said
    assert "a defect in denoc" not in said
