"""What a long run has found so far, a line for each result, so that a run killed at any moment goes on behind the last of them."""

from __future__ import annotations

import hashlib
import json
import os
import zlib
from functools import cache
from pathlib import Path
from typing import Any

from harness.errors import InputError, unwritable
from harness.whole_files import write_whole

SCHEMA = "denoc.journal/1"


class Journal:
    """Results by key in a file of JSON lines; the first line says of what run they are.

    A line that was cut off, as by a kill or a full disk, or whose check sum is not what it was written with, counts for
    nothing, and neither does what stands behind it. Raises InputError where the file is of another run,
    or of another version of the code, or cannot be written.
    """

    def __init__(self, path: str | Path, of: dict[str, Any]) -> None:
        self.path = Path(path)
        self.found: dict[str, Any] = {}
        head = {"schema": SCHEMA, "of": json.loads(json.dumps(of)), "code": code_digest()}
        lines = _whole_lines(self.path)
        if lines:
            was = lines[0]
            if not isinstance(was, dict) or was.get("schema") != SCHEMA:
                raise InputError("is no record of an interrupted run", source=self.path, mend="name another folder")
            if was.get("code") != head["code"]:
                raise InputError(
                    "is of another version of the code", source=self.path, mend="remove it, and run from the start"
                )
            if was != head:
                raise InputError(
                    "is of a run with other options", source=self.path, mend="give the same ones, or another folder"
                )
            self.found = {line["key"]: line["value"] for line in lines[1:]}
            # What stands behind the last whole line would spoil the next one.
            self._write(lines)
        else:
            self._write([head])

    def add(self, key: str, value: Any) -> None:
        """Keep a result; it is on the disk when this returns."""
        self.found[key] = value
        try:
            with self.path.open("a", encoding="utf-8") as file:
                file.write(json.dumps({"key": key, "value": value, "sum": _sum(key, value)}) + "\n")
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise unwritable(self.path, error) from error

    def remove(self) -> None:
        """Once the run has ended, and written what it found elsewhere."""
        self.path.unlink(missing_ok=True)

    def _write(self, lines: list[Any]) -> None:
        write_whole(self.path, "".join(json.dumps(line) + "\n" for line in lines))


def _sum(key: str, value: Any) -> int:
    as_read = json.loads(json.dumps([key, value]))  # keys that are numbers become text, which is sorted otherwise
    return zlib.crc32(json.dumps(as_read, sort_keys=True).encode())


def _is_result(line: Any) -> bool:
    """Whether a line is as it was written."""
    if not isinstance(line, dict) or not isinstance(line.get("key"), str):
        return False
    return "value" in line and bool(line.get("sum") == _sum(line["key"], line["value"]))


def results_kept(path: Path) -> int:
    """How many results of an interrupted run of this version of the code a file holds; none where it is no such file."""
    lines = _whole_lines(path)
    if not lines or not isinstance(lines[0], dict) or lines[0].get("schema") != SCHEMA:
        return 0
    return len(lines) - 1 if lines[0].get("code") == code_digest() else 0


def _whole_lines(path: Path) -> list[Any]:
    """The lines that can be read, up to the first that cannot."""
    try:
        text = path.read_bytes().decode("utf-8", "replace")
    except FileNotFoundError:
        return []
    lines: list[Any] = []
    for line in text.split("\n")[:-1]:
        try:
            read = json.loads(line)
        except (ValueError, RecursionError):
            break
        if lines and not _is_result(read):
            break
        lines.append(read)
    return lines


@cache
def code_digest() -> str:
    """SHA-256 over the sources of this package."""
    home = Path(__file__).parent
    total = hashlib.sha256()
    for path in sorted(home.rglob("*.py")):
        total.update(path.relative_to(home).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return total.hexdigest()
