"""Names that can be printed: they stand in tables, headers of recordings and lines that servers read for commands."""

from __future__ import annotations

from collections.abc import Mapping
from unicodedata import category

from harness.errors import InputError
from harness.system.description import System


def check_names(system: System, lines: Mapping[tuple[str, str], int] | None = None) -> None:
    """Refuse names with control characters (a line break, the beginning of a terminal's command) or half a letter.

    lines: line of ("joint" | "link", name) in the source, where known. Raises InputError naming what is named so.
    """
    named = [("model", system.name), ("link", system.base)]
    named += [("link", link.name) for link in system.links] + [("joint", joint.name) for joint in system.joints]
    for kind, name in named:
        strange = next((letter for letter in name if category(letter) in ("Cc", "Cs")), None)
        if strange is not None:
            raise InputError(
                f"{kind} {name[:80]!r} has the control character U+{ord(strange):04X} in its name",
                mend="name it with letters, digits and signs",
                source=system.source,
                line=(lines or {}).get((kind, name)),
            )
