"""Two models of the user's own as two descriptions of one mechanism: a row for every field that differs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from harness.cases.case import Bench, Case, Row, Series, thin
from harness.compare.descriptions import TOLERANCE, Comparison, Cost, Difference, alike, compare, costs, namesakes
from harness.errors import UnsupportedError
from harness.system import System
from harness.system.lowering import chained, freed, refuse_loops

# Single costs are worked out for this many differences, the largest first; the rest have that of all together.
PRICED = 12
# Of more than two models, those are two descriptions of one mechanism that share this many names of bodies or joints.
SHARED = 0.5


def pairs_of(models: Mapping[str, System]) -> list[tuple[str, str]]:
    """Which models are held against which: two against one another, of more each against the first that shares its names."""
    names = list(models)
    if len(names) == 2:
        return [(names[0], names[1])]
    found = []
    for k, name in enumerate(names):
        earlier = (other for other in names[:k] if namesakes(models[other], models[name]) >= SHARED)
        found += [(other, name) for other in [next(earlier, None)] if other is not None]
    return found


def case_of_two(names: tuple[str, str], systems: tuple[System, System], tolerance: float = TOLERANCE) -> Case:
    """The case of two descriptions."""
    return Case(
        name=f"{names[0]} against {names[1]}",
        title=f"Two descriptions: {_file(systems[0])} against {_file(systems[1])}",
        source="mass, axes and inertia in the pose of zero determine a tree of rigid bodies (Brockett 1984)",
        system=lambda: systems[0],
        checks=(Descriptions(names, systems, tolerance),),
        group="models",
        engines=(),
    )


def _file(system: System) -> str:
    return system.name if system.source is None else system.source.name


class Descriptions:
    """A row for each field that differs beyond the tolerance, and one for each that does not."""

    quantity = "description"

    def __init__(self, names: tuple[str, str], systems: tuple[System, System], tolerance: float) -> None:
        self.names, self.systems, self.tolerance = names, systems, tolerance

    def run(self, bench: Bench) -> Iterator[Row | Series]:
        """Compare, and say what came out."""
        if not alike(*self.systems):
            yield bench.skipped(
                "description", self.names, "no link or joint in common by name, and trees of other shapes"
            )
            return
        try:
            for system in self.systems:
                refuse_loops(system, "a comparison of descriptions")
            # As descriptions, joints that follow others are joints like any; free ones and balls are chains of simple ones.
            systems = [freed(chained(freed(system))) for system in self.systems]
        except UnsupportedError as error:
            yield bench.skipped("description", self.names, error.what)
            return
        comparison = compare(systems[0], systems[1])
        beyond = sorted((d for d in comparison.differences if not d.size <= self.tolerance), key=lambda d: -d.size)
        alone, together = costs(comparison, beyond[:PRICED])
        if len(beyond) > PRICED:
            together = costs(comparison, beyond)[1]
        prices = [*alone, *[None] * (len(beyond) - len(alone))]
        for field in dict.fromkeys(d.field for d in comparison.differences):
            mine = [d for d in beyond if d.field == field]
            for difference in mine:
                yield self._row(
                    bench, difference, prices[beyond.index(difference)], together if len(beyond) > 1 else None
                )
            stated = [d for d in comparison.differences if d.field == field and not d.one_sided]
            if stated and not mine:
                yield self._agreeing(bench, stated)
        yield from self._one_sided(bench, comparison)
        yield from _pictures(bench, comparison, together, self.names)

    def _row(self, bench: Bench, difference: Difference, price: Cost | None, together: Cost | None) -> Row:
        told = [difference.stated, "" if price is None else str(price)]
        if together is not None and price is not None:
            told.append(f"with the others: {together}")
        return bench.row(
            f"{difference.field}@{difference.site}",
            self.names,
            difference.size,
            self.tolerance,
            why=f"--tolerance {self.tolerance:g}",
            unit=difference.unit,
            note="; ".join(filter(None, told)),
        )

    def _one_sided(self, bench: Bench, comparison: Comparison) -> Iterator[Row]:
        for field in dict.fromkeys(d.field for d in comparison.differences if d.one_sided):
            mine = [d for d in comparison.differences if d.field == field and d.one_sided]
            told = ", ".join(f"{d.site} {d.stated}" for d in mine[:PRICED])
            yield bench.skipped(field, self.names, f"{field} stated in one file only: {told}")

    def _agreeing(self, bench: Bench, differences: list[Difference]) -> Row:
        worst = max(differences, key=lambda d: d.size)
        note = f"of {len(differences)} compared" if worst.size == 0.0 else f"most at {worst.site}: {worst.stated}"
        return bench.row(
            worst.field, self.names, worst.size, self.tolerance, why=f"--tolerance {self.tolerance:g}", unit=worst.unit, note=note
        )  # fmt: skip


def _pictures(bench: Bench, comparison: Comparison, together: Cost, names: tuple[str, str]) -> Iterator[Series]:
    """The joint that comes apart most, moving freely by either description."""
    if together.motions is None or not together.apart > 0.0:
        return
    for name, motion in zip(names, together.motions, strict=True):
        position = motion.position[:, motion.names.index(together.joint)]
        label = f"{together.joint} [{together.unit}]"
        yield Series(
            bench.case.name, "descriptions", name, thin(motion.time), thin(position), "time [s]", label,
            f"{together.joint} moving freely by either description",
        )  # fmt: skip
