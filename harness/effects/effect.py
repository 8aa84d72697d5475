"""What an effect of the catalogue states: names, units, bounds, words, source, and the one way in which it acts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Protocol

import numpy as np

from harness.effects.directions import sideways
from harness.effects.scale import References, Scale
from harness.errors import InputError
from harness.system import System
from harness.system.description import Array
from harness.system.suggest import did_you_mean

CHANNEL_UNIT = "channel"  # stands for the unit of the channel that a sensor effect sits at
PER_CHANNEL_UNIT = "1/channel"
PER_CHANNEL_UNIT_SQUARED = "1/channel**2"


BY_MODEL = "stated by the model"  # among what an effect modifies


class Family(StrEnum):
    """The catalogue's chapters."""

    DISSIPATION = "joint dissipation"
    STIFFNESS = "joint stiffness, torque"
    INERTIA = "inertia, geometry"
    BASE = "base"
    ELASTICITY = "elasticity"
    SENSOR = "sensor"
    INPUT = "input"


class SiteKind(StrEnum):
    """What an effect sits at."""

    JOINT = "joint"
    LINK = "link"
    CHANNEL = "channel"
    LOOP = "loop"
    BASE = "base"


def cauchy_surprise(away: Any) -> Any:
    """−2 log of a Cauchy density, less its greatest value, so many of its scales away."""
    return 2.0 * np.log1p(away**2)


@dataclass(frozen=True)
class Plausible:
    """How far from absence a number usually is, and why: the scale of a Cauchy prior, whose tails rule nothing out.

    size: in the parameter's unit. source: where that is from. inverse: what is usually small is one over the number, and ``size``
    is in one over its unit: how much something gives, of a stiffness; how slow it is, of a frequency.
    """

    size: Scale
    source: str
    inverse: bool = False

    def surprise(self, value: float, neutral: float, references: References) -> float:
        """−2 log of the prior's density, less its greatest value, at a value of the number.

        neutral: at which the effect is absent.
        """
        away = 1.0 / max(abs(value), 1e-300) if self.inverse else value - neutral
        return float(cauchy_surprise(away / self.size(references)))


@dataclass(frozen=True)
class PlausibleTogether:
    """How large what several numbers of an effect make together usually is, and why: as ``Plausible``.

    what: in words. of: the parameters by name and the natural sizes to that number [1], nothing of it being absence.
    """

    what: str
    of: Callable[[Mapping[str, float], References], float]
    size: float
    source: str

    def surprise(self, values: Mapping[str, float], references: References) -> float:
        """−2 log of the prior's density, less its greatest value."""
        return float(cauchy_surprise(self.of(values, references) / self.size))


@dataclass(frozen=True)
class Parameter:
    """One number of an effect.

    unit: SI, in the spelling of the ``pint`` package; "channel" is the unit of the channel concerned.
    linear_unit: the same at a prismatic joint, if it differs.
    lower, upper: what physics allows.
    scale: a typical size, as a rule over the natural sizes of system and recording.
    starts: values to start a search from, in multiples of ``scale`` counted from ``neutral`` (from 0 if that is infinite).
    neutral: the value at which the effect is absent, if one value alone does that.
    search: "gradient" where a start near the truth is not needed, "spectrum" where the residual's spectrum must give the start,
        "line" where steady lines of the channel must, "range" where the motion's range must (the misfit has no slope far from the
        truth), "size" where the starts are tried as they are, because equations are stiff near absence or nothing acts there.
    inexact: relative error at most of what the effect's model makes of it, whatever the recording.
    plausible: how large it usually is, where that is known.
    """

    name: str
    unit: str
    what: str
    lower: float = -np.inf
    upper: float = np.inf
    scale: Scale = field(default_factory=Scale)
    starts: tuple[float, ...] = (1.0,)
    neutral: float = 0.0
    search: str = "gradient"
    linear_unit: str = ""
    inexact: float = 0.0
    plausible: Plausible | None = None

    @property
    def positive(self) -> bool:
        """Whether physics gives the sign."""
        return self.lower >= 0.0

    def start_values(self, references: References) -> tuple[float, ...]:
        """Starting values in SI (channel units for sensors), inside the bounds."""
        origin = self.neutral if np.isfinite(self.neutral) else 0.0
        size = self.scale(references)
        return tuple(float(np.clip(origin + start * size, self.lower, self.upper)) for start in self.starts)


class Rows(Protocol):
    """What a law needs of the native lanes: where a parameter stands in a lane's row, and of which system."""

    @property
    def system(self) -> System: ...

    def slot(self, site: str, name: str) -> int:
        """Index of the parameter in the row; InputError if the topology has no such slot."""
        ...


@dataclass(frozen=True)
class JointLaw:
    """Acts through slots of a lane's row, so that trying it compiles nothing.

    slots: slot name for each parameter, in the order of the effect's parameters.
    sideways: whether the slots of the base's direction are to be set as well, to the horizontal in the plane of motion.
    """

    slots: tuple[str, ...]
    sideways: bool = False

    def write(self, rows: Array, model: Rows, site: str, params: Array) -> None:
        """Put ``params`` (B, k), in SI, into ``rows`` (B, P) in place; what stood in the slots is replaced."""
        for column, slot in enumerate(self.slots):
            rows[:, model.slot(site, slot)] = params[:, column]
        if self.sideways:
            for name, share in zip(
                ("excitation_x", "excitation_y", "excitation_z"), sideways(model.system), strict=True
            ):
                rows[:, model.slot(site, name)] = share


@dataclass(frozen=True)
class Reshape:
    """Acts by making another system of the given one.

    change: (system, site, parameters by name) -> System; raises InputError if the system cannot have it.
    topology: whether it adds or removes coordinates; otherwise the rows of the same compiled model will do.
    expected: (system, site) -> the parameters that theory foretells, by name, if it does.
    """

    change: Callable[[System, str, Mapping[str, float]], System]
    topology: bool = False
    expected: Callable[[System, str], Mapping[str, float]] | None = None


@dataclass(frozen=True)
class Sensor:
    """Acts on a predicted channel.

    apply: (signal (B, T), time (T,), params (B, k)) -> (B, T); ``time`` may be uneven, but ascends.
    stage: place in the chain from the motion to the file; lower comes first. Two effects of one channel apply in this order.
    every_channel: acts on all channels of a recording alike, whatever channel it is written at.
    clock: its first parameter is recorded over true time, so recorded efforts are stamped by it as well.
    linear: what it adds is proportional to how strongly it acts, so that a weak one is like a strong one made smaller.
    memory: of the same arguments, what it may still know of the time before the first sample: course (B, T) and size (B,).
    remembers: that is as large as the signal where a stretch begins within a recording, a number of every such stretch's own.
    courses: of a wave whose phase is every recording's own: (time (T,), params (B, k), times (K,) around every sample that it is
        the mean of) -> two courses (2, B, T) a quarter of a period apart, as large as stated; ``apply`` begins it at phase zero.
    own_zero: adds a constant of its own to every recording, as that shows it.
    at_first: acts where a recording begins; a stretch of one that begins within it, from a state of its own, is as it is without.
    """

    apply: Callable[[Array, Array, Array], Array]
    stage: int
    every_channel: bool = False
    clock: bool = False
    linear: bool = False
    memory: Callable[[Array, Array, Array], tuple[Array, Array]] | None = None
    remembers: bool = False
    courses: Callable[[Array, Array, Array], Array] | None = None
    own_zero: bool = False
    at_first: bool = False


@dataclass(frozen=True)
class Input:
    """Acts on the applied effort of a joint: the same form as a sensor, effort recorded -> effort that arrives.

    nonlinear: whether the share that arrives depends on how large the effort is.
    """

    apply: Callable[[Array, Array, Array], Array]
    stage: int
    nonlinear: bool = False


@dataclass(frozen=True)
class UserLaw:
    """A torque of the user's own at a joint.

    torque: (position, velocity, time, parameters (k,)) -> torque [N·m or N] that acts on the joint, compilable by numba.
    """

    torque: Callable[[float, float, float, Any], float]


Alongside = Callable[[Mapping[str, float], Mapping[str, float], References], Mapping[str, float]]


@dataclass(frozen=True, kw_only=True)
class Effect:
    """A piece of physics that a nominal model may have left out.

    signature: how it shows in a recording. shows_in: which recordings can show it. source: where the law is from.
    needs: what a recording must have: "effort", "motion" (a joint's position, velocity or effort), "flexible" (a beam in
        the system), "rigid" (a rigid link with mass), "deflection" (a channel that sees bending), "exact shapes" (a beam
        whose modes theory goes on with; samples end where they end), "line" (a steady line in the channel's spectrum),
        "several" (recordings), "coupling" (a joint that follows another), "space" (a body that turns about any axis), "axis" (a
        link that turns about one), "balanced" (such a link with its centre of mass on that axis, where gravity or what carries it
        can pull it to a side), "servo" (a joint with a drive whose feedback acts), "damped servo" (one with stiffness and
        damping), "stated" (a model that states it: no recording proposes it).
    expressed_by: how each engine can say it; an engine that is not named cannot.
    simpler: effects that this one contains as a special case. modifies: effects at its site without one of which it is nothing;
        ``BY_MODEL`` among them where the model states one; two that modify the same exclude each other. alongside: (own parameters,
        those of what it modifies, natural sizes) -> the latter changed so that both together act about as that did alone.
    confusable_with: effects that some recordings cannot tell from it.
    plausible: how large what its numbers make together usually is, where no number alone says it.
    rarity: logarithm of how much rarer it is met than the plain effects, all else being equal (prior odds).
    law, reshape, sensor, input, user: exactly one is given; a reshape and an input where what is commanded and what is fed back
        are one drive's.
    """

    name: str
    title: str
    family: Family
    site: SiteKind
    parameters: tuple[Parameter, ...]
    signature: str
    shows_in: str
    source: str
    expressed_by: Mapping[str, str]
    needs: tuple[str, ...] = ()
    simpler: tuple[str, ...] = ()
    modifies: tuple[str, ...] = ()
    alongside: Alongside | None = None
    confusable_with: tuple[str, ...] = ()
    rarity: float = 0.0
    plausible: PlausibleTogether | None = None
    law: JointLaw | None = None
    reshape: Reshape | None = None
    sensor: Sensor | None = None
    input: Input | None = None
    user: UserLaw | None = None

    def __post_init__(self) -> None:
        given = [m for m in (self.law, self.reshape, self.sensor, self.input, self.user) if m is not None]
        if len(given) != 1 + self.of_servo:
            raise ValueError(f"effect {self.name!r} states {len(given)} mechanisms; exactly one is needed")

    @property
    def side(self) -> str:
        """``dynamics``, ``sensor`` or ``input``."""
        if self.sensor is not None:
            return "sensor"
        return "input" if self.input is not None else "dynamics"

    @property
    def of_servo(self) -> bool:
        """Whether it is of a drive whose feedback it reshapes as it changes what the command makes arrive."""
        return self.reshape is not None and self.input is not None

    @property
    def in_mechanism(self) -> bool:
        """Whether it changes how the mechanism moves by itself, with whatever arrives at its joints."""
        return self.side == "dynamics" or self.reshape is not None

    @property
    def adds_coordinates(self) -> bool:
        """Whether it acts through coordinates of its own."""
        return self.reshape is not None and self.reshape.topology

    @property
    def switch(self) -> bool:
        """Whether the mechanism has it or not, without a size."""
        return self.reshape is not None and not self.parameters

    @property
    def remembers(self) -> bool:
        """Whether it is a sensor's error with a past of its own."""
        return self.sensor is not None and self.sensor.memory is not None

    @property
    def usual(self) -> bool:
        """Whether it is met as often as any and has a single number and no past of its own, which little else can be bent to; none
        that only says how another one acts.
        """
        return len(self.parameters) == 1 and self.rarity <= 0.0 and not self.remembers and not self.modifies

    @property
    def plain(self) -> bool:
        """Whether it is such a law, of the motion and no sensor's error."""
        return self.side == "dynamics" and self.usual

    @property
    def plainness(self) -> tuple[int, bool, float]:
        """By which laws that a recording does not part are told, the plainest first: numbers, a past of its own, how rare it is."""
        return len(self.parameters), self.remembers, self.rarity

    @property
    def parameter_names(self) -> tuple[str, ...]:
        return tuple(parameter.name for parameter in self.parameters)

    @property
    def lower(self) -> Array:
        """Physical lower bounds, shape (k,)."""
        return np.array([parameter.lower for parameter in self.parameters], dtype=np.float64)

    @property
    def upper(self) -> Array:
        """Physical upper bounds, shape (k,)."""
        return np.array([parameter.upper for parameter in self.parameters], dtype=np.float64)

    def scales(self, references: References) -> Array:
        """Typical sizes at a site, shape (k,)."""
        return np.array([parameter.scale(references) for parameter in self.parameters], dtype=np.float64)

    def units(self, *, prismatic: bool = False, channel_unit: str = "") -> tuple[str, ...]:
        """Units of the parameters at a revolute or prismatic joint, or at a channel of that unit."""
        return tuple(_unit(parameter, prismatic, channel_unit) for parameter in self.parameters)

    def values(self, parameters: Mapping[str, float]) -> Array:
        """Parameters by name as an array in the effect's order, shape (k,).

        Raises InputError for a missing, unknown or non-finite one, or one outside what physics allows.
        """
        for name in parameters:
            if name not in self.parameter_names:
                raise InputError(
                    f"effect {self.name!r} has no parameter {name!r}", mend=did_you_mean(name, self.parameter_names)
                )
        values = []
        for parameter in self.parameters:
            if parameter.name not in parameters:
                raise InputError(
                    f"effect {self.name!r} lacks its parameter {parameter.name!r}", mend=f"give it in {parameter.unit}"
                )
            value = float(parameters[parameter.name])
            if np.isnan(value) or not parameter.lower <= value <= parameter.upper:
                raise InputError(
                    f"effect {self.name!r}: {parameter.name} = {value:g} is not possible",
                    mend=f"between {parameter.lower:g} and {parameter.upper:g} {parameter.unit}",
                )
            values.append(value)
        return np.array(values, dtype=np.float64)

    def named(self, values: Sequence[float] | Array) -> dict[str, float]:
        """The inverse of ``values``: parameters by name."""
        return {name: float(value) for name, value in zip(self.parameter_names, values, strict=True)}


def _unit(parameter: Parameter, prismatic: bool, channel_unit: str) -> str:
    if parameter.unit == CHANNEL_UNIT:
        return channel_unit or "1"
    if parameter.unit.startswith(CHANNEL_UNIT + "/"):
        return (f"{channel_unit}" if channel_unit else "1") + parameter.unit[len(CHANNEL_UNIT) :]
    if parameter.unit == PER_CHANNEL_UNIT:
        return f"1/({channel_unit})" if channel_unit not in ("", "1") else "1"
    if parameter.unit == PER_CHANNEL_UNIT_SQUARED:
        return f"1/({channel_unit})**2" if channel_unit not in ("", "1") else "1"
    return parameter.linear_unit if prismatic and parameter.linear_unit else parameter.unit
