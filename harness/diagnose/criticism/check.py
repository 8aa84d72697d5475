"""What a residual check is: one question put to what a fit leaves, with what may be known of its answer beforehand.

A check is a file of ``checks/`` that says ``CHECK = Check(name, ask, …)``, and its name stands in ``checks/catalogue.py``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.criticism.constants import END_QUANTILES, FASTEST_QUANTILE, LOUDNESS_BLOCKS
from harness.diagnose.criticism.probe import Probe, probe
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.selection.outcome import Outcome
from harness.diagnose.selection.score_tests import Nuisance, Projected, nuisance
from harness.diagnose.selection.study import Study
from harness.effects.effect import Effect
from harness.effects.scale import references

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Form:
    """The sparsest symbolic form of the residual force at a joint: torque = Σ coefficient · term [N·m]."""

    joint: str
    terms: tuple[str, ...]
    coefficients: tuple[float, ...]
    gain: float

    def __str__(self) -> str:
        """As a sum: ``-0.00782·sin(q) + 0.0005``, the term 1 as a number by itself."""
        parts: list[str] = []
        for c, term in zip(self.coefficients, self.terms, strict=True):
            sign = ("- " if c < 0.0 else "+ ") if parts else ("-" if c < 0.0 else "")
            parts.append(f"{sign}{abs(c):.3g}" + ("" if term == "1" else f"·{term}"))
        return " ".join(parts)


@dataclass(frozen=True, eq=False)
class Map:
    """Residual force at a joint over its position and velocity [N·m], nan where the motion has not been."""

    joint: str
    position: Array
    velocity: Array
    force: Array


@dataclass(frozen=True, eq=False)
class Test:
    """One question put to the residual: gain in cost by ``size`` shapes, and its chance under noise alone.

    where: first the joint or channel that it is about, if there is one. places: parameters beside amplitudes (the moment of a
    jump); −1 for tests that name no force. together: gain and number of such events if every recording may have its own. choices:
    among how many forces of this kind it was chosen. exact: whether the channels are linear in it, as they are in an error of a
    reading, so that it brings what it promises. cause: whether it says where what other tests see as well comes from. form,
    force_map: of the force, where it is one over the state of a joint; the map is made when it is asked for.
    """

    name: str
    gain: float
    size: int
    chance: float
    where: tuple[str, ...] = ()
    places: int = 0
    together: tuple[float, int] = (0.0, 0)
    choices: float = 1.0
    exact: bool = False
    cause: bool = False
    form: Form | None = None
    force_map: Callable[[], Map] | None = None

    def price(self, samples: float) -> float:
        """What the force that a test names costs in the Bayesian criterion."""
        return (self.size + self.places) * float(np.log(samples)) + 2.0 * float(np.log(self.choices))

    def price_together(self, samples: float) -> float:
        """The same for such an event of its own in every recording."""
        return self.together[1] * (1 + self.places) * float(np.log(samples))

    def worth(self, samples: float) -> float:
        """What the force gains beyond its price, acting alike in all recordings or in each by itself."""
        return max(self.gain - self.price(samples), self.together[0] - self.price_together(samples))


@dataclass(frozen=True, eq=False)
class AtJoint:
    """One joint at which forces may act: its probe, the range of its position and how fast it gets.

    measured: responses that several checks hold against the residual, by what they are of.
    """

    joint: str
    probe: Probe
    low: float
    high: float
    fast: float
    measured: dict[str, Projected] = field(default_factory=dict)

    @property
    def place(self) -> int:
        """Of the joint among the motion's coordinates."""
        return self.probe.names.index(self.joint)


@dataclass(frozen=True, eq=False)
class Remainder:
    """What a fit leaves, as checks are asked of it.

    space: what the fit may adjust. noise: variance of what it leaves in most places, in units of the noise's; one at least.
    outcome: of the whole search, where there is one. here: the joint that a check of every joint is asked at.
    """

    study: Study
    fitted: Fit
    space: Nuisance
    noise: float
    outcome: Outcome | None = None
    here: AtJoint | None = None

    @property
    def predictor(self) -> Predictor:
        return self.study.predictor

    @property
    def likelihood(self) -> Likelihood:
        return self.study.likelihood

    @property
    def period(self) -> float:
        """Of the slowest swing [s]."""
        return self.study.swing

    @property
    def at(self) -> AtJoint:
        """The joint that a check of every joint is asked at."""
        assert self.here is not None
        return self.here

    def at_joint(self, joint: str) -> Remainder | None:
        """The same at one joint, None where that does not move."""
        own = probe(self.predictor, self.likelihood, self.fitted, references(self.study.problem.system, joint).torque)
        k = own.names.index(joint)
        pooled = np.concatenate([m.q[:, k] for m in own.motions.values()])
        speeds = np.abs(np.concatenate([m.qd[:, k] for m in own.motions.values()]))
        # A run of a closed mechanism ends in nan where its loops can be closed no farther.
        ran = np.isfinite(pooled) & np.isfinite(speeds)
        if not ran.any():
            return None
        pooled, speeds = pooled[ran], speeds[ran]
        low, high = (float(x) for x in np.quantile(pooled, END_QUANTILES))
        if high - low < 1e-9:
            return None
        fast = max(float(np.quantile(speeds, FASTEST_QUANTILE)), 1e-9)
        return replace(self, here=AtJoint(joint, own, low, high, fast))


def left_by(study: Study, fitted: Fit, outcome: Outcome | None = None) -> Remainder:
    """What a fit leaves, to be checked."""
    blocks = [block for r in fitted.linear.residuals for block in np.array_split(r, LOUDNESS_BLOCKS)]
    loud = [float(np.mean(b[b != 0.0] ** 2)) if np.any(b != 0.0) else 1.0 for b in blocks]
    return Remainder(study, fitted, nuisance(fitted, study.predictor), max(1.0, float(np.median(loud))), outcome)


class Asked(Enum):
    """Of what a check is asked."""

    OF_EVERY_FIT = "of every fit"
    OF_WHAT_IS_TOLD = "of the set that is told"
    BESIDE_A_REMAINDER = "of the set that is told, where others have found that something is left"


@dataclass(frozen=True, eq=False)
class Check:
    """One residual check.

    name: with what the names of its tests, as they are told, begin. ask: for the tests. every_joint: whether it is asked at every
    joint by itself. exact: whether channels are linear in what it names, so that its gain can be had. aside: whether it is worth a
    thread of its own. leaves: how much of the cost is above the noise, of a test that counts. quick: whether what is only asked
    beside a remainder is quick enough to be asked of every set on the way. may_stand_for: whether what it names could be taken for
    all of some effects. on_both_sides: whether it has to be weighed beside a set with an effect as well as without that, since it
    might do the effect's work and more. of_state: whether what it names is a force at a joint as a function of the joint's state.
    """

    name: str
    ask: Callable[[Remainder], Iterable[Test]]
    every_joint: bool = False
    asked: Asked = Asked.OF_EVERY_FIT
    exact: bool = False
    aside: bool = False
    leaves: Callable[[Test], float] = lambda test: test.gain
    quick: Callable[[Study], bool] = lambda study: False
    may_stand_for: Callable[[Sequence[Effect]], bool] = lambda effects: True
    on_both_sides: Callable[[Effect], bool] = lambda effect: False
    of_state: bool = False


def nothing_left(test: Test) -> float:
    """For checks whose gain is not a cost above the noise."""
    return 0.0


def is_no_motion(effect: Effect) -> bool:
    """Whether an effect is one of a sensor or of a drive."""
    return effect.side != "dynamics"
