"""Where effects may be said to sit on a rig of a proof: a site that is not there is a slip, no claim to be scored."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from harness.effects.catalogue import catalogue
from harness.effects.effect import SiteKind
from harness.errors import InputError
from harness.system import load


def sites(folder: Path) -> dict[SiteKind, tuple[str, ...]]:
    """Of a case's folder with a model and recordings: names of joints, links, channels and the base."""
    system = load(folder / "model.toml")
    header: dict[str, None] = {}
    for run in sorted(folder.glob("run*.csv")):
        with run.open(encoding="utf-8") as lines:
            header |= dict.fromkeys(lines.readline().strip().split(","))
    channels = [name for name in header if name != "time" and not name.endswith(".effort")]
    return {
        SiteKind.JOINT: tuple(system.joint_names),
        SiteKind.LINK: tuple(link.name for link in system.links),
        SiteKind.CHANNEL: tuple(channels),
        SiteKind.BASE: ("base",),
    }


def refuse_strange(said: Mapping[str, Any], case: str, folder: Path, source: Path) -> None:
    """InputError, naming case and finding, where one sits, or is said to sit as well, where its effect cannot.

    said: what is claimed of the case, whose effects are of the catalogue. folder: of the case.
    """
    if not said["findings"]:
        return
    there, known = sites(folder), catalogue()
    for number, finding in enumerate(said["findings"], 1):
        listed = [text.partition("@") for text in finding.get("indistinguishable_from", [])]
        places = [(finding["effect"], finding["site"]), *((effect, at) for effect, sign, at in listed if sign)]
        for effect, at in places:
            kind = known[effect].site
            if at not in there.get(kind, ()):
                rig = ", ".join(there.get(kind, ())) or "none"
                raise InputError(
                    f"case {case}, finding {number} has {effect} at {at[:40]!r}, which is no {kind.value} of its rig",
                    source=source,
                    mend=f"{effect} sits at a {kind.value}; there: {rig}",
                )
