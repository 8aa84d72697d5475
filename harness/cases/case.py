"""What a case is, what it sees while it runs, and what it returns."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from harness.engines.protocol import EngineModel
from harness.system import System

if TYPE_CHECKING:
    from harness.denoc.model import Denoc

Array = NDArray[np.float64]

NATIVE = "denoc"
GROUPS = ("rigid", "chaos", "scale", "lanes", "robots", "loops", "flexible", "models")


@dataclass(frozen=True)
class Row:
    """One line of the table: one quantity of one case, between two engines or an engine and a published truth.

    engines: whom the difference lies between; a truth from paper is ``"analytic"`` or ``"published"``.
    difference, allowed: in ``unit`` (``"1"`` is relative); None in a skipped row.
    verdict: ``pass``, ``fail`` or ``skipped``.
    note: what else a reader should know; names the odd one out when engines disagree.
    first_divergence: where and when the difference first left the line, e.g. ``{"time": 3.2, "joint": "elbow"}``.
    source: citation of the truth.
    seconds: wall time [s] of the check that gave the row, shared among its rows; None where it was not measured.
    """

    case: str
    quantity: str
    engines: tuple[str, ...]
    difference: float | None
    allowed: float | None
    unit: str
    why_allowed: str
    verdict: str
    note: str = ""
    first_divergence: Mapping[str, object] | None = None
    source: str = ""
    group: str = "rigid"
    seconds: float | None = field(default=None, compare=False)

    @property
    def key(self) -> str:
        """Identity of the row in the accepted figures."""
        return "/".join((self.case, self.quantity, "+".join(self.engines)))

    @property
    def ratio(self) -> float:
        """difference / allowed, 0 for no difference where none is allowed; nan in a skipped row."""
        if self.difference is None or self.allowed is None:
            return math.nan
        if self.difference == 0.0:
            return 0.0
        return self.difference / self.allowed if self.allowed > 0.0 else math.inf


@dataclass(frozen=True)
class Doubt:
    """A number of a model that no body, or hardly one, can have: engines agree on it all the same.

    severity: ``impossible`` or ``implausible``. site: the link.
    """

    case: str
    severity: str
    site: str
    what: str


@dataclass(frozen=True)
class Series:
    """Data for one line of one plot of the report.

    figure: which plot: lines of one figure and case are drawn together. The report knows how to draw
        ``trajectory``, ``divergence``, ``frequency_amplitude``, ``tip_deflection``, ``spectrum``, ``convergence``,
        ``frequency_spin``, ``amplitude_decay``, ``cost``; an unknown figure is drawn as plain lines.
    label: legend entry, the engine's name where it is one engine's.
    x, y: at most some hundred points (see :func:`thin`); x_label, y_label: with units.
    style: ``line``, ``dashed``, ``points``; log: ``""``, ``x``, ``y`` or ``xy``.
    marks: vertical lines, text to position on x (``{"horizon": 7.3}``).
    """

    case: str
    figure: str
    label: str
    x: tuple[float, ...]
    y: tuple[float, ...]
    x_label: str
    y_label: str
    title: str = ""
    style: str = "line"
    log: str = ""
    marks: Mapping[str, float] = field(default_factory=dict)


def thin(values: Array, count: int = 400) -> tuple[float, ...]:
    """At most ``count`` evenly chosen samples, the last one included."""
    values = np.asarray(values, dtype=np.float64)
    if len(values) <= count:
        return tuple(values.tolist())
    index = np.unique(np.linspace(0, len(values) - 1, count).round().astype(int))
    return tuple(values[index].tolist())


class Check(Protocol):
    """One quantity of a case."""

    @property
    def quantity(self) -> str:
        """Name of the quantity as it stands in the table."""
        ...

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        """Compare, and say what came out."""
        ...


@dataclass(frozen=True)
class Case:
    """A mechanism, the quantities compared on it, and where their truth comes from.

    name: unique, the key of the accepted figures. system: builds the mechanism. checks: what is compared.
    source: citation. group: heading in the report, one of ``GROUPS``. engines: by name, None for all of the
    registry. cost: rough seconds on one core; long cases start first.
    """

    name: str
    title: str
    source: str
    system: Callable[[], System]
    checks: tuple[Check, ...]
    group: str = "rigid"
    engines: tuple[str, ...] | None = None
    cost: float = 1.0


@dataclass(frozen=True)
class Bench:
    """What a check sees: the case, its system, and the engines that can express it.

    models: by engine name, native first. refusals: engine name to the reason why it is not among the models.
    """

    case: Case
    system: System
    models: Mapping[str, EngineModel]
    refusals: Mapping[str, str] = field(default_factory=dict)

    @property
    def native(self) -> Denoc:
        """The native model itself, for what only it is asked."""
        from harness.engines.denoc_native import NativeModel

        model = self.models[NATIVE]
        assert isinstance(model, NativeModel)
        return model.model

    @cached_property
    def explained(self) -> dict[str, Any]:
        """What was found to explain a difference from an engine, by its name, for the checks that ask after the first."""
        return {}

    @cached_property
    def seed(self) -> int:
        """Depends on the case's name alone, so that a case gives the same figures in any order and on any worker."""
        return int.from_bytes(hashlib.sha256(self.case.name.encode()).digest()[:4], "big")

    def rng(self) -> np.random.Generator:
        """A fresh generator, the same at every call."""
        return np.random.default_rng(self.seed)

    def build(self, engine: str, system: System) -> EngineModel:
        """Another system in an engine by name (for sweeps over a parameter)."""
        from harness.engines.registry import engine as by_name

        return by_name(engine).build(system)

    def row(
        self,
        quantity: str,
        engines: tuple[str, ...],
        difference: float,
        allowed: float,
        *,
        why: str,
        unit: str = "1",
        note: str = "",
        first_divergence: Mapping[str, object] | None = None,
        source: str = "",
        about: Mapping[str, object] | None = None,
    ) -> Row:
        """A row whose verdict is whether ``difference`` is within ``allowed``; what is not a number never passes.

        about: of a row that measures one thing alone, what is to blame where it fails: ``term``, and the ``joint``, ``link`` or
        ``channel`` that it is at. What ``first_divergence`` says of these stands.
        """
        difference = float(difference)
        passes = math.isfinite(difference) and difference <= allowed
        if not passes and about is not None:
            first_divergence = {**about, **(first_divergence or {})}
        if not math.isfinite(difference):
            note = "; ".join(filter(None, ["the difference is not a finite number", note]))
        return Row(
            self.case.name,
            quantity,
            engines,
            difference,
            float(allowed),
            unit,
            why,
            "pass" if passes else "fail",
            note,
            first_divergence,
            source or self.case.source,
            self.case.group,
        )

    def skipped(self, quantity: str, engines: tuple[str, ...], reason: str) -> Row:
        """A row that says why nothing was compared."""
        return Row(
            self.case.name,
            quantity,
            engines,
            None,
            None,
            "1",
            "",
            "skipped",
            reason,
            None,
            self.case.source,
            self.case.group,
        )

    def peers(self) -> Iterator[tuple[str, EngineModel]]:
        """Every model but the native one."""
        return ((name, model) for name, model in self.models.items() if name != NATIVE)
