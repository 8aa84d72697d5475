"""Headers: ``pivot.position [deg]``, what foreign ones are mapped to, and whether the system has such a joint or link."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from harness.errors import InputError
from harness.recording.recording import GIVEN, JOINT_QUANTITIES, LINK_QUANTITIES, QUANTITIES, SPATIAL_UNITS
from harness.system import System
from harness.system.read_toml import parse_toml
from harness.system.suggest import did_you_mean

INDEX = re.compile(r"\S\[\d+\]$")  # /strain/data[0]: of an array, no unit
IGNORE = "ignore"
BRACKETS = re.compile(r"^(?P<name>.*?)\s*[\[(](?P<unit>[^\[\]]*?)[\])]\s*$")
LIKELY_TIME = ("t", "time_s", "timestamp", "stamp", "seconds", "zeit", "times", "sec", "time_ms", "timestamps", "tout")
CLOCKS = ("time", "__time", "%time")  # whatever their capitals


@dataclass(frozen=True)
class Rule:
    """``foreign = ours [unit]``: which column of the file is which of ours; ``ignore`` for what to leave out.

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
    """One column of the file as ours: site and quantity, or time (quantity ``time``, no site).

    unit: of the rule that maps it, else of its header. stated: the header's own, where a rule has another.
    """

    header: str
    site: str
    quantity: str
    unit: str
    sign: float = 1.0
    stated: str = ""

    @property
    def name(self) -> str:
        return f"{self.site}.{self.quantity}" if self.site else self.quantity


def split_unit(header: str) -> tuple[str, str]:
    """Name and unit of a header, the unit "" if it has none."""
    if INDEX.search(header.strip()) and header.split("[")[0].rpartition(".")[2] not in QUANTITIES:
        return header.strip(), ""
    match = BRACKETS.match(header.strip())
    return (match["name"].strip(), match["unit"].strip()) if match else (header.strip(), "")


def unit_stated(header: str, ours: str, unit: str) -> str:
    """How a user says what unit a column of the file is in: in its header, or in the rule that maps it."""
    bare = split_unit(header)[0]
    return f"write {ours} [{unit}] in the header" if bare in ("", ours) else f"write --map '{bare}={ours}[{unit}]'"


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


def told_rules(mapping: str | Sequence[str] | Mapping[str, str] | None) -> tuple[Rule, ...]:
    """Rules as given: one or several as on the command line, or what each foreign header stands for by its name."""
    if isinstance(mapping, str):
        return (parse_rule(mapping),)
    if isinstance(mapping, Mapping):
        return tuple(make_rule(name, ours.strip(), optional=False, source="mapping") for name, ours in mapping.items())
    return tuple(parse_rule(text) for text in mapping or ())


def make_rule(foreign: str, ours: str, *, optional: bool, source: str) -> Rule:
    """A rule from the foreign header and what it stands for."""
    sign = 1.0
    if ours[:1] in "+-":
        sign, ours = (-1.0 if ours[0] == "-" else 1.0), ours[1:]
    name, unit = split_unit(ours)
    if name not in ("time", IGNORE):
        _, dot, quantity = name.rpartition(".")
        in_space = ".".join(name.split(".")[-2:]) in SPATIAL_UNITS
        if not in_space and (not dot or quantity not in QUANTITIES):
            raise InputError(
                f"mapping of {foreign!r}: {name!r} is no column of a recording",
                mend=did_you_mean(quantity, QUANTITIES)
                if dot
                else "time, <joint>.position, <link>.tip_deflection, …, or ignore",
                source=source,
            )
    return Rule(foreign, name, unit, sign, optional, source)


def _in_space(name: str, system: System | None) -> tuple[str, str] | None:
    """Joint that turns in space and quantity of ``<body>.pose.qw``, ``<joint>.position.qw`` and the like; None of others."""
    head, _, component = name.rpartition(".")
    site, _, kind = head.rpartition(".")
    quantity = f"{kind}.{component}"
    if not site or quantity not in SPATIAL_UNITS or system is None:
        return None
    for joint in system.joints:
        if joint.turns_in_space and site in (joint.name, joint.child):
            # A body has a pose, a joint has positions.
            return joint.name, quantity
    return None


def unpacked_name(path: Path) -> str:
    """Name of a file without the ending of what packed it."""
    return path.name.removesuffix(".gz").removesuffix(".bz2").removesuffix(".xz")


def rules_beside(path: Path) -> tuple[Rule, ...]:
    """Rules of the TOML file beside a recording: ``run1.csv.toml``, ``run1.toml`` or ``columns.toml``, table ``columns``.

    A ``run1.toml`` without that table is taken for something else. Raises InputError for a file that is not valid.
    """
    bare = unpacked_name(path)
    stem = bare.rsplit(".", 1)[0]
    places = ((path.name + ".toml", True), (bare + ".toml", True), (stem + ".toml", False), ("columns.toml", True))
    for name, must in places:
        file = path.with_name(name)
        if file == path or not file.is_file():
            continue
        try:
            content = parse_toml(file.read_text(encoding="utf-8"), file)
        except UnicodeDecodeError as failure:
            raise InputError(f"not valid TOML: {failure}", mend="mend the file", source=file) from None
        except OSError as failure:
            raise InputError(f"cannot be read: {failure.strerror}", mend="check its rights", source=file) from None
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


@dataclass(frozen=True)
class Found:
    """What the headers are: columns of ours, time first, and which are left out, each with the reason."""

    columns: tuple[Column, ...]
    ignored: tuple[tuple[str, str], ...]


def resolve(
    headers: Sequence[str],
    rules: Iterable[Rule],
    system: System | None,
    *,
    source: Path,
    aliases: Mapping[str, str] | None = None,
    unread: Mapping[str, str] | None = None,
) -> Found:
    """What each header is.

    aliases: other names that headers go by. unread: what else the file holds, and why it was not read.
    Joints that the system has not are left out beside others that it has, unless they look misspelt. Raises InputError for a
    missing time, a rule for a column that is not there, a joint or link that the system has not, a quantity that looks misspelt,
    and two columns for one quantity.
    """
    rules, aliases, unread = tuple(rules), aliases or {}, unread or {}
    found: list[Column] = []
    ignored: list[tuple[str, str]] = []
    strangers: list[tuple[Column, InputError]] = []
    taken: dict[str, str] = {}
    used: set[Rule] = set()
    clock = _clock(headers, rules)
    for header in headers:
        alias = aliases.get(header, "")
        name, own = split_unit(header)
        rule = _rule_of(header, alias, rules, source)
        drop = next((r for r in rules if r.ours == IGNORE and _is_within(r.foreign, header, alias)), None)
        if rule is None and drop is not None:
            used.add(drop)
            ignored.append((header, "is mapped to ignore"))
            continue
        if rule is not None:
            used.add(rule)
            ours, unit, sign = rule.ours, rule.unit or own, rule.sign
        else:
            ours, unit, sign = "time" if header == clock else _spelt_ours(alias or name, system), own, 1.0
        stated = own if own != unit else ""
        if ours == "time":
            column = Column(header, "", "time", unit, sign, stated)
        else:
            site, _, quantity = ours.rpartition(".")
            in_space = _in_space(ours, system)
            if in_space is not None:
                column = Column(header, *in_space, unit, sign, stated)
                if column.name in taken:
                    raise _twice(column, taken[column.name], header, source)
                taken[column.name] = header
                found.append(column)
                continue
            if not site or quantity not in QUANTITIES:
                if "/" not in header:
                    _refuse_misspelt(ours, site, quantity, system, source)
                ignored.append((header, "is no column of ours"))
                continue
            column = Column(header, site, quantity, unit, sign, stated)
            if quantity == "command" and rule is None and not _commanded(site, system):
                ignored.append((header, "is the command of no actuator that the model has"))
                continue
            stranger = _stranger(site, quantity, system, source, header) if system is not None else None
            if stranger is not None and rule is not None:
                raise stranger
            if stranger is not None:
                strangers.append((column, stranger))
                continue
        if column.name in taken:
            raise _twice(column, taken[column.name], header, source)
        taken[column.name] = header
        found.append(column)
    for rule in rules:
        if rule not in used and not rule.optional:
            _refuse_unread((rule.foreign,), unread, source)
            names = [split_unit(h)[0] for h in headers] + [split_unit(a)[0] for a in aliases.values()]
            raise InputError(
                f"there is no column {rule.foreign!r} to map to {rule.ours}",
                mend=did_you_mean(rule.foreign, names),
                source=source,
            )
    if "time" not in taken:
        _refuse_unread(("time", *(rule.foreign for rule in rules if rule.ours == "time")), unread, source)
        named = ", ".join(repr(header[:60]) for header in headers[:6]) + (", …" if len(headers) > 6 else "")
        raise InputError(f"there is no column 'time'; found {named or 'none'}", mend=_time_mend(headers), source=source)
    ignored += _left_out(strangers, found, system)
    if len(found) < 2:
        _refuse_unread(
            [name for name in unread if split_unit(name)[0].rpartition(".")[2] in QUANTITIES], unread, source
        )
        names_ = ", ".join(repr(h) for h, _ in ignored[:6]) or "none"
        raise InputError(
            f"no column besides time is known; found {names_}",
            mend=_of_no_motion(headers, system),
            source=source,
        )
    found.sort(key=lambda column: column.quantity != "time")
    return Found(tuple(found), tuple(ignored))


def _rule_of(header: str, alias: str, rules: Sequence[Rule], source: Path) -> Rule | None:
    """The rule that maps a column; InputError where two of the command line's do, to different things."""
    found = [rule for rule in rules if rule.ours != IGNORE and _is_named(rule.foreign, header, alias)]
    told = {(rule.ours, rule.unit, rule.sign): rule for rule in found if not rule.optional}
    if len(told) > 1:
        first, second = (
            f"{'-' if sign < 0 else ''}{ours}" + (f"[{unit}]" if unit else "") for ours, unit, sign in [*told][:2]
        )
        raise InputError(f"is mapped to {first} and to {second}", mend="leave one out", source=source, column=header)
    return found[0] if found else None


def _refuse_unread(names: Iterable[str], unread: Mapping[str, str], source: Path) -> None:
    """Refuse what is wanted and was not read, with the reason."""
    for name in names:
        if name in unread:
            raise InputError(f"column {name!r} {unread[name]}", mend="store it once, as plain numbers", source=source)


def _of_no_motion(headers: Sequence[str], system: System | None) -> str:
    """The mend where no column is known."""
    poses = [name for name in (split_unit(header)[0] for header in headers) if name.endswith(".pose.qw")]
    if poses and system is not None and not any(joint.turns_in_space for joint in system.joints):
        return f"{poses[0]!r} is of a body that floats, and nothing here does: a URDF's root does with --floating"
    return "name it <joint>.position, … or map it: --map 'theta=<joint>.position[deg]'"


def _twice(column: Column, before: str, header: str, source: Path) -> InputError:
    return InputError(
        f"columns {before!r} and {header!r} are both {column.name}",
        mend=f"leave one out, as --map '{header}=ignore', or remove it",
        source=source,
    )


def _commanded(site: str, system: System | None) -> bool:
    """Whether a model has an actuator of that name, or one at a joint of that name."""
    return system is not None and any(site in (actuator.name, actuator.joint) for actuator in system.actuators)


def _clock(headers: Sequence[str], rules: Sequence[Rule]) -> str | None:
    """The header that is the time by itself: ``time`` before ``Time`` and the like, and none if one is mapped to it."""
    if any(rule.ours == "time" and _is_named(rule.foreign, h, "") for rule in rules for h in headers):
        return None
    exact = next((h for h in headers if split_unit(h)[0] == "time"), None)
    return exact or next((h for h in headers if split_unit(h)[0].lower() in CLOCKS), None)


def _dotted(name: str) -> str:
    return name.replace("/", ".").strip(".")


def _is_named(foreign: str, header: str, alias: str) -> bool:
    """Whether a rule's word is a header, with or without its unit, or its alias; slashes and dots are one."""
    names = {_dotted(text) for whole in (header, alias) if whole for text in (whole, split_unit(whole)[0])}
    return _dotted(foreign) in names


def _is_within(foreign: str, header: str, alias: str) -> bool:
    """Whether a rule's word is a header or what it belongs to: a joint, a link, a topic."""
    name = _dotted(foreign)
    return _is_named(foreign, header, alias) or any(
        _dotted(text).startswith(name + ".") for text in (header, alias) if text
    )


def _spelt_ours(name: str, system: System | None) -> str:
    """``/joint_states/pivot/position`` as ``pivot.position``; joints may have slashes in their names."""
    if "/" not in name:
        return name
    path, _, quantity = name.rpartition("/")
    if "." in quantity and quantity.rpartition(".")[2] in QUANTITIES:
        path, _, quantity = name.rpartition(".")  # as `denoc simulate` writes it
    if quantity not in QUANTITIES:
        return name
    sites = () if system is None else (*system.joint_names, *(link.name for link in system.links))
    known = [site for site in sites if path == site or path.endswith("/" + site)]
    return f"{max(known, key=len, default=path.rpartition('/')[2])}.{quantity}"


def _left_out(
    strangers: Sequence[tuple[Column, InputError]], found: Sequence[Column], system: System | None
) -> list[tuple[str, str]]:
    """Columns of joints and links that the model has not; refused if nothing else is there, or if they look misspelt."""
    if not strangers or system is None:
        return []
    if not any(column.quantity not in ("time", *GIVEN) for column in found):
        raise strangers[0][1]
    reasons = []
    for column, fault in strangers:
        joint = column.quantity in JOINT_QUANTITIES
        sites = system.joint_names if joint else tuple(link.name for link in system.links)
        seen = {c.site for c in found if (c.quantity in JOINT_QUANTITIES) == joint}
        others = [site for site in sites if site not in seen]
        if column.site in [link.name for link in system.links] and joint:
            others = [name for name in others if name == system.carrier(column.site).name]
            misspelt = bool(others)
        else:
            misspelt = bool(get_close_matches(column.site, others, n=1, cutoff=0.6))
        if misspelt:
            raise InputError(
                fault.what,
                mend=f"{fault.mend}; or leave it out: --map '{column.site}=ignore'",
                source=fault.source,
                column=fault.column,
            )
        kind = "joint" if joint else "link"
        reasons.append((column.header, f"is of a {kind} that the model has not, or not as one that moves"))
    return reasons


def _time_mend(headers: Sequence[str]) -> str:
    for header in headers:
        name = split_unit(header)[0]
        if name.lower() == "time" or name.lower() in LIKELY_TIME:
            return f"map it: --map '{name}=time[s]'"
    return "name it 'time' or map it: --map 't=time[s]'"


def _refuse_misspelt(ours: str, site: str, quantity: str, system: System | None, source: Path) -> None:
    if not site:
        return
    # What was commanded goes by many names, and mostly is of no model that has actuators.
    if get_close_matches(quantity, [name for name in QUANTITIES if name != "command"], n=1, cutoff=0.75):
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


def _stranger(site: str, quantity: str, system: System, source: Path, header: str) -> InputError | None:
    """Why the system has no such joint or link, None if it has."""
    joints = system.joint_names
    links = tuple(link.name for link in system.links)
    wants_joint = quantity in JOINT_QUANTITIES
    if quantity == "command":
        known = [*dict.fromkeys(name for actuator in system.actuators for name in (actuator.joint, actuator.name))]
        if site in known:
            return None
        return InputError(
            f"the model has no actuator {site!r}, and none at a joint {site!r}",
            mend=did_you_mean(site, known) if known else f"it has none at all: --map '{header}=ignore'",
            source=source,
            column=header,
        )
    if site in (joints if wants_joint else links):
        return None
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
    return InputError(
        f"the model has no movable joint {site!r}" if kind == "joint" else f"the model has no link {site!r}",
        mend=mend,
        source=source,
        column=header,
    )
