"""Long runs that go on where they were interrupted: what a folder keeps of them until they are written there whole."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.cli.interrupt import Interrupted

if TYPE_CHECKING:
    from harness.journal import Journal

UNFINISHED = "unfinished.jsonl"


def folder_of(out: Path | None, resume: Path | None) -> Path | None:
    """The folder of a run. Raises InputError where ``--resume`` names another one than ``--out``, or one without such a run."""
    from harness.errors import InputError

    if resume is None:
        return out
    if out is not None and out != resume:
        raise InputError("--resume and --out name different folders", mend="give the one or the other")
    if not (resume / UNFINISHED).exists():
        raise InputError("holds no interrupted run", source=resume, mend="give the --out of one")
    return resume


def journal_in(folder: Path | None, of: Mapping[str, Any], *, anew: bool) -> Journal | None:
    """What keeps the results of a run in its folder; None without one.

    of: what must be the same to go on. anew: begin at the start.

    Raises InputError where that would throw away results that this version of the code can go on with.
    """
    from harness.errors import InputError
    from harness.journal import Journal, results_kept

    if folder is None:
        return None
    path = folder / UNFINISHED
    if anew:
        if count := results_kept(path):
            raise InputError(
                f"keeps {count} result{'s' * (count > 1)} of an interrupted run",
                source=path,
                mend=f"go on with --resume {folder} and the same options, or remove the file to start over",
            )
        path.unlink(missing_ok=True)
    return Journal(path, dict(of))


@contextmanager
def resumable(verb: str, folder: Path | None) -> Iterator[None]:
    """Ctrl-C says how to go on, where there is something to go on with."""
    try:
        yield
    except KeyboardInterrupt:
        if folder is None:
            raise
        raise Interrupted(
            f"stopped; `denoc {verb} --resume {folder}` with the same options goes on from here"
        ) from None
