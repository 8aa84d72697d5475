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
) -> tuple[tuple[str, ...], list[Sequence[str]], dict[str, str]]:
    """The same with ``<joint>.position``, … in the place of numbered fields, and the message's own stamp as time if it has one.

    The order of the joints may change from message to message. Returns names, rows and units.
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
    joints: dict[str, None] = {}
    for row in rows:
        for fields in arrays.values():
            joint = row[fields["name"]].strip()
            for quantity in fields:
                if quantity != "name" and joint:
                    joints[f"{joint}.{quantity}"] = None
    dressed: list[Sequence[str]] = []
    for row in rows:
        values = {
            f"{row[fields['name']].strip()}.{quantity}": row[k]
            for fields in arrays.values()
            for quantity, k in fields.items()
        }
        dressed.append([row[clock], *(values.get(joint, "") for joint in joints), *(row[k] for k in kept)])
    return ("time", *joints, *(names[k] for k in kept)), dressed, {"time": "ns"}
