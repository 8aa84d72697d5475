"""Where there is no room, a case of a proof is not written at all, and one line says where; with room it is the same as ever."""

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path

CONCEAL = """
import sys
from pathlib import Path
from harness.errors import InputError
from harness.proof.run import conceal, tasks
try:
    conceal(tasks({"single": 1})[0], 23, Path(sys.argv[1]))
except InputError as error:
    print(error)
"""


def _conceal(folder: Path, most: int | None) -> str:
    """What is said where no file can have more bytes than this."""

    def small() -> None:
        if most is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))

    command = [sys.executable, "-B", "-c", CONCEAL, str(folder)]
    return subprocess.run(command, preexec_fn=small, capture_output=True, text=True, check=True).stdout


def test_a_case_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    said = _conceal(tmp_path, 4096)
    (case,) = (tmp_path / "cases").iterdir()
    assert f"{case}: cannot be written" in said
    assert list(case.iterdir()) == []
    assert not (tmp_path / "sealed").exists()
    assert _conceal(tmp_path, None) == ""
    assert {path.name for path in case.iterdir()} >= {"model.toml", "run1.csv"}
    assert [path.stem for path in (tmp_path / "sealed").iterdir()] == [case.name]
