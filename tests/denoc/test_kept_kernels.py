"""Compiled kernels where nothing can be kept: the run goes on, and one line says so."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# Every module that lets numba keep something by itself; a small kernel, in a file of the test's own.
KEEPERS = sorted(
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for path in (ROOT / "harness").rglob("*.py")
    if "cache=True" in path.read_text("utf-8") and "peers" not in path.parts
)
KERNEL = """
import harness.kept_kernels, harness.effects.measurement
from numba import njit
@njit(cache=True)
def twice(x):
    return 2.0 * x
@njit(cache=True)
def thrice(x):
    return 3.0 * x
if __name__ == "__main__":
    print(twice(1.5), thrice(1.0), twice._cache_hits, thrice._cache_hits)
"""
NOWHERE = """
import numba.core.caching as caching
def full(*arguments):
    raise OSError(30, "Read-only file system")
caching._CacheLocator.ensure_cache_path = full
"""
FULL = """
import numba.core.caching as caching
def full(*arguments):
    raise OSError(28, "No space left on device")
caching.IndexDataCacheFile.save = full
"""


def ran(tmp_path: Path, before: str, code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    (tmp_path / "kernel.py").write_text(before + code)
    return subprocess.run(
        [sys.executable, "kernel.py"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        capture_output=True,
        text=True,
        check=False,
    )


def test_with_no_place_to_keep_kernels_they_are_compiled_anew(tmp_path: Path) -> None:
    run = ran(tmp_path, NOWHERE, KERNEL)
    assert run.stdout.startswith("3.0 3.0"), run.stderr
    assert run.stderr.count("\n") == 1
    assert "there is no place to keep compiled kernels in" in run.stderr


def test_every_module_that_keeps_something_can_be_imported_without_a_place(tmp_path: Path) -> None:
    assert len(KEEPERS) > 5
    run = ran(
        tmp_path, NOWHERE, "from importlib import import_module\n" + "\n".join(f"import_module({m!r})" for m in KEEPERS)
    )
    assert run.returncode == 0, run.stderr
    assert run.stderr.count("\n") == 1


def test_a_full_disk_is_told_once(tmp_path: Path) -> None:
    run = ran(tmp_path, FULL, KERNEL)
    assert run.stdout.startswith("3.0 3.0"), run.stderr
    assert run.stderr.count("\n") == 1
    assert "could not be kept" in run.stderr and "No space left on device" in run.stderr


def test_a_folder_that_is_none_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    run = ran(tmp_path, "", KERNEL, NUMBA_CACHE_DIR=str(tmp_path / "file"))
    assert run.stdout.startswith("3.0 3.0"), run.stderr
    assert "cannot be written to, so compiled kernels are kept elsewhere" in run.stderr


PLACE = "from harness.kept_kernels import place; print(place())"


def test_doctor_tells_where_they_are_and_not_where_they_should_be(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    file, folder = str(tmp_path / "file"), str(tmp_path / "folder")
    assert ran(tmp_path, "", PLACE, NUMBA_CACHE_DIR=folder).stdout == f"{folder}\n"
    assert ran(tmp_path, "", PLACE, NUMBA_CACHE_DIR=file).stdout.endswith(f"({file} cannot be written to)\n")
    assert ran(tmp_path, NOWHERE, PLACE, NUMBA_CACHE_DIR=file).stdout.startswith("nowhere: ")


@pytest.mark.parametrize("kind", ["nbi", "nbc"])
def test_damaged_kernels_are_compiled_anew(tmp_path: Path, kind: str) -> None:
    place = tmp_path / "kept"
    first = ran(tmp_path, "", KERNEL, NUMBA_CACHE_DIR=str(place))
    assert first.stdout.startswith("3.0 3.0"), first.stderr
    files = sorted(place.rglob(f"*twice*.{kind}"))
    assert files
    for file in files:
        file.write_bytes(file.read_bytes()[:40] + b"damage")
    again = ran(tmp_path, "", KERNEL, NUMBA_CACHE_DIR=str(place))
    assert again.stdout.startswith("3.0 3.0"), again.stderr
    assert "Counter()" in again.stdout  # it was not taken from what was kept
    assert again.stderr == ""
