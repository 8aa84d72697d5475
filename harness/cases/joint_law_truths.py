"""Motions of one wheel under one joint law each, in closed form or as its own equation integrated by SciPy.

Every truth is written from the law's definition and shares nothing with the lanes: J θ'' = torque, without gravity.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

from harness.cases.case import Array
from harness.cases.rotor import INERTIA as J
from harness.cases.solver_event import Event
from harness.engines.oscillator import oscillate

SPRING = 0.5  # N·m/rad


@dataclass(frozen=True)
class Law:
    """A law in the lanes and its truth.

    name: of the row. slots: parameters of the hub in a lane row. start: angle [rad] and speed [rad/s]. truth: angle over
    time. time: duration [s]. allowed [rad], why. source: equation. torque: applied at the samples, held between them.
    teeth: half the play, stiffness and damping of teeth with play, the lanes' extra law, if any.
    """

    name: str
    slots: dict[str, float]
    start: tuple[float, float]
    truth: Callable[[Array], Array]
    source: str
    duration: float = 2.0
    allowed: float = 1e-8
    why: str = "1e-11 a step; reversals and breaks are located in time"
    torque: Callable[[Array], Array] | None = None
    teeth: tuple[float, ...] = field(default=())


def _integrated(
    start: tuple[float, float],
    torque: Callable[[float, float], float],
    *,
    kinks: Callable[[float, float], float] | None = None,
) -> Callable[[Array], Array]:
    """J θ'' = torque(θ, θ'), by DOP853 at 1e-12, begun anew wherever ``kinks(θ, θ')`` changes its sign."""

    def truth(time: Array) -> Array:
        found = np.empty_like(time)
        t, y = float(time[0]), np.array(start)
        event = None
        if kinks is not None:
            bend = kinks
            event = Event(lambda _, y: bend(y[0], y[1]))
        while True:
            run = solve_ivp(
                lambda _, y: [y[1], torque(y[0], y[1]) / J], (t, time[-1]), y, method="DOP853", rtol=1e-12, atol=1e-13,
                dense_output=True, events=event, max_step=0.02,
            )  # fmt: skip
            inside = (time >= t) & (time <= run.t[-1])
            found[inside] = run.sol(time[inside])[0]
            if run.status != 1:
                return found
            # A little beyond the kink, so that it is not found again.
            t, y = float(run.t[-1]), run.y[:, -1]
            step = 1e-9
            y = y + step * np.array([y[1], torque(y[0] + step * y[1], y[1]) / J])
            t += step

    return truth


def _dry(
    start: tuple[float, float], friction: float, stiffness: float, force: Callable[[Array], Array] | None = None
) -> Callable[[Array], Array]:
    def truth(time: Array) -> Array:
        pushed = np.zeros_like(time) if force is None else force(time)
        return oscillate(start, J, 0.0, stiffness, pushed, friction, time)[0]

    return truth


def _ramp(time: Array) -> Array:
    """Steps that stay under 0.012 N·m for a while, then go beyond it, and back."""
    return np.where(time < 0.8, 0.006 + 0.007 * time, np.where(time < 1.4, 0.02, -0.004))


def _bouncing(start: tuple[float, float], at: float, stiffness: float) -> Callable[[Array], Array]:
    """Free flight at constant speed between two springs at ± at, half a cosine in each: nothing is lost."""
    omega, speed = math.sqrt(stiffness / J), abs(start[1])
    flight, contact = 2.0 * at / speed, math.pi / omega

    def truth(time: Array) -> Array:
        # Counted from the passage through -at upwards.
        t = (time + (start[0] + at) / speed) % (2.0 * (flight + contact))
        upper = np.where(t < flight, -at + speed * t, at + speed / omega * np.sin(omega * (t - flight)))
        late = t - flight - contact
        lower = np.where(late < flight, at - speed * late, -at - speed / omega * np.sin(omega * (late - flight)))
        return np.asarray(np.where(t < flight + contact, upper, lower))

    return truth


def _stop(start: tuple[float, float], at: float, k: float, d: float, inertia: float) -> Callable[[Array], Array]:
    """One bounce at a stop k δ + d δ' + I δ'' that pushes and never pulls: a damped half swing, then free flight."""

    def truth(time: Array) -> Array:
        speed = start[1]
        touch = (at - start[0]) / speed
        whole = J + inertia
        sigma = 0.5 * d / whole
        omega = math.sqrt(k / whole - sigma**2)
        # The inertia of the stop is at rest when it is touched, and what sets in there is a force, not an impact.
        fine = np.linspace(0.0, math.pi / omega, 200_001)
        delta = speed / omega * np.exp(-sigma * fine) * np.sin(omega * fine)
        rate = speed * np.exp(-sigma * fine) * (np.cos(omega * fine) - sigma / omega * np.sin(omega * fine))
        pull = -(k * delta + d * rate) / whole  # δ'' while it pushes: the force is then -J δ''
        last = int(np.argmax(pull[1:] >= 0.0)) + 1
        share = pull[last - 1] / (pull[last - 1] - pull[last])
        leave = fine[last - 1] + share * (fine[1] - fine[0])
        parted = speed / omega * math.exp(-sigma * leave) * math.sin(omega * leave)
        away = speed * math.exp(-sigma * leave) * (math.cos(omega * leave) - sigma / omega * math.sin(omega * leave))
        t = time - touch
        inside = at + speed / omega * np.exp(-sigma * t) * np.sin(omega * t)
        after = at + parted + away * (t - leave)
        return np.asarray(np.where(t < 0.0, start[0] + speed * time, np.where(t < leave, inside, after)))

    return truth


def _dahl(start: tuple[float, float], torque: float, stiffness: float) -> Callable[[Array], Array]:
    """df/dθ = k (1 − sign(θ') f/T) beside the spring; integrated with f as a state, piece by piece."""

    def truth(time: Array) -> Array:
        found = np.empty_like(time)
        t, y, sense = float(time[0]), np.array([*start, 0.0]), math.copysign(1.0, start[1])

        def rates(_: float, y: Array) -> list[float]:
            return [y[1], -(y[2] + SPRING * y[0]) / J, stiffness * y[1] * (1.0 - sense * y[2] / torque)]

        rest = Event(lambda _, y: float(y[1]))
        while True:
            rest.direction = -sense
            run = solve_ivp(
                rates,
                (t, time[-1]), y, method="DOP853", rtol=1e-12, atol=1e-14, dense_output=True, events=rest, max_step=0.02,
            )  # fmt: skip
            inside = (time >= t) & (time <= run.t[-1])
            found[inside] = run.sol(time[inside])[0]
            if run.status != 1:
                return found
            t, y, sense = float(run.t[-1]), run.y[:, -1], -sense

    return truth


def _decay(start: tuple[float, float], rate: float) -> Callable[[Array], Array]:
    return lambda time: start[0] + start[1] / rate * (1.0 - np.exp(-rate * time))


_FREE, _SWUNG = (0.0, 3.0), (1.1, 0.0)

LAWS = (
    Law(
        "damping", {"damping": 0.01}, _FREE, _decay(_FREE, 0.01 / J), "ω(t) = ω₀ exp(−c t / J)"
    ),
    Law(
        "armature", {"armature": 0.03, "stiffness": SPRING}, _SWUNG,
        lambda time: 1.1 * np.cos(math.sqrt(SPRING / (J + 0.03)) * time), "θ'' = −k θ / (J + I_h)",
    ),
    Law(
        "spring", {"stiffness": SPRING, "rest_angle": 0.3}, _SWUNG,
        lambda time: 0.3 + 0.8 * np.cos(math.sqrt(SPRING / J) * time), "θ'' = −k (θ − θ₀) / J",
    ),
    Law(
        "dry_friction", {"coulomb_torque": 0.06, "stiffness": SPRING}, _SWUNG, _dry(_SWUNG, 0.06, SPRING),
        "half swings about ± F/k, stuck within; phase by phase in closed form", duration=4.0,
    ),
    Law(
        "break_loose", {"coulomb_torque": 0.012}, (0.2, 0.0), _dry((0.2, 0.0), 0.012, 0.0, _ramp),
        "stuck while |τ| ≤ F, then J θ'' = τ − F sign(θ'); phase by phase in closed form", torque=_ramp,
    ),
    Law(
        "stribeck", {"coulomb_torque": 0.02, "static_torque": 0.05, "stribeck_velocity": 0.4}, _FREE,
        _integrated(_FREE, lambda _, v: -(0.02 + 0.03 * math.exp(-((v / 0.4) ** 2)))),
        "J ω' = −(F_c + (F_s − F_c) exp(−(ω/v_s)²)) while it turns", duration=2.0,
    ),
    Law(
        "quadratic_drag", {"quadratic_drag": 0.004}, _FREE,
        lambda time: J / 0.004 * np.log1p(0.004 * 3.0 * time / J), "θ(t) = (J/c) ln(1 + c ω₀ t / J)",
    ),
    Law(
        "creep", {"coulomb_torque": 0.05, "creep_velocity": 0.3}, _FREE,
        _integrated(_FREE, lambda _, v: -0.05 * math.tanh(v / 0.3)), "J ω' = −F tanh(ω/v_c)",
    ),
    Law(
        "soft_friction", {"coulomb_torque": 0.5, "soft_time": 0.02, "soft_inertia": 0.002}, _FREE,
        _decay(_FREE, 0.002 / 0.02 / (J + 0.002)), "(J + I) ω' = −I ω / τ while it holds",
    ),
    Law(
        "dahl", {"dahl_torque": 0.03, "dahl_stiffness": 0.4, "stiffness": SPRING}, (0.0, 1.0), _dahl((0.0, 1.0), 0.03, 0.4),
        "df/dθ = σ (1 − sign(θ') f / F), P. Dahl, TOR-0158 (1968)", duration=3.0, allowed=1e-7,
    ),
    Law(
        "cubic_spring", {"cubic_stiffness": 0.7}, _SWUNG, _integrated(_SWUNG, lambda q, _: -0.7 * q**3), "J θ'' = −k θ³",
    ),
    Law(
        "polynomial",
        {
            "stiffness": SPRING, "rest_angle": 0.3, "cubic_damping": 0.002, "polynomial_square": 0.3, "polynomial_cube": 0.4,
            "polynomial_rest": 0.3,
        },
        _SWUNG, _integrated(_SWUNG, lambda q, v: -SPRING * (q - 0.3) - 0.3 * (q - 0.3) ** 2 - 0.4 * (q - 0.3) ** 3 - 0.002 * v**3),
        "J θ'' = −(k₁ + k₂ x + k₃ x²) x − c θ'³, x = θ − θ₀",
    ),
    Law(
        "constant_torque", {"constant_torque": 0.013}, (0.1, -0.2), lambda time: 0.1 - 0.2 * time + 0.5 * 0.013 / J * time**2,
        "θ = θ₀ + ω₀ t + τ t² / 2J",
    ),
    Law(
        "cogging", {"cogging_amplitude": 0.02, "cogging_periods": 7.0, "cogging_phase": 0.6}, (0.0, 1.5),
        _integrated((0.0, 1.5), lambda q, _: 0.02 * math.sin(7.0 * q + 0.6)), "J θ'' = a sin(p θ + φ)",
    ),
    Law(
        "stop", {"stop_angle": 0.5, "stop_stiffness": 40.0, "stop_damping": 0.3}, (0.2, 2.0),
        _stop((0.2, 2.0), 0.5, 40.0, 0.3, 0.0), "k δ + d δ' where that pushes: a damped half swing", duration=1.0,
        allowed=1e-7,
    ),
    Law(
        "stop_inertia", {"stop_angle": 0.5, "stop_stiffness": 40.0, "stop_damping": 0.3, "stop_inertia": 0.005}, (0.2, 2.0),
        _stop((0.2, 2.0), 0.5, 40.0, 0.3, 0.005), "k δ + d δ' + I δ'' where that pushes", duration=1.0, allowed=1e-7,
    ),
    Law(
        "stop_both", {"stop_both": 1.0, "stop_lower": 0.2, "stop_angle": 0.5, "stop_stiffness": 30.0}, (0.35, 1.5),
        lambda time: 0.35 + _bouncing((0.0, 1.5), 0.15, 30.0)(time), "k δ at either end: free flight, half a cosine in each",
        allowed=1e-7,
    ),
    Law(
        "play", {}, (0.0, 1.5), _bouncing((0.0, 1.5), 0.1, 30.0), "free within the play, half a cosine in the teeth",
        teeth=(0.1, 30.0, 0.0), allowed=1e-7,
    ),
)  # fmt: skip
