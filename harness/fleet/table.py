"""One table of all units, made from their answers one after another: of a unit, its name and its numbers stay."""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.answer.findings import one_by_one
from harness.fleet.spread import EFFICIENCY, FALSE, FEWEST, away, chances, outlying, spread

SCHEMA = "denoc.fleet/1"
GRADES = ("established", "likely", "possible")
CLAIMED = ("established", "likely")  # whose numbers count; a possible effect's are those of a guess
RARE = 0.05  # share of the units, up to which an established effect is told as rare
TURNING = ("phase",)  # parameters that come round: neither a median nor a distance means anything
MOST_BINS = 40  # of a histogram
QUANTILES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
METHOD = (
    "Numbers are of effects graded established or likely. mean, between: random effects, the standard deviation between units by "
    "Paule and Mandel (1982), its 95 % interval by the Q-profile (Viechtbauer 2007); chance: Cochran's Q. outliers: distance "
    "from the median in robust standard deviations (median absolute deviation with each unit's own uncertainty), by Student's "
    f"distribution with {EFFICIENCY:g} (k - 1) degrees of freedom, adjusted over all numbers of the fleet together (Benjamini and "
    f"Hochberg 1995) at {FALSE:g}; numbers of fewer than {FEWEST} units are not judged."
)


@dataclass
class _Numbers:
    """One parameter over the units that have it: units by their place, values, standard deviations (nan: none), shape (k,)."""

    unit: str
    units: array[int] = field(default_factory=lambda: array("l"))
    values: array[float] = field(default_factory=lambda: array("d"))
    stds: array[float] = field(default_factory=lambda: array("d"))


class Table:
    """Takes answers (``denoc.unit/1``) and tells the fleet's document (``denoc.fleet/1``)."""

    def __init__(self) -> None:
        self._names: list[str] = []
        self._failed: list[dict[str, Any]] = []
        self._verdicts: dict[str, int] = {}
        self._incomplete: list[str] = []
        self._effects: dict[tuple[str, str], dict[str, array[int]]] = {}
        self._numbers: dict[tuple[str, str, str], _Numbers] = {}

    def add(self, name: str, answer: Mapping[str, Any] | None) -> None:
        """Count a unit in; answer: None where there is none."""
        place = len(self._names)
        self._names.append(name)
        found = None if answer is None else answer["diagnosis"]
        if found is None:
            self._failed.append({"unit": name, "what": "has no answer" if answer is None else str(answer["failed"])})
            return
        self._verdicts[found["verdict"]] = self._verdicts.get(found["verdict"], 0) + 1
        if not found["complete"]:
            self._incomplete.append(name)
        for finding in one_by_one(found["findings"]):
            key = (finding["effect"], finding["site"])
            # An answer without grades claims what it tells.
            grade = finding.get("grade") or "likely"
            graded = self._effects.setdefault(key, {g: array("l") for g in GRADES})[grade]
            if not graded or graded[-1] != place:
                graded.append(place)
            if grade not in CLAIMED:
                continue
            for parameter, number in finding["parameters"].items():
                if number["value"] is None:
                    continue
                numbers = self._numbers.setdefault((*key, parameter), _Numbers(number["unit"]))
                numbers.units.append(place)
                numbers.values.append(number["value"])
                numbers.stds.append(float("nan") if number["std"] is None else number["std"])

    def document(self) -> dict[str, Any]:
        """The fleet's table as plain data."""
        parameters, outliers = self._spread()
        return {
            "schema": SCHEMA,
            "units": len(self._names),
            "diagnosed": len(self._names) - len(self._failed),
            "verdicts": dict(sorted(self._verdicts.items(), key=lambda item: -item[1])),
            "incomplete": self._incomplete,
            "failed": self._failed,
            "effects": self._by_effect(),
            "rare": self._rare(),
            "parameters": parameters,
            "outliers": outliers,
            "method": METHOD,
        }

    def _by_effect(self) -> list[dict[str, Any]]:
        rows = [
            {"effect": effect, "site": site, **{g: [self._names[k] for k in graded[g]] for g in GRADES}}
            for (effect, site), graded in self._effects.items()
        ]
        return sorted(rows, key=lambda row: (*(-len(row[g]) for g in GRADES), row["effect"], row["site"]))

    def _rare(self) -> list[dict[str, Any]]:
        diagnosed = len(self._names) - len(self._failed)
        return [
            {"unit": self._names[k], "effect": effect, "site": site, "others": len(graded["established"]) - 1}
            for (effect, site), graded in sorted(self._effects.items())
            if sum(len(graded[g]) for g in CLAIMED) <= RARE * diagnosed
            for k in graded["established"]
        ]

    def _spread(self) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
        keys = sorted(self._numbers, key=lambda key: (-len(self._numbers[key].values), key))
        rows, judged = [], []
        for key in keys:
            numbers = self._numbers[key]
            values, stds = np.array(numbers.values), np.array(numbers.stds)
            known = np.isfinite(stds)
            turning = key[2] in TURNING
            row: dict[str, Any] = {
                "effect": key[0], "site": key[1], "parameter": key[2], "unit": numbers.unit, "number": len(values),
                "with_interval": int(known.sum()), "median": None if turning else float(np.median(values)),
                "quantiles": None if turning else _quantiles(values),
                "within": float(np.median(stds[known])) if known.any() else None,
                "mean": {"value": None, "std": None},
                "between": {"value": None, "ci95": None, "robust": None, "chance": None},
                "histogram": None if turning else _histogram(values), "outliers": None,
            }  # fmt: skip
            rows.append(row)
            if turning or known.sum() < 2:
                continue
            s = spread(values[known], stds[known])
            row["mean"] = {"value": s.mean, "std": s.mean_std}
            row["between"] = {"value": s.between, "ci95": [s.low, s.high], "robust": None, "chance": s.chance}
            if known.sum() >= FEWEST:
                z, row["between"]["robust"] = away(values[known], stds[known])
                judged.append((row, np.array(numbers.units)[known], values[known], stds[known], z))
        outliers = []
        adjusted = outlying([chances(z) for *_, z in judged])
        for (row, places, values, stds, z), chance in zip(judged, adjusted, strict=True):
            apart = np.flatnonzero(chance < FALSE)
            row["outliers"] = len(apart)
            outliers += [
                {
                    "unit": self._names[places[k]], **{name: row[name] for name in ("effect", "site", "parameter")},
                    "value": float(values[k]), "std": float(stds[k]), "median": row["median"], "si": row["unit"],
                    "z": float(z[k]), "chance": float(chance[k]),
                }
                for k in apart
            ]  # fmt: skip
        return rows, sorted(outliers, key=lambda row: -abs(row["z"]))


def _quantiles(values: NDArray[np.float64]) -> dict[str, float]:
    return dict(zip(map(str, QUANTILES), np.quantile(values, QUANTILES).tolist(), strict=True))


def _histogram(values: NDArray[np.float64]) -> dict[str, list[float]] | None:
    """Counts between even edges, by Freedman and Diaconis's width and no more than forty."""
    extent = float(np.ptp(values))
    if len(values) < FEWEST or extent <= 0.0:
        return None
    low, high = np.quantile(values, (0.25, 0.75))
    width = 2.0 * float(high - low) * len(values) ** (-1.0 / 3.0)
    bins = MOST_BINS if width * MOST_BINS <= extent else max(4, int(np.ceil(extent / width)))
    counts, edges = np.histogram(values, bins)
    return {"edges": edges.tolist(), "counts": counts.tolist()}
