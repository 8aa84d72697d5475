"""Failures that a user can mend: one line that names the place, what is wrong and the mend."""

import errno
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

LONGEST = 1000  # letters of a message; names out of a damaged file know no end


class InputError(ValueError):
    """Unusable input; commands print it as one line and end with exit status 2.

    what: what is wrong.
    mend: what the user can do about it.
    source: the file concerned, if any.
    line: line in that file, counted from 1.
    column: name or number of the column concerned.
    """

    def __init__(
        self,
        what: str,
        *,
        mend: str = "",
        source: str | Path | None = None,
        line: int | None = None,
        column: str | int | None = None,
    ) -> None:
        self.what = what
        self.mend = mend
        self.source = source
        self.line = line
        self.column = column
        super().__init__(str(self))

    def __str__(self) -> str:
        place = ""
        if self.source is not None:
            place = str(self.source)
            if self.line is not None:
                place += f":{self.line}"
            if self.column is not None:
                place += f", column {self.column}"
            place += ": "
        elif self.column is not None:
            place = f"column {self.column}: "
        text = f"{place}{self.what}"
        if self.mend:
            text += f" ({self.mend})"
        return one_line(text)


def one_line(text: str) -> str:
    """A text as one line of letters that a terminal shows; what is too long for anybody to read is cut in the middle."""
    text = " ".join(text.split())
    text = "".join(letter if letter.isprintable() else "�" for letter in text)
    return text if len(text) <= LONGEST else f"{text[: LONGEST // 2]} … {text[-LONGEST // 2 :]}"


class UnsupportedError(InputError):
    """The input is well formed, but says something this project does not model; names what and where."""


@contextmanager
def not_of_the_input() -> Iterator[None]:
    """Within it all input has been examined: an InputError raised there is of arrays or models of ours, and told as a defect.

    What is raised as unsupported stays what it is. Raises RuntimeError in place of the others.
    """
    try:
        yield
    except UnsupportedError:
        raise
    except InputError as error:
        raise RuntimeError(f"refused what it had made itself: {error}") from error


# Packages that the base install leaves out, by the name they are imported under, and the extra that brings them.
EXTRAS = {
    "pinocchio": "engines",
    "exudyn": "engines",
    "pyarrow": "parquet",
    "example_robot_data": "robots",
    "distributed": "cluster",
    "dask": "cluster",
    "pandas": "peers",
    "pysindy": "peers",
    "cmaes": "peers",
    "figaroh": "peers",
}


def install(extra: str) -> str:
    """The command that brings an extra."""
    return f'pip install "denoc-harness[{extra}]"'


class MissingPackageError(UnsupportedError):
    """Something needs a package that the base install leaves out; the mend is the command that brings it."""

    def __init__(self, package: str, extra: str, *, what: str = "", source: str | Path | None = None) -> None:
        need = f"{what} needs" if what else "this needs"
        self.package, self.extra, self.need = package, extra, what
        super().__init__(f"{need} the package {package}, which is not installed", mend=install(extra), source=source)


def missing_package(error: ImportError) -> MissingPackageError | None:
    """The same for a failed import, None if the module is of no extra."""
    package = (error.name or "").partition(".")[0]
    return MissingPackageError(package, EXTRAS[package]) if package in EXTRAS else None


def unwritable(place: str | Path, error: OSError) -> InputError:
    """What is said of a file or folder that cannot be written."""
    full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
    mend = "make room, or name another place" if full else "check the path and its permissions"
    return InputError(f"cannot be written: {error.strerror or error}", mend=mend, source=place)


def unforeseen(error: Exception) -> str:
    """One line of an error that is none of the input's: of a missing package, of the machine, or a defect."""
    absent = missing_package(error) if isinstance(error, ImportError) else None
    if absent is not None:
        return str(absent)
    if isinstance(error, OSError) and error.errno is not None:
        # Of the machine, not of the code: a full disk, rights, too many open files.
        where = "" if error.filename is None else f"{error.filename}: "
        gone = isinstance(error, FileNotFoundError)
        mend = "it should be there: restore it, or begin afresh" if gone else "make room, or name another place"
        return one_line(f"{where}{error.strerror} ({mend})")
    text = one_line(str(error)) or "no message"
    return f"a defect in denoc: {type(error).__name__}: {text} (DENOC_TRACEBACK=1 shows where)"


class EngineUnavailableError(RuntimeError):
    """An engine is not installed or cannot be loaded; the message says how to get it."""


# What wheels lean on and a bare Linux lacks; the package of Debian and Ubuntu that holds it.
SYSTEM_PACKAGES = {"libGL": "libgl1", "libgomp": "libgomp1"}


def cannot_be_loaded(engine: str, error: ImportError, mend: str) -> EngineUnavailableError:
    """The error of an engine whose package is not there, or is there and lacks a library of the system's.

    mend: the command that brings the package.
    """
    lacking = re.search(r"((lib\w+)\.so\S*): cannot open shared object file", str(error))
    if lacking is None:
        return EngineUnavailableError(f"{engine} cannot be loaded ({error}): {mend}")
    package = SYSTEM_PACKAGES.get(lacking[2])
    how = f"apt install {package} on Debian or Ubuntu" if package else "the system's package manager has it"
    return EngineUnavailableError(f"{engine} is installed, but this system lacks {lacking[1]}: {how}")
