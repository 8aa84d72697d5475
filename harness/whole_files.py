"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from harness.errors import InputError, unwritable

STREAMS = ("/dev", "/dev/fd", "/proc/self/fd")


def write_whole(path: str | Path, content: str | bytes) -> Path:
    """Write a file so that a reader finds the old one or the new one, never a part; returns its path.

    Text is written as UTF-8 with Unix line ends. Raises InputError if the place cannot be written to.
    """
    path = Path(path)
    with staged(path) as temporary:
        if isinstance(content, str):
            temporary.write_text(content, encoding="utf-8", newline="\n")
        else:
            temporary.write_bytes(content)
    return path


@contextmanager
def staged(path: str | Path) -> Iterator[Path]:
    """A temporary name beside ``path`` that becomes ``path`` when the block ends well, and vanishes otherwise.

    It keeps the ending of ``path``, for writers that choose their format by it. Where ``path`` is a link, what it points to is
    written; a device or a pipe (``/dev/null``, ``/dev/stdout``, a shell's ``>(…)``) is written to, and stays what it is.
    """
    path = Path(path)
    if path.is_dir():
        raise InputError("is a folder", source=path, mend="name a file")
    if _is_stream(path):
        with _poured(path) as temporary:
            yield temporary
        return
    if path.is_symlink():
        path = path.resolve()
    with _beside(path) as temporary:
        yield temporary


def _is_stream(path: Path) -> bool:
    """Whether a file is no place to put another file at: a device, a pipe, or one of a process's own open files."""
    return (path.exists() and not path.is_file()) or str(path.absolute().parent) in STREAMS


@contextmanager
def _poured(path: Path) -> Iterator[Path]:
    """A temporary name elsewhere, of which the content goes into ``path`` when the block ends well."""
    try:
        with tempfile.TemporaryDirectory() as folder:
            temporary = Path(folder) / path.name
            yield temporary
            # Not truncated: a standard output that is a file may hold something before.
            with path.open("ab") as stream:
                stream.write(temporary.read_bytes())
    except OSError as error:
        raise unwritable(path, error) from error


@contextmanager
def _beside(path: Path) -> Iterator[Path]:
    temporary: Path | None = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{path.stem[:40]}-", suffix="".join(path.suffixes), dir=path.parent)
        os.close(handle)
        temporary = Path(name)
        yield temporary
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(path)
    except OSError as error:
        raise unwritable(path, error) from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def write_folder(folder: str | Path, files: Mapping[str, str | bytes]) -> list[Path]:
    """Write files into a folder, which is made if need be; every one is prepared before the first is put in place."""
    folder = Path(folder)
    if folder.exists() and not folder.is_dir():
        raise InputError("is a file, not a folder", source=folder, mend="give a folder to --out")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".writing-", dir=folder) as staging:
            for name, content in files.items():
                data = content.encode() if isinstance(content, str) else content
                (Path(staging) / name).write_bytes(data)
            return [(Path(staging) / name).replace(folder / name) for name in files]
    except OSError as error:
        raise unwritable(folder, error) from error


def nothing_in(folder: Path) -> bool:
    """Whether a folder has nothing in it but what writing that was ended in the middle has left."""
    return all(path.name.startswith(".") for path in folder.iterdir())


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
