"""What ``scipy.integrate.solve_ivp`` stops at."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from harness.cases.case import Array


@dataclass(eq=False)
class Event:
    """A function of time and state that ends an integration where it passes zero.

    direction: only where it rises (1) or falls (-1); 0 for either.
    """

    passes: Callable[[float, Array], float]
    direction: float = 0.0
    terminal: bool = True

    def __call__(self, time: float, state: Array) -> float:
        return self.passes(time, state)
