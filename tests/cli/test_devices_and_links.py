"""Where files are asked for at places that are no plain files: devices, pipes and links stay what they are."""

from __future__ import annotations

import json
import os
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from harness.cli.main import status_of
from harness.whole_files import staged, write_whole

pytestmark = pytest.mark.skipif(os.name == "nt", reason="devices and pipes of Unix")


@pytest.fixture
def pipe(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    return path


def test_a_pipe_is_written_to(pipe):
    got = []
    reader = threading.Thread(target=lambda: got.append(pipe.read_text()), daemon=True)
    reader.start()
    write_whole(pipe, "all of it\n")
    reader.join(timeout=10)
    assert got == ["all of it\n"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def node(path: Path, minor: int) -> Path:
    """One of Linux's memory devices; skips where only root may make nodes, or the file system opens none."""
    try:
        os.mknod(path, 0o666 | stat.S_IFCHR, os.makedev(1, minor))
        path.open("wb").close()
    except PermissionError:
        pytest.skip("no devices here")
    return path


def test_a_device_stays_a_device(tmp_path):
    """By a node of its own where the tests may make one, for what went wrong took the machine's away."""
    device = node(tmp_path / "null", 3)
    write_whole(device, "nothing")
    assert stat.S_ISCHR(device.stat().st_mode)


def test_a_link_is_written_through(tmp_path):
    (tmp_path / "real").mkdir()
    target, link = tmp_path / "real" / "run.json", tmp_path / "run.json"
    link.symlink_to(target)
    for text in ("first", "second"):
        write_whole(link, text)
        assert link.is_symlink() and target.read_text() == text
    assert list(target.parent.iterdir()) == [target]


def test_what_fails_leaves_the_target_of_a_link_alone(tmp_path):
    target, link = tmp_path / "real.csv", tmp_path / "link.csv"
    target.write_text("before")
    link.symlink_to(target)
    with pytest.raises(RuntimeError), staged(link) as temporary:
        temporary.write_text("half")
        raise RuntimeError
    assert link.is_symlink() and target.read_text() == "before"


def test_json_to_the_standard_output_by_its_name(tmp_path):
    """Behind what was written there before, whether it is a file or a pipe."""
    log = tmp_path / "log"
    command = [sys.executable, "-m", "harness", "audit", "models/urdf/rigid_pendulum.urdf", "--json", "/dev/stdout"]
    with log.open("w") as file:
        file.write("before\n")
        file.flush()
        assert subprocess.run(command, stdout=file, check=False).returncode == 0
    text = log.read_text()
    assert text.startswith("before\n") and '"denoc.audit/1"' in text
    piped = subprocess.run(command, capture_output=True, check=False, text=True).stdout
    assert json.loads(piped[piped.index("{") : piped.rindex("}") + 1])["schema"] == "denoc.audit/1"


def test_a_full_device_is_one_line(tmp_path, capsys):
    full = node(tmp_path / "full", 7)
    assert status_of(["audit", "models/urdf/rigid_pendulum.urdf", "--json", str(full)]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "cannot be written" in line and "make room" in line
