"""Engines of users' own, found by the entry point group ``denoc.engines`` and written as a small class.

What such a class needs is ``build(system)``, which returns an object with any of the methods of
:class:`harness.engines.protocol.EngineModel`; everything else has a default here. See ``docs/own_engine.md``.
"""

from __future__ import annotations

import inspect
import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import metadata
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.engines.checked import held_forces, raise_if_refused, sample_times, vector
from harness.engines.protocol import Array, EngineError
from harness.errors import EngineUnavailableError, InputError, UnsupportedError
from harness.system import System, Trajectory

GROUP = "denoc.engines"
_log = logging.getLogger(__name__)


@cache
def entry_points() -> Mapping[str, metadata.EntryPoint]:
    """Entry points of installed distributions by engine name; of two of one name, the first found."""
    found: dict[str, metadata.EntryPoint] = {}
    for point in metadata.entry_points(group=GROUP):
        if point.name in found and found[point.name].value != point.value:
            _log.warning("two packages bring an engine %r: %s is taken", point.name, found[point.name].value)
        found.setdefault(point.name, point)
    return found


def from_entry_point(point: metadata.EntryPoint) -> OwnEngine:
    """The engine of an entry point; one that cannot be loaded is there too, and says why when asked for its version."""
    version = point.dist.version if point.dist is not None else ""
    try:
        made = point.load()
        return OwnEngine(made() if inspect.isclass(made) else made, point.name, version)
    except Exception as error:  # someone else's module may raise anything
        text = " ".join(str(error).split())
        return OwnEngine(None, point.name, version, f"{point.value} cannot be loaded: {type(error).__name__}: {text}")


@dataclass(frozen=True)
class OwnEngine:
    """An object with ``build(system)``, or a function from a system to a model, as an ``Engine``.

    given: what the user wrote. name: by which rows call it. stated: version of its distribution. broken: why it cannot be
    used, if so.
    """

    given: Any
    name: str
    stated: str = ""
    broken: str = ""

    def version(self) -> str:
        if self.broken:
            raise EngineUnavailableError(f"{self.name}: {self.broken}")
        tell = getattr(self.given, "version", None)
        return str(tell() if callable(tell) else tell or self.stated or "unknown")

    def refuses(self, system: System) -> str | None:
        """What the class says; one that says nothing is taken for an engine of rigid bodies without joint laws of effects."""
        ask = getattr(self.given, "refuses", None)
        if ask is not None:
            reason: str | None = ask(system)
            return reason
        if system.loops:
            return f"{self.name} does not say that it takes loops"
        if not system.simple:
            return f"{self.name} does not say that it takes joints of several degrees of freedom, or that follow others"
        if system.flexible:
            return f"{self.name} does not say that it takes flexible links"
        if system.attachments:
            return f"{self.name} does not say that it takes the effect {system.attachments[0].effect}"
        return None

    def build(self, system: System) -> OwnModel:
        """The system in this engine; UnsupportedError if it refuses it, EngineError if what it builds is no model."""
        raise_if_refused(system, self.refuses(system))
        make = getattr(self.given, "build", self.given)
        model = make(system)
        if not any(callable(getattr(model, name, None)) for name in ANSWERS):
            raise EngineError(
                f"{self.name}: build(system) gave {type(model).__name__}, which has no {' or '.join(ANSWERS)}"
            )
        names = system.coordinate_names
        theirs = tuple(getattr(model, "names", None) or names)
        if sorted(theirs) != sorted(names):
            raise EngineError(
                f"{self.name}: its model's names are {', '.join(theirs[:6])}; the system has {', '.join(names[:6])}"
            )
        return OwnModel(names, self.name, model, np.array([names.index(name) for name in theirs]))


ANSWERS = (
    "forward_dynamics",
    "inverse_dynamics",
    "mass_matrix",
    "bias",
    "gravity",
    "energy",
    "simulate",
    "frequencies",
)


@dataclass(frozen=True, eq=False)
class OwnModel:
    """A user's model with arrays in the order of ``System.coordinate_names``; see ``EngineModel``.

    What it has no method for raises UnsupportedError; an answer of the wrong shape, EngineError.
    order: place in our order of each of its coordinates.
    """

    names: tuple[str, ...]
    engine: str
    model: Any
    order: NDArray[np.intp] = field(repr=False)

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        return self._vector("forward_dynamics", q, qd, tau)

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        return self._vector("inverse_dynamics", q, qd, qdd)

    def bias(self, q: Array, qd: Array) -> Array:
        return self._vector("bias", q, qd)

    def gravity(self, q: Array) -> Array:
        return self._vector("gravity", q)

    def mass_matrix(self, q: Array) -> Array:
        n = len(self.names)
        theirs = self._shaped("mass_matrix", self._ask("mass_matrix", *self._theirs(q)), (n, n))
        ours = np.empty((n, n))
        ours[np.ix_(self.order, self.order)] = theirs
        return ours

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        kinetic, potential = self._shaped("energy", self._ask("energy", *self._theirs(q, qd)), (2,))
        return float(kinetic), float(potential)

    def frequencies(self, q: Array) -> Array:
        found = np.asarray(self._ask("frequencies", *self._theirs(q)), dtype=np.float64)
        return np.sort(found.ravel())

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """The user's ``simulate(q0, qd0, time, tau=…, step=…)``: a Trajectory, or positions and velocities, each (T, n)."""
        time = sample_times(time)
        forces = held_forces(tau, time.size, len(self.names))
        options = {"tau": None if forces is None else forces[:, self.order], "step": step}
        function = self._method("simulate")
        taken = inspect.signature(function).parameters
        if not any(p.kind is inspect.Parameter.VAR_KEYWORD for p in taken.values()):
            if forces is not None and "tau" not in taken:
                raise UnsupportedError(f"{self.engine}: its simulate takes no tau")
            options = {name: value for name, value in options.items() if name in taken}
        found = function(*self._theirs(q0, qd0), time, **options)
        if isinstance(found, Trajectory):
            found = (found.position, found.velocity)
        shape = (time.size, len(self.names))
        position, velocity = (self._shaped("simulate", part, shape) for part in found)
        ours, speeds = np.empty(shape), np.empty(shape)
        ours[:, self.order], speeds[:, self.order] = position, velocity
        return Trajectory(time, self.names, ours, speeds)

    def _method(self, name: str) -> Callable[..., Any]:
        function: Callable[..., Any] | None = getattr(self.model, name, None)
        if function is None:
            raise UnsupportedError(f"{self.engine} has no {name}")
        return function

    def _ask(self, name: str, *arguments: Array) -> Any:
        return self._method(name)(*arguments)

    def _theirs(self, *ours: Array) -> list[Array]:
        return [vector("state", value, len(self.names))[self.order] for value in ours]

    def _vector(self, name: str, *ours: Array) -> Array:
        n = len(self.names)
        theirs = self._shaped(name, self._ask(name, *self._theirs(*ours)), (n,))
        result = np.empty(n)
        result[self.order] = theirs
        return result

    def _shaped(self, name: str, value: Any, shape: tuple[int, ...]) -> Array:
        try:
            array = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            raise EngineError(f"{self.engine}: {name} gave {type(value).__name__}, not an array of numbers") from None
        if array.shape != shape:
            raise EngineError(f"{self.engine}: {name} gave shape {array.shape}, not {shape}")
        return array


def own_engine(given: Any, name: str | None = None) -> OwnEngine:
    """What a user hands over as an engine: an object or class with ``build``, or a function from a system to a model.

    name: by which rows call it; its attribute ``name``, or its own, unless given. Raises InputError for anything else.
    """
    if isinstance(given, OwnEngine):
        return given
    made = given() if inspect.isclass(given) else given
    if not callable(getattr(made, "build", made)):
        raise InputError(
            f"{type(made).__name__} is no engine", mend="give an object with build(system), or a function of a system"
        )
    called = name or getattr(made, "name", None) or getattr(made, "__name__", None) or type(made).__name__
    return OwnEngine(made, str(called).strip("<>"))
