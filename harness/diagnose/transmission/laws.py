"""Laws of the twist: shapes along the recorded motion, each times a share that an effect's parameters follow from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.transmission.twist import SECOND, TwistRun

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TwistLaw:
    """One way in which a link's encoder reads otherwise than its drive's.

    effect: of the catalogue. shapes: twist for a share of one each, (N,). values: parameters, by shares. positive: whether physics
    gives the shares' signs. sensor: whether it is the second encoder's own.
    """

    effect: str
    shapes: tuple[Callable[[TwistRun], Array], ...]
    values: Callable[[Sequence[float]], dict[str, float]]
    positive: bool = False
    sensor: bool = False

    def site(self, joint: str) -> str:
        """Where it acts: at the joint, or at the channel of its second encoder."""
        return f"{joint}.{SECOND}" if self.sensor else joint


# A spring of stiffness k twists by load over k; damped by c, by c/k² less for each unit of the load's rate, in first order (Spong,
# J. Dyn. Syst. Meas. Control 109 (1987) 310). In a gap the link rests against the tooth that its load pushes it to. An encoder that
# is late by T reads T times the speed less.
LAWS = (
    TwistLaw("joint_flexibility", (lambda run: run.load,), lambda s: {"stiffness": 1.0 / s[0]}, positive=True),
    TwistLaw(
        "joint_flexibility",
        (lambda run: run.load, lambda run: -run.load_rate),
        lambda s: {"stiffness": 1.0 / s[0], "damping": s[1] / s[0] ** 2},
        positive=True,
    ),
    TwistLaw("backlash", (lambda run: run.push,), lambda s: {"gap": 2.0 * s[0]}, positive=True),
    TwistLaw("sensor_delay", (lambda run: run.speed,), lambda s: {"delay": s[0]}, sensor=True),
    TwistLaw("sensor_gain", (lambda run: run.position,), lambda s: {"gain": 1.0 - s[0]}, sensor=True),
)  # fmt: skip
WIDTHS = tuple(len(law.shapes) for law in LAWS)
ENDS = np.cumsum((0, *WIDTHS))


class Laws(tuple[int, ...]):
    """Some of the laws, by their places in the table, no effect twice."""

    __slots__ = ()

    @property
    def columns(self) -> list[int]:
        """Places of their shapes among all."""
        return [c for law in self for c in range(int(ENDS[law]), int(ENDS[law + 1]))]

    @property
    def spans(self) -> list[slice]:
        """Where each one's shares stand among theirs."""
        ends = np.cumsum((0, *(WIDTHS[law] for law in self)))
        return [slice(int(a), int(b)) for a, b in pairwise(ends)]

    def without(self, k: int) -> Laws:
        return Laws(self[:k] + self[k + 1 :])

    def plainer(self, k: int) -> Laws:
        """With the same effect of fewer numbers in the place of the k-th, or without it where there is none."""
        fewer = [
            law
            for law in range(len(LAWS))
            if LAWS[law].effect == LAWS[self[k]].effect and WIDTHS[law] < WIDTHS[self[k]]
        ]
        return Laws(sorted((*self.without(k), *fewer[-1:])))

    def with_(self, law: int) -> Laws | None:
        """With one more, if that is an effect of its own."""
        taken = {LAWS[other].effect for other in self}
        return None if LAWS[law].effect in taken else Laws(sorted((*self, law)))


EVERY = tuple(
    Laws(some)
    for k in range(len({law.effect for law in LAWS}) + 1)
    for some in combinations(range(len(LAWS)), k)
    if len({LAWS[law].effect for law in some}) == k
)
