"""Headers: ``pivot.position [deg]``, what foreign ones are mapped to, and whether the system has such a joint or link."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from harness.errors import InputError
from harness.recording.recording import JOINT_QUANTITIES, LINK_QUANTITIES, QUANTITIES
from harness.system import System
from harness.system.suggest import did_you_mean

BRACKETS = re.compile(r"^(?P<name>.*?)\s*[\[(](?P<unit>[^\[\]]*?)[\])]\s*$")
LIKELY_TIME = ("t", "time_s", "timestamp", "stamp", "seconds", "zeit", "times", "sec", "time_ms", "timestamps")


@dataclass(frozen=True)
class Rule:
    """``foreign = ours [unit]``: which column of the file is which of ours.

    sign: −1 where the mapping says ``foreign=-ours``. optional: a rule for several files, that one may lack.
    """

    foreign: str
    ours: str
    unit: str = ""
    sign: float = 1.0
    optional: bool = False
    source: str = ""


@dataclass(frozen=True)
class Column:
    """One column of the file as ours: site and quantity, or time (quantity ``time``, no site)."""

    header: str
    site: str
    quantity: str
    unit: str
    sign: float = 1.0

    @property
    def name(self) -> str:
        return f"{self.site}.{self.quantity}" if self.site else self.quantity


def split_unit(header: str) -> tuple[str, str]:
    """Name and unit of a header, the unit "" if it has none."""
    match = BRACKETS.match(header.strip())
    return (match["name"].strip(), match["unit"].strip()) if match else (header.strip(), "")


def parse_rule(text: str, *, optional: bool = False, source: str = "--map") -> Rule:
    """A rule as written on the command line, ``theta_meas=pivot.position[deg]``; raises InputError if it is none."""
    # The foreign name may hold "=" or blanks; ours cannot, so the last "=" parts them.
    foreign, mark, ours = text.rpartition("=")
    if not mark or not foreign.strip() or not ours.strip():
        raise InputError(
            f"mapping {text!r} is not of the form column=joint.quantity[unit]",
            mend="for example 'theta_meas=pivot.position[deg]'",
            source=source,
        )
    return make_rule(foreign.strip(), ours.strip(), optional=optional, source=source)


def make_rule(foreign: str, ours: str, *, optional: bool, source: str) -> Rule:
    """A rule from the foreign header and what it stands for."""
    sign = 1.0
    if ours[:1] in "+-":
        sign, ours = (-1.0 if ours[0] == "-" else 1.0), ours[1:]
    name, unit = split_unit(ours)
    if name != "time":
        _, dot, quantity = name.rpartition(".")
        if not dot or quantity not in QUANTITIES:
            raise InputError(
                f"mapping of {foreign!r}: {name!r} is no column of a recording",
                mend=did_you_mean(quantity, QUANTITIES) if dot else "time, <joint>.position, <link>.tip_deflection, …",
                source=source,
            )
    return Rule(foreign, name, unit, sign, optional, source)


def rules_beside(path: Path) -> tuple[Rule, ...]:
    """Rules of the TOML file beside a recording: ``run1.csv.toml``, ``run1.toml`` or ``columns.toml``, table ``columns``.

    A ``run1.toml`` without that table is taken for something else. Raises InputError for a file that is not valid.
    """
    stem = path.name.removesuffix(".gz").rsplit(".", 1)[0]
    places = ((path.name + ".toml", True), (stem + ".toml", False), ("columns.toml", True))
    for name, must in places:
        file = path.with_name(name)
        if file == path or not file.is_file():
            continue
        try:
            content = tomllib.loads(file.read_text(encoding="utf-8"))
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as failure:
            raise InputError(f"not valid TOML: {failure}", mend="mend the file", source=file) from None
        table = content.get("columns")
        if table is None:
            if must:
                raise InputError(
                    "has no table [columns]",
                    mend='write [columns] and lines as "theta" = "pivot.position [deg]"',
                    source=file,
                )
            continue
        if not isinstance(table, dict) or not all(isinstance(value, str) for value in table.values()):
            raise InputError('[columns] must hold lines as "theta" = "pivot.position [deg]"', source=file)
        return tuple(
            make_rule(foreign, ours.strip(), optional=True, source=str(file)) for foreign, ours in table.items()
        )
    return ()


def resolve(
    headers: Sequence[str], rules: Iterable[Rule], system: System | None, *, source: Path
) -> tuple[tuple[Column, ...], tuple[str, ...]]:
    """What each header is, time first; and the headers that are nothing of ours.

    Raises InputError for a missing time, a rule for a column that is not there, a joint or link that the system has not,
    a quantity that looks misspelt, and two columns for one quantity.
    """
    rules = tuple(rules)
    found: list[Column] = []
    ignored: list[str] = []
    taken: dict[str, str] = {}
    used: set[Rule] = set()
    for header in headers:
        name, unit = split_unit(header)
        rule = next((r for r in rules if r.foreign in (header, name)), None)
        if rule is not None:
            used.add(rule)
            ours, unit, sign = rule.ours, rule.unit or unit, rule.sign
        else:
            ours, sign = name, 1.0
        if ours == "time":
            column = Column(header, "", "time", unit, sign)
        else:
            site, _, quantity = ours.rpartition(".")
            if not site or quantity not in QUANTITIES:
                _refuse_misspelt(ours, site, quantity, system, source)
                ignored.append(header)
                continue
            if system is not None:
                _check_site(site, quantity, system, source, header)
            column = Column(header, site, quantity, unit, sign)
        if column.name in taken:
            raise InputError(
                f"columns {taken[column.name]!r} and {header!r} are both {column.name}",
                mend="map one of them to something else or remove it",
                source=source,
            )
        taken[column.name] = header
        found.append(column)
    for rule in rules:
        if rule not in used and not rule.optional:
            raise InputError(
                f"there is no column {rule.foreign!r} to map to {rule.ours}",
                mend=did_you_mean(rule.foreign, [split_unit(h)[0] for h in headers]),
                source=source,
            )
    if "time" not in taken:
        raise InputError("there is no column 'time'", mend=_time_mend(headers), source=source)
    if len(found) < 2:
        names = ", ".join(repr(h) for h in ignored[:6]) or "none"
        raise InputError(
            f"no column besides time is known; found {names}",
            mend="name it <joint>.position, … or map it: --map 'theta=<joint>.position[deg]'",
            source=source,
        )
    found.sort(key=lambda column: column.quantity != "time")
    return tuple(found), tuple(ignored)


def _time_mend(headers: Sequence[str]) -> str:
    for header in headers:
        name = split_unit(header)[0]
        if name.lower() == "time" or name.lower() in LIKELY_TIME:
            return f"map it: --map '{name}=time[s]'"
    return "name it 'time' or map it: --map 't=time[s]'"


def _refuse_misspelt(ours: str, site: str, quantity: str, system: System | None, source: Path) -> None:
    if not site:
        return
    if get_close_matches(quantity, QUANTITIES, n=1, cutoff=0.75):
        raise InputError(
            f"{quantity!r} is no quantity of a recording",
            mend=did_you_mean(quantity, QUANTITIES),
            source=source,
            column=ours,
        )
    if system is not None and site in (*system.joint_names, *(link.name for link in system.links)):
        known = JOINT_QUANTITIES if site in system.joint_names else LINK_QUANTITIES
        raise InputError(
            f"{quantity!r} of {site!r} is no quantity of a recording",
            mend=f"known: {', '.join(known)}; map the column or remove it",
            source=source,
            column=ours,
        )


def _check_site(site: str, quantity: str, system: System, source: Path, header: str) -> None:
    joints = system.joint_names
    links = tuple(link.name for link in system.links)
    wants_joint = quantity in JOINT_QUANTITIES
    if site in (joints if wants_joint else links):
        return
    kind = "joint" if wants_joint else "link"
    if wants_joint and site in links:
        carrier = system.carrier(site)
        mend = f"{site!r} is a link; its joint is {carrier.name!r}"
    elif not wants_joint and site in joints:
        mend = f"{site!r} is a joint; its link is {system.joint(site).child!r}"
    elif wants_joint and any(joint.name == site for joint in system.joints):
        mend = "that joint is fixed"
    else:
        mend = did_you_mean(site, joints if wants_joint else links)
    raise InputError(
        f"the model has no movable joint {site!r}" if kind == "joint" else f"the model has no link {site!r}",
        mend=mend,
        source=source,
        column=header,
    )
