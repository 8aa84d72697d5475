"""``denoc diagnose --compare`` and ``--transfer``: identified models held against recordings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.cli.options import console, say_notes

if TYPE_CHECKING:
    from harness.diagnose.problem.deadline import Deadline
    from harness.system import System


def held_against(
    recordings: Sequence[str],
    compare: tuple[str, str] | None,
    published: str | None,
    load: Callable[[str], System],
    *,
    holdout: str | None,
    mapping: Sequence[str],
    step: Callable[[int, int, str], None],
    deadline: Deadline,
) -> dict[str, dict[str, Any]]:
    """Documents by their key: ``arbitration`` where two models are to be compared, ``transfer`` where one is published."""
    from harness.diagnose.arbitration.arbitrate import arbitrate
    from harness.diagnose.arbitration.transfer import transfer

    found: dict[str, dict[str, Any]] = {}
    if compare is not None:
        found["arbitration"] = arbitrate(
            recordings, [load(m) for m in compare], names=compare, holdout=holdout, mapping=mapping, progress=step,
            time_limit=deadline,
        )  # fmt: skip
    if published is not None:
        found["transfer"] = transfer(
            recordings,
            load(published),
            name=published,
            holdout=holdout,
            mapping=mapping,
            progress=step,
            time_limit=deadline,
        )
    return found


def tell(found: dict[str, dict[str, Any]], out: Path | None, json_file: str | None) -> dict[str, dict[str, Any]]:
    """Print and write documents; what is left of them for programs, without what pages draw."""
    from harness.report.arbitration import print_comparison, write_comparison

    screen = console(json_file)
    plain: dict[str, dict[str, Any]] = {}
    said: set[str] = set()
    for key, document in found.items():
        curves = document.pop("curves")
        # Both are of the same recordings, of which the same is to be noted.
        say_notes([note for note in document["notes"] if note not in said])
        said.update(document["notes"])
        print_comparison(document, screen)
        if out is not None:
            for path in write_comparison(document, curves, out):
                screen.print(f"wrote {path}", markup=False)
        plain[key] = document
    return plain
