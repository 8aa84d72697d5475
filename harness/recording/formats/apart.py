"""Foreign binary formats read in a process of their own, with limits on time and memory.

Their libraries are compiled, and a damaged file can crash one: then that process ends, and this one says so in a line. It is
started for the first such file, kept for the next ones, and ends when none has come for a while.
"""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import signal
import subprocess
import threading
from functools import lru_cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from harness.errors import InputError, MissingPackageError, UnsupportedError
from harness.limited_process import command, environment, within_installed
from harness.recording.formats.table import Table
from harness.recording.recording import QualityNote

START = "from harness.recording.formats.reader_process import work; work()"
KINDS = {
    "parquet": "Parquet file",
    "hdf5": "HDF5 file",
    "matlab": "MATLAB file",
    "netcdf": "netCDF file",
    "numpy_arrays": "NumPy file",
    "mcap": "MCAP file",
    "rosbag": "ROS bag",
}
OPTIONAL = {"parquet": (("pyarrow", "parquet", "a Parquet file"),)}  # what a plain installation does not bring
AGAIN = {"mcap": "record or convert it again", "rosbag": "record or convert it again", "matlab": "save it again"}
LEAST_TIME, SLOWEST = 60.0, 1e6  # [s], [bytes/s]: messages of a log are unpacked one by one in Python
LEAST_MEMORY, SWOLLEN = 4 * 2**30, 32  # [bytes], and what a packed byte may become
KEPT = 20.0  # [s] for which a process without work is kept


def most_memory(size: int) -> int:
    """Bytes that reading a file of a size [bytes] may take: plenty, but not more than three quarters of what there is."""
    return within_installed(max(LEAST_MEMORY, SWOLLEN * size))


def longest_time(size: int) -> float:
    """Seconds that reading a file of a size [bytes] may take."""
    return LEAST_TIME + size / SLOWEST


def read_apart(module: str, reader: str, path: Path, file: Path) -> Table:
    """The table that ``harness.recording.formats.<module>.<reader>(path, file)`` gives, read in another process.

    path: as the user knows it. file: where its bytes are. Raises what the reader raises, and InputError where the library
    crashes, takes too long or too much memory.
    """
    _ask_for_package(module)
    size = file.stat().st_size if file.is_file() else sum(f.stat().st_size for f in file.rglob("*") if f.is_file())
    process = _process(os.getpid())
    with process.lock:
        try:
            process.start()
        except OSError:  # no process may be started here
            table: Table = getattr(import_module(f"harness.recording.formats.{module}"), reader)(path, file)
            return table
        request = {
            "module": module,
            "reader": reader,
            "path": str(path),
            "file": str(file.absolute()),
            "memory": most_memory(size),
            "seconds": longest_time(size),
        }
        answer = process.ask(request)
    if answer is None:
        _tell_end(process, module, path, request)
    head, numbers = answer
    if "error" in head:
        _raise(head["error"], path)
    return _table(head, numbers, path)


def _ask_for_package(module: str) -> None:
    """Raises MissingPackageError where the library that reads such a file is not installed, before a process is begun for it."""
    for package, extra, what in OPTIONAL.get(module, ()):
        try:
            found = find_spec(package) is not None
        except (ImportError, ValueError):
            found = False
        if not found:
            raise MissingPackageError(package, extra, what=what)


def _tell_end(process: ReaderProcess, module: str, path: Path, request: dict[str, Any]) -> NoReturn:
    kind = KINDS[module]
    if process.late:
        what = f"this {kind} was not read within {request['seconds']:.0f} s"
    else:
        status = process.status
        how = signal.Signals(-status).name if status < 0 else f"exit status {status}"
        what = f"damaged {kind}: the library that reads it crashed ({how})"
    raise InputError(what, mend=AGAIN.get(module, "write it again"), source=path)


class ReaderProcess:
    """The other process, and what it is asked.

    late: whether it was ended because it took too long. status: what it ended with.
    """

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.late = False
        self.status = 0
        self._process: subprocess.Popen[bytes] | None = None
        self._idle: threading.Timer | None = None

    def start(self) -> None:
        """Start it unless it runs; raises OSError if that cannot be done."""
        if self._idle is not None:
            self._idle.cancel()
        if self._process is not None and self._process.poll() is None:
            return
        self._process = subprocess.Popen(
            command(START),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment(),
        )

    def ask(self, request: dict[str, Any]) -> tuple[dict[str, Any], bytes] | None:
        """Its answer; None if it ended without one."""
        process = self._process
        assert process is not None and process.stdin is not None and process.stdout is not None
        self.late = False

        def end() -> None:
            self.late = True
            process.kill()

        # Starting and importing count as well, on a machine that may be busy.
        watch = threading.Timer(request["seconds"], end)
        watch.daemon = True
        watch.start()
        answer = None
        try:
            process.stdin.write(json.dumps(request).encode() + b"\n")
            process.stdin.flush()
            sizes = process.stdout.readline().split()
            head, numbers = (process.stdout.read(int(size)) for size in sizes)
            if len(head) == int(sizes[0]) and len(numbers) == int(sizes[1]):
                answer = json.loads(head), numbers
        except (OSError, ValueError):
            pass
        finally:
            watch.cancel()
            if answer is None:
                self._end()
            else:
                self._idle = threading.Timer(KEPT, self._let_go)
                self._idle.daemon = True
                self._idle.start()
        return answer

    def _let_go(self) -> None:
        if self.lock.acquire(blocking=False):
            try:
                self._end()
            finally:
                self.lock.release()

    def _end(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        with contextlib.suppress(OSError):
            if process.stdin is not None:
                process.stdin.close()
        try:
            # It ends by itself once nothing more can be asked; where it crashed, this tells how.
            self.status = process.wait(2.0)
        except subprocess.TimeoutExpired:
            process.kill()
            self.status = process.wait()
        finally:
            if process.stdout is not None:
                process.stdout.close()

    def close(self) -> None:
        """End it."""
        with self.lock:
            if self._idle is not None:
                self._idle.cancel()
            self._end()


@lru_cache(maxsize=8)
def _process(own: int) -> ReaderProcess:
    """That of this process; a forked one has none of its parent's."""
    process = ReaderProcess()
    atexit.register(process.close)
    return process


def _raise(told: dict[str, Any], path: Path) -> NoReturn:
    if "extra" in told:
        raise MissingPackageError(told["package"], told["extra"], what=told["what"], source=told["source"])
    kind = UnsupportedError if told["unsupported"] else InputError
    raise kind(told["what"], mend=told["mend"], source=path, line=told["line"], column=told["column"])


def _table(head: dict[str, Any], numbers: bytes, path: Path) -> Table:
    columns, place = {}, 0
    for name, rows in head["columns"]:
        columns[name] = np.frombuffer(numbers, dtype=np.float64, count=rows, offset=place).copy()
        place += 8 * rows
    notes = [QualityNote(**{**note, "where": tuple(map(tuple, note["where"]))}) for note in head["notes"]]
    return Table(
        columns,
        head["units"],
        faults={
            name: InputError(what, mend=mend, source=path, column=name) for name, (what, mend) in head["faults"].items()
        },
        origins=head["origins"],
        aliases=head["aliases"],
        interleaved=head["interleaved"],
        notes=tuple(notes),
    )
