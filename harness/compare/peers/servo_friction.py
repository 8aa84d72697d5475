"""The ladder of friction models of BAM (Better Actuator Models), fitted to a servo with an arm, as its authors fit it.

Duclusaud, Passault, Padois, Daney, "Extended friction models for the physics simulation of servo actuators" (arXiv
2410.08650), and their code, github.com/Rhoban/bam: ``bam/model.py`` for the laws, ``bam/simulate.py`` for how they act,
``bam/fit.py`` for the fit. It is for one joint.

- M1 Coulomb and viscous, M2 with Stribeck's effect, M3 load-dependent, M4 both, M5 with loads of motor and arm apart,
  M6 with a quadratic term that acts where the two oppose one another. Where no motor acts M5 and M6 are M4.
- Friction takes what stops the joint within a step, and no more than its budget; the step is semi-implicit. Theirs moves the
  angle by a half of acceleration times step squared more, beyond the new velocity: at a millisecond that takes 5 % off a
  frictionless swing of a second in six, which friction hides on servos and which would be friction that is not there on swings.
  It is left out.
- Mean absolute error of positions over all recordings, by CMA-ES with restarts (theirs, of the package that Optuna's
  sampler wraps), inertia and an offset of the angle free beside the laws. Their bounds (``bam/model.py``) are those of servos;
  here they are the same shares of the rig's own torque. Theirs begins in the middle of the bounds; from a twentieth of them or
  less, as here, lightly damped swings are reached with fewer tries.

Beyond what they do: steps of a millisecond at most, first states free (their rigs begin at rest), steps below M1
(none, viscous alone, Coulomb alone), without which "nothing is missing" could not be said, efforts held from sample to sample
or not, whichever M1 fits better (their firmware holds them), and a second search that
begins at the best fit of the steps below, of which each is a special case: theirs tries a hundred thousand times, and with
the three thousand here M3 ended up to 1.7 times above M1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numba
import numpy as np
from numpy.typing import NDArray

from harness.compare.peers.runs import Run, heldout_error, pushed

Array = NDArray[np.float64]

NAMES = (
    "inertia", "offset", "friction_base", "friction_viscous", "friction_stribeck", "dtheta_stribeck", "alpha",
    "load_friction_base", "load_friction_stribeck", "load_friction_motor", "load_friction_motor_stribeck",
    "load_friction_motor_quad", "load_friction_external_quad",
)  # fmt: skip
(
    INERTIA,
    OFFSET,
    BASE,
    VISCOUS,
    STRIBECK,
    SPEED,
    ALPHA,
    LOAD,
    LOAD_STRIBECK,
    MOTOR,
    MOTOR_STRIBECK,
    QUAD,
    QUAD_EXTERNAL,
) = range(13)
_M2 = ("friction_stribeck", "dtheta_stribeck", "alpha")
_M4 = (*_M2, "load_friction_base", "load_friction_stribeck")
_M5 = (*_M4, "load_friction_motor", "load_friction_motor_stribeck")
LADDER: Mapping[str, tuple[str, ...]] = {
    "none": (),
    "viscous": ("friction_viscous",),
    "coulomb": ("friction_base",),
    "m1": ("friction_base", "friction_viscous"),
    "m2": ("friction_base", "friction_viscous", *_M2),
    "m3": ("friction_base", "friction_viscous", "load_friction_base"),
    "m4": ("friction_base", "friction_viscous", *_M4),
    "m5": ("friction_base", "friction_viscous", *_M5),
    "m6": ("friction_base", "friction_viscous", *_M5, "load_friction_motor_quad", "load_friction_external_quad"),
}
DIRECTIONAL = ("m5", "m6")  # the loads of motor and arm apart
MOTOR_FOR = {"load_friction_base": "load_friction_motor", "load_friction_stribeck": "load_friction_motor_stribeck"}
STEP = 1e-3  # s at most
EVALUATIONS = 3000  # of a fit from either start; the score has come to rest before
RESTARTS = 2
AS_GOOD = 1.02  # error held out, times the best: where a lower step of the ladder does as well


@dataclass(frozen=True)
class Arm:
    """What hangs on the servo: inertia about the axis [kg·m²], and gravity's torque a cos q + b sin q [N·m]."""

    inertia: float
    cosine: float
    sine: float

    @property
    def pull(self) -> float:
        """The largest torque by gravity [N·m]."""
        return float(np.hypot(self.cosine, self.sine))


@numba.njit(cache=True)
def _swing(
    q: float, v: float, time: Array, tau: Array, inertia: float, cosine: float, sine: float, p: Array, directional: bool, out: Array
) -> None:  # fmt: skip
    inertia = inertia * p[INERTIA]
    for t in range(len(time)):
        out[t] = q
        if t + 1 == len(time):
            break
        m = max(1, int(np.ceil((time[t + 1] - time[t]) / STEP - 1e-6)))
        h = (time[t + 1] - time[t]) / m
        for _ in range(m):
            angle = q - p[OFFSET]
            external = -(cosine * np.cos(angle) + sine * np.sin(angle))
            motor = tau[t]
            if directional:
                load = abs(external * p[LOAD] - motor * p[MOTOR])
                load_slow = abs(external * p[LOAD_STRIBECK] - motor * p[MOTOR_STRIBECK])
            else:
                load = p[LOAD] * abs(external - motor)
                load_slow = p[LOAD_STRIBECK] * abs(external - motor)
            slow = np.exp(-((abs(v) / p[SPEED]) ** p[ALPHA])) if p[SPEED] > 0.0 else 0.0
            budget = p[BASE] + load + slow * (p[STRIBECK] + load_slow) + p[VISCOUS] * abs(v)
            if external * motor < 0.0:
                if abs(external) < abs(motor):
                    budget += slow * p[QUAD_EXTERNAL] * external**2
                else:
                    budget += slow * p[QUAD] * motor**2
            net = motor + external
            stopping = inertia / h * v + net
            net -= np.sign(stopping) * min(abs(stopping), budget)
            acceleration = net / inertia
            v = min(max(v + acceleration * h, -100.0), 100.0)
            q += v * h


def swing_of_one_joint(
    state: Array, time: Array, tau: Array, inertia: float, cosine: float, sine: float, viscous: float, dry: float
) -> Array:
    """Positions (T,) of one joint under gravity a cos q + b sin q, a known force (T,), viscous and dry friction that sticks."""
    p = np.zeros(len(NAMES))
    p[[INERTIA, ALPHA, BASE, VISCOUS]] = 1.0, 1.0, max(dry, 0.0), max(viscous, 0.0)
    out = np.empty(len(time))
    _swing(state[0], state[1], time, np.ascontiguousarray(tau), inertia, cosine, sine, p, False, out)
    return out


@dataclass(frozen=True)
class Servo:
    """A fit. values: by parameter, SI; model: its step on the ladder. mae: mean absolute error [rad]; heldout: root
    mean square over the recordings that the step was chosen on, their first states fitted [rad];
    held: whether efforts stay from sample to sample."""

    arm: Arm
    model: str
    values: Mapping[str, float]
    mae: float
    first: Array
    held: bool = True
    heldout: float = float("nan")

    def free_run(self, state: Array, time: Array, tau: Array | None) -> Array:
        """Positions (T, 1) from a state as it reads (2,)."""
        p = np.array([self.values[name] for name in NAMES])
        out = np.empty(len(time))
        directional = self.model in DIRECTIONAL
        effort = pushed(time, tau, self.held)
        _swing(state[0], state[1], time, effort, self.arm.inertia, self.arm.cosine, self.arm.sine, p, directional, out)
        return out[:, None]


def fit_servo(
    arm: Arm, runs: Sequence[Run], model: str, *, below: Sequence[Servo] = (), seed: int = 0, held: bool = True
) -> Servo:
    """One step of the ladder fitted to recordings of one joint.

    held: whether efforts stay from sample to sample. below: fits of steps that are special cases of it, to the same runs; it is
    no worse than they are.
    Raises ImportError where the package ``cmaes`` is not installed.
    """
    from cmaes import CMA

    runs = [run.acting(held) for run in runs]
    freed = ("inertia", "offset", *LADDER[model])
    bounds = _bounds(arm, runs)
    firsts = [run.first_state() for run in runs]
    spread = max(float(np.std(np.concatenate([run.positions for run in runs]))), 1e-9)
    speed = max(float(np.max(np.abs(np.gradient(run.positions[:, 0], run.time)))) for run in runs)
    low = np.array([bounds[name][0] for name in freed] + [-0.05 * spread, -0.1 * speed] * len(runs))
    high = np.array([bounds[name][1] for name in freed] + [0.05 * spread, 0.1 * speed] * len(runs))
    directional = model in DIRECTIONAL
    values = dict.fromkeys(NAMES, 0.0) | {"inertia": 1.0, "alpha": 1.0}

    def numbers(z: Array) -> tuple[Array, Array]:
        x = low + z * (high - low)
        own = {**values, **dict(zip(freed, x, strict=False))}
        return np.array([own[name] for name in NAMES]), x[len(freed) :].reshape(len(runs), 2)

    def error(z: Array) -> float:
        p, states = numbers(z)
        total, count = 0.0, 0
        for run, first, moved in zip(runs, firsts, states, strict=True):
            out = np.empty(len(run.time))
            pushed = np.zeros(len(run.time)) if run.efforts is None else np.ascontiguousarray(run.efforts[:, 0])
            q, v = first + moved
            _swing(q, v, run.time, pushed, arm.inertia, arm.cosine, arm.sine, p, directional, out)
            total += float(np.sum(np.abs(out - run.positions[:, 0])))
            count += len(out)
        return total / count

    begin = np.array([_start(name, bounds) for name in freed])
    nominal = np.clip((begin - low[: len(freed)]) / (high - low)[: len(freed)], 0.0, 1.0)
    start = np.concatenate([nominal, np.full(2 * len(runs), 0.5)])
    box = np.tile([0.0, 1.0], (len(low), 1))
    best, least = start, error(start)
    for restart in range(RESTARTS):
        for known in below if restart else ():
            own = dict(known.values)
            if directional and known.model not in DIRECTIONAL:  # there the load of motor and arm is one
                own |= {MOTOR_FOR[name]: own[name] for name in MOTOR_FOR}
            z = np.concatenate([[own[name] for name in freed], np.ravel(known.first)])
            z = np.clip((z - low) / (high - low), 0.0, 1.0)
            value = error(z)
            if value < least:
                best, least = z, value
        search = CMA(mean=np.clip(best, 0.01, 0.99), sigma=(0.1, 0.02)[restart % 2], bounds=box, seed=seed + restart)
        for _ in range(EVALUATIONS // search.population_size):
            told = []
            for _ in range(search.population_size):
                z = search.ask()
                value = error(z)
                told.append((z, value))
                if value < least:
                    best, least = z, value
            search.tell(told)
            if search.should_stop():
                break
    p, first = numbers(best)
    return Servo(arm, model, dict(zip(NAMES, map(float, p), strict=True)), least, first, held)


def climb(arm: Arm, train: Sequence[Run], heldout: Sequence[Run]) -> tuple[Servo, dict[str, float]]:
    """Every step of the ladder fitted, and the lowest that predicts the recordings held out as well as the best one
    does.

    Returns it and each step's error held out [rad]. M5 and M6 are left out where no motor acts, as they are M4 there.
    """
    driven = any(run.driven for run in train)
    steps = [model for model in LADDER if driven or model not in DIRECTIONAL]
    fits: dict[str, Servo] = {}
    held = not driven or min((fit_servo(arm, train, "m1", held=way) for way in (True, False)), key=lambda f: f.mae).held
    for model in steps:
        below = [fit for m, fit in fits.items() if set(LADDER[m]) < set(LADDER[model])]
        fits[model] = fit_servo(arm, train, model, below=below, held=held)
    errors = {model: heldout_error(fits[model].free_run, heldout) for model in steps}
    enough = AS_GOOD * min(errors.values())
    chosen = min((m for m in steps if errors[m] <= enough), key=lambda m: (len(LADDER[m]), errors[m]))
    found = fits[chosen]
    return replace(found, heldout=errors[chosen]), errors


def _bounds(arm: Arm, runs: Sequence[Run]) -> dict[str, tuple[float, float]]:
    """Theirs, in shares of the torque that acts: they were chosen for servos with arms of about a newton metre.

    ``Model.__init__`` and ``set_actuator`` in ``bam/model.py``; of the inertia they free the rotor's within bounds of each servo.
    """
    pushes = [float(np.max(np.abs(run.efforts))) for run in runs if run.efforts is not None]
    torque = max(arm.pull, *pushes, 1e-12)
    return {
        "inertia": (0.5, 3.0), "offset": (-0.1, 0.1), "friction_base": (0.0, 0.2 * torque),
        "friction_viscous": (0.0, 1.0 * torque), "friction_stribeck": (0.0, 0.2 * torque), "dtheta_stribeck": (0.1, 3.0),
        "alpha": (1.0, 10.0), "load_friction_base": (0.0, 0.5), "load_friction_stribeck": (0.0, 1.0),
        "load_friction_motor": (0.0, 0.5), "load_friction_motor_stribeck": (0.0, 1.0),
        "load_friction_motor_quad": (0.0, 0.01 / torque), "load_friction_external_quad": (0.0, 0.01 / torque),
    }  # fmt: skip


def _start(name: str, bounds: Mapping[str, tuple[float, float]]) -> float:
    if name == "inertia":
        return 1.0
    if name == "offset":
        return 0.0
    low, high = bounds[name]
    return low + (0.01 if name == "friction_viscous" else 0.05) * (high - low)
