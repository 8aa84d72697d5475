"""Equations (7) and (10) of the paper as they are printed, and each misprint as a term that mends it.

The equations are linear in their misprints: printed + Σ mend = correct, term by term. So the difference between the
printed and the correct equation at any state is the sum of the mends there, exactly, and each has a name.
Signs are the paper's: everything on the left-hand side, θ from the horizontal and positive downward, b along increasing θ.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.engines.protocol import Array


@dataclass(frozen=True)
class Pendulum:
    """The paper's symbols, SI; those of bending are zero for the rigid pendulum.

    rho: ρ, mass per length [kg/m]; l [m]; m_p: payload [kg]; I_h: hub inertia [kg·m²]; xi: ξ [N·m·s]; S0, S1, S2, S3: ∫ s dx,
    ∫ s² dx, ∫ x s dx, s(l); k = EI ∫ s''² dx [N/m]; xi_m: ξ_m, damping of the mode [N·s/m].
    """

    rho: float
    l: float
    m_p: float
    I_h: float
    xi: float
    S0: float = 0.0
    S1: float = 0.0
    S2: float = 0.0
    S3: float = 0.0
    k: float = 0.0
    xi_m: float = 0.0


@dataclass(frozen=True)
class State:
    """θ̇ [rad/s], b [m], ḃ [m/s]; across = g cosθ and along = g sinθ, gravity across and along the link [m/s²]."""

    across: float
    along: float
    theta_rate: float
    b: float = 0.0
    b_rate: float = 0.0


@dataclass(frozen=True, eq=False)
class Terms:
    """Terms of n equations at one state: quadratic · q̈² + mass q̈ + coriolis + gravity + passive = τ.

    quadratic (n,): what multiplies the squares of the accelerations, which only a misprint does. mass (n, n); others (n,).
    """

    quadratic: Array
    mass: Array
    coriolis: Array
    gravity: Array
    passive: Array

    def __add__(self, other: Terms) -> Terms:
        return Terms(
            self.quadratic + other.quadratic,
            self.mass + other.mass,
            self.coriolis + other.coriolis,
            self.gravity + other.gravity,
            self.passive + other.passive,
        )

    def force(self, acceleration: Array) -> Array:
        """The left-hand side at an acceleration, shape (n,)."""
        inertial = self.quadratic * acceleration**2 + self.mass @ acceleration
        return np.asarray(inertial + self.coriolis + self.gravity + self.passive)


def terms(n: int, **parts: dict[int, float] | dict[tuple[int, int], float]) -> Terms:
    """Terms of n equations from the entries that are not zero: ``mass={(0, 1): 2.0}, gravity={0: 1.0}``."""
    made = {name: np.zeros(n) for name in ("quadratic", "coriolis", "gravity", "passive")} | {"mass": np.zeros((n, n))}
    for name, entries in parts.items():
        for place, value in entries.items():
            made[name][place] = value
    return Terms(**made)


@dataclass(frozen=True)
class Slip:
    """One misprint.

    equation: 7 or 10. printed, correct: the term as it stands there and as it should. consequence: in words.
    mend: what to add to the printed equation.
    """

    name: str
    equation: int
    printed: str
    correct: str
    consequence: str
    mend: Callable[[Pendulum, State], Terms]


def rigid_as_printed(p: Pendulum, s: State) -> Terms:
    """(ρl³/3 θ̈ + m_p l² + I_h) ρl³/3 θ̈ + ξ θ̇ = ρ l² g cosθ + m_p g l cosθ: equation (7) to the letter."""
    bar = p.rho * p.l**3 / 3.0
    return terms(
        1,
        quadratic={0: bar**2},
        mass={(0, 0): (p.m_p * p.l**2 + p.I_h) * bar},
        gravity={0: -(p.rho * p.l**2 + p.m_p * p.l) * s.across},
        passive={0: p.xi * s.theta_rate},
    )


def flexible_as_printed(p: Pendulum, s: State) -> Terms:
    """Equation (10) to the letter: the row of θ, then the row of b."""
    coupling = p.S2 + p.m_p * p.l * p.S3
    b, turn = s.b, s.theta_rate
    return terms(
        2,
        mass={
            (0, 0): p.rho * (p.l**3 / 3.0 + p.S1 * b**2 + p.m_p * (p.l**2 + p.S3**2 * b**2) + p.I_h),
            (0, 1): coupling,
            (1, 0): p.rho * coupling,
            (1, 1): p.S1 + p.m_p * p.S3**2,
        },
        coriolis={
            0: 2.0 * (p.S1 + p.S3**2) * b * turn * s.b_rate,
            1: -(2.0 * p.S1 + p.m_p * p.S3**2) * b * turn**2,
        },
        gravity={0: -(p.rho * p.l**2 + p.m_p * p.l) * s.across},
        passive={0: p.xi * turn, 1: p.xi_m * s.b_rate},
    )


def _gravity_halved(n: int) -> Callable[[Pendulum, State], Terms]:
    return lambda p, s: terms(n, gravity={0: 0.5 * p.rho * p.l**2 * s.across})


SLIPS = (
    Slip(
        "acceleration_in_bracket",
        7,
        "ρl³/3 θ̈ inside the bracket that multiplies θ̈",
        "ρl³/3",
        "an equation quadratic in θ̈, without a real solution where gravity drives θ back",
        lambda p, s: terms(
            1, quadratic={0: -((p.rho * p.l**3 / 3.0) ** 2)}, mass={(0, 0): (p.rho * p.l**3 / 3.0) ** 2}
        ),
    ),
    Slip(
        "inertia_factor_twice",
        7,
        "(ρl³/3 + m_p l² + I_h) ρl³/3 θ̈",
        "(ρl³/3 + m_p l² + I_h) θ̈",
        "units do not match; the inertia is ρl³/3 times what it should be",
        lambda p, s: terms(
            1,
            mass={(0, 0): (p.rho * p.l**3 / 3.0 + p.m_p * p.l**2 + p.I_h) * (1.0 - p.rho * p.l**3 / 3.0)},
        ),
    ),
    Slip(
        "gravity_doubled",
        7,
        "ρl² g cosθ",
        "ρl²/2 g cosθ",
        "gravity of the link acts at its tip: the swing is too fast",
        _gravity_halved(1),
    ),
    Slip(
        "gravity_doubled",
        10,
        "ρl² g cosθ",
        "ρl²/2 g cosθ",
        "gravity of the link acts at its tip: the swing is too fast",
        _gravity_halved(2),
    ),
    Slip(
        "payload_inertia_times_density",
        10,
        "ρ m_p (l² + S3² b²) θ̈",
        "m_p (l² + S3² b²) θ̈",
        "units do not match",
        lambda p, s: terms(2, mass={(0, 0): (1.0 - p.rho) * p.m_p * (p.l**2 + p.S3**2 * s.b**2)}),
    ),
    Slip(
        "hub_inertia_times_density",
        10,
        "ρ I_h θ̈",
        "I_h θ̈",
        "units do not match; the hub weighs ρ times what it should",
        lambda p, s: terms(2, mass={(0, 0): (1.0 - p.rho) * p.I_h}),
    ),
    Slip(
        "coupling_without_density",
        10,
        "S2 b̈ in the row of θ",
        "ρ S2 b̈",
        "units do not match; the inertia matrix is not symmetric, so the equations keep no energy",
        lambda p, s: terms(2, mass={(0, 1): (p.rho - 1.0) * p.S2}),
    ),
    Slip(
        "payload_coupling_times_density",
        10,
        "ρ m_p l S3 θ̈ in the row of b",
        "m_p l S3 θ̈",
        "units do not match; the inertia matrix is not symmetric",
        lambda p, s: terms(2, mass={(1, 0): (1.0 - p.rho) * p.m_p * p.l * p.S3}),
    ),
    Slip(
        "modal_inertia_without_density",
        10,
        "S1 b̈",
        "ρ S1 b̈",
        "units do not match; the mode weighs 1/ρ of what it should, or ρ times less",
        lambda p, s: terms(2, mass={(1, 1): (p.rho - 1.0) * p.S1}),
    ),
    Slip(
        "coriolis_without_density",
        10,
        "2 S1 b θ̇ ḃ",
        "2 ρ S1 b θ̇ ḃ",
        "units do not match",
        lambda p, s: terms(2, coriolis={0: 2.0 * (p.rho - 1.0) * p.S1 * s.b * s.theta_rate * s.b_rate}),
    ),
    Slip(
        "payload_coriolis_without_mass",
        10,
        "2 S3² b θ̇ ḃ",
        "2 m_p S3² b θ̇ ḃ",
        "units do not match; a payload of a kilogram where there may be none",
        lambda p, s: terms(2, coriolis={0: 2.0 * (p.m_p - 1.0) * p.S3**2 * s.b * s.theta_rate * s.b_rate}),
    ),
    Slip(
        "centrifugal_without_density",
        10,
        "S1 b θ̇²",
        "ρ S1 b θ̇²",
        "units do not match",
        lambda p, s: terms(2, coriolis={1: -2.0 * (p.rho - 1.0) * p.S1 * s.b * s.theta_rate**2}),
    ),
    Slip(
        "centrifugal_doubled",
        10,
        "2 S1 b θ̇²",
        "S1 b θ̇²",
        "rotation softens the mode twice as much as it does",
        lambda p, s: terms(2, coriolis={1: p.rho * p.S1 * s.b * s.theta_rate**2}),
    ),
    Slip(
        "elastic_stiffness_missing",
        10,
        "nothing",
        "k b",
        "the link cannot vibrate at all",
        lambda p, s: terms(2, passive={1: p.k * s.b}),
    ),
    Slip(
        "gravity_on_mode_missing",
        10,
        "τ2 = 0",
        "(ρ S0 + m_p S3) g cosθ in the row of b",
        "the link does not sag under its own weight",
        lambda p, s: terms(2, gravity={1: -(p.rho * p.S0 + p.m_p * p.S3) * s.across}),
    ),
    Slip(
        "gravity_on_deflection_missing",
        10,
        "nothing",
        "(ρ S0 + m_p S3) g b sinθ in the row of θ",
        "a bent link has its weight where the straight one had it",
        lambda p, s: terms(2, gravity={0: (p.rho * p.S0 + p.m_p * p.S3) * s.b * s.along}),
    ),
)


def slips(equation: int) -> tuple[Slip, ...]:
    """The misprints of equation 7 or 10."""
    return tuple(slip for slip in SLIPS if slip.equation == equation)
