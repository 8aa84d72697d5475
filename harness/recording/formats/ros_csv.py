"""What ``rostopic echo -p`` writes: ``%time,field.header.stamp,field.name0,field.position0, …``, times in nanoseconds."""

from __future__ import annotations

import re
from collections.abc import Sequence

ARRAY = re.compile(r"^field\.(name|position|velocity|effort)(\d+)$")
STAMP = "field.header.stamp"


def is_rostopic(names: Sequence[str]) -> bool:
    return len(names) > 1 and names[0].lstrip("%") == "time" and all(name.startswith("field") for name in names[1:])


def joints_of(
    names: Sequence[str], rows: Sequence[Sequence[str]]
) -> tuple[tuple[str, ...], list[Sequence[str]], dict[str, str], dict[str, str], set[str]]:
    """A column for every joint and quantity in the place of numbered fields, and the message's own stamp as time if it has one.

    The order of the joints may change from message to message; a column goes by the name of its joint then, else by the file's own,
    ``field.position0``, with the joint's as an alias. Returns names, rows, units, aliases, and what one message states twice.
    """
    place = {name: k for k, name in enumerate(names)}
    stamp = place.get(STAMP)
    clock = stamp if stamp is not None and any(row[stamp].strip("0 ") for row in rows) else 0
    arrays: dict[str, dict[str, int]] = {}
    for name, k in place.items():
        match = ARRAY.match(name)
        if match:
            arrays.setdefault(match[2], {})[match[1]] = k
    arrays = {number: fields for number, fields in arrays.items() if "name" in fields}
    used = {k for fields in arrays.values() for k in fields.values()}
    kept = [k for k in range(1, len(names)) if k not in used]
    joints: dict[str, set[str]] = {}
    held: dict[str, set[str]] = {}
    for row in rows:
        for number, fields in arrays.items():
            joint = row[fields["name"]].strip()
            for quantity in fields:
                if quantity != "name" and joint:
                    joints.setdefault(f"{joint}.{quantity}", set()).add(names[fields[quantity]])
                    held.setdefault(number, set()).add(joint)
    always = {names[k] for number, fields in arrays.items() if len(held.get(number, ())) == 1 for k in fields.values()}
    own = {joint: next(iter(columns)) for joint, columns in joints.items() if len(columns) == 1 and columns <= always}
    dressed: list[Sequence[str]] = []
    twice: set[str] = set()
    for row in rows:
        values: dict[str, str] = {}
        for fields in arrays.values():
            joint = row[fields["name"]].strip()
            for quantity in fields.keys() - {"name"} if joint else ():
                name = f"{joint}.{quantity}"
                twice |= {name} & values.keys()
                values[name] = row[fields[quantity]]
        dressed.append([row[clock], *(values.get(joint, "") for joint in joints), *(row[k] for k in kept)])
    heads = (own.get(joint, joint) for joint in joints)
    return (
        ("time", *heads, *(names[k] for k in kept)),
        dressed,
        {"time": "ns"},
        {column: joint for joint, column in own.items()},
        twice,
    )
