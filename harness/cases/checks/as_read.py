"""A user's file read once more by the engines' own readers: a misreading of ours would reach every engine alike."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from harness.cases.case import NATIVE, Bench, Row, Series
from harness.cases.checks.states import States, random_states, summed_terms
from harness.compare import quantities
from harness.compare.readings import ALLOWED, differences, field_differences, fields_of, phrase
from harness.engines.protocol import EngineModel
from harness.engines.readers import OWN, Reading, placed_bodies, read_by, readers_of
from harness.engines.readers.register import root_of
from harness.errors import EngineUnavailableError, UnsupportedError
from harness.system.description import STANDARD_GRAVITY, constant
from harness.system.lowering import freed

READING = "reading"
WHY = (
    "a reader turns rotations into quaternions and inertia into principal axes, which rounds; one digit misread is a million "
    "times more"
)
_UNITS = {"gravity": "N·m", "bias": "N·m", "mass_matrix": "kg·m²"}


@dataclass(frozen=True)
class AsRead:
    """Mass matrix, bias, gravity and the joints' numbers as read by Pinocchio and MuJoCo themselves, against our reading.

    The reader of the file's own format (urdfdom by way of Pinocchio for URDF, MuJoCo for MJCF) decides. Another one that reads the
    file otherwise while the own one agrees is told: its rows are skipped, with what it reads otherwise.
    path: the file. allow: folders that it may name files in.
    """

    path: Path
    allow: tuple[Path, ...] = ()
    states: int = 4
    quantity: str = READING

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        model = bench.models.get(NATIVE)
        if model is None or bench.system.flexible:
            return
        # Readers of their own take mimicking joints for independent ones, or leave what they follow to the simulation.
        independent = freed(bench.system)
        others = [joint for joint in independent.joints if not (joint.simple or joint.turns_in_space)]
        if others:
            which = others[0]
            reason = f"joint {which.name!r} of type {which.type}: how it was read is not compared yet"
            for name in readers_of(self.path):
                yield bench.skipped(READING, (NATIVE, name), reason)
            return
        if independent is not bench.system:
            model = bench.build(NATIVE, independent)
            bench = replace(bench, system=independent, models={NATIVE: model})
        states = random_states(bench, self.states, 1.0, 1.0, 1e-3)
        confirmed = False
        for name in readers_of(self.path):
            try:
                reading = read_by(name, self.path, bench.system, allow=self.allow)
            except (UnsupportedError, EngineUnavailableError) as error:
                reason = error.what if isinstance(error, UnsupportedError) else str(error)
                yield bench.skipped(READING, (NATIVE, name), reason)
                continue
            rows = list(self._rows(bench, model, name, reading, states))
            agrees = all(row.verdict == "pass" for row in rows)
            if name == OWN.get(root_of(self.path)):
                confirmed = agrees
            elif confirmed and not agrees:
                rows = [
                    row if row.verdict == "pass" else replace(row, verdict="skipped", first_divergence=None)
                    for row in rows
                ]
            yield from rows

    def _rows(self, bench: Bench, model: EngineModel, name: str, reading: Reading, states: States) -> Iterable[Row]:
        found = differences(placed_bodies(bench.system), reading.placed())
        q, qd = states.q, states.qd
        ours, theirs = (
            {
                "gravity": np.array([made.gravity(x) for x in q]),
                "bias": np.array([made.bias(x, v) for x, v in zip(q, qd, strict=True)]),
                "mass_matrix": np.array([made.mass_matrix(x) for x in q]),
            }
            for made in (model, reading)
        )
        # Weight that is compensated is a term that cancels as well, though our description does not have it any more.
        heavy = bench.system
        if np.linalg.norm(heavy.gravity) < np.linalg.norm(STANDARD_GRAVITY):
            heavy = replace(heavy, gravity=constant(STANDARD_GRAVITY))
        summed = summed_terms(heavy, states, model)
        for quantity, values in ours.items():
            if quantity == "mass_matrix":
                apart = quantities.mass_matrices(values, theirs[quantity])
            else:
                apart = quantities.relative(values, theirs[quantity], terms=summed[quantity])
            note = f"as read by {name}"
            place: dict[str, object] | None = None
            if not apart.max() <= ALLOWED:
                place = found[0].place if found else {"base": bench.system.base, "value": "gravity"}
                size = float(np.abs(values - theirs[quantity]).max())
                note = f"{note}, up to {size:.4g} {_UNITS[quantity]} apart: {phrase(found) or 'gravity'}"
            yield bench.row(
                f"{quantity}_as_read",
                (NATIVE, name),
                float(apart.max()),
                ALLOWED,
                why=WHY,
                first_divergence=place,
                note=note,
                source=str(self.path),
            )
        worst, named = field_differences(fields_of(bench.system), reading.fields())
        note = f"as read by {name}" + (f": {phrase(named)}" if named else "")
        yield bench.row(
            "joint_fields_as_read",
            (NATIVE, name),
            worst,
            ALLOWED,
            why=WHY,
            first_divergence=named[0].place if named else None,
            note=note,
            source=str(self.path),
        )


def told(rows: Iterable[Row]) -> tuple[str, ...]:
    """What readers of other formats made of a file, where that differs, one line for each reader."""
    found: dict[str, str] = {}
    for row in rows:
        if row.verdict != "skipped":
            continue
        if row.quantity == READING:
            found.setdefault(row.engines[-1], f"{row.engines[-1]} did not read the file by itself: {row.note}")
        elif row.quantity.endswith("_as_read"):
            found.setdefault(row.engines[-1], f"{row.note}; the file's own reader agrees with ours")
    return tuple(found.values())
