"""Failures that a user can mend: one line that names the place, what is wrong and the mend."""

from pathlib import Path


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
        return " ".join(text.split())


class UnsupportedError(InputError):
    """The input is well formed, but says something this project does not model; names what and where."""


class EngineUnavailableError(RuntimeError):
    """An engine is not installed or cannot be loaded; the message says how to get it."""
