"""Finding the cases: every module beside this one that defines ``CASE`` or ``CASES``."""

from __future__ import annotations

import pkgutil
import re
from collections.abc import Iterable, Sequence
from importlib import import_module

from harness.cases.case import GROUPS, Case
from harness.errors import InputError
from harness.system.suggest import did_you_mean


def built_in() -> dict[str, Case]:
    """Cases of the built-in suite by name, ordered by group and name.

    Raises RuntimeError if two cases have one name: the second would silently take the first one's accepted figures.
    """
    found: dict[str, Case] = {}
    package = "harness.cases"
    for module_info in pkgutil.iter_modules(import_module(package).__path__):
        if module_info.ispkg:
            continue
        module = import_module(f"{package}.{module_info.name}")
        for case in _of(module):
            if case.name in found:
                raise RuntimeError(f"two cases are named {case.name}")
            found[case.name] = case
    order = {group: index for index, group in enumerate(GROUPS)}
    return dict(sorted(found.items(), key=lambda item: (order.get(item[1].group, len(order)), natural(item[0]))))


def natural(name: str) -> list[tuple[int, str]]:
    """Sorting key by which chain_7 comes before chain_20."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", name)]


def _of(module: object) -> Iterable[Case]:
    case = getattr(module, "CASE", None)
    if isinstance(case, Case):
        return (case,)
    several = getattr(module, "CASES", ())
    return tuple(several() if callable(several) else several)


def select(names: Sequence[str] | None) -> list[Case]:
    """The named cases, or all; a name that ends in ``*`` takes every case that starts so. InputError if unknown."""
    known = built_in()
    if not names:
        return list(known.values())
    chosen: dict[str, Case] = {}
    for name in names:
        hits = [k for k in known if k.startswith(name[:-1])] if name.endswith("*") else [k for k in known if k == name]
        if not hits:
            raise InputError(f"no case is named {name!r}", mend=did_you_mean(name, list(known)))
        chosen.update({hit: known[hit] for hit in hits})
    return [case for name, case in known.items() if name in chosen]
