"""How each effect of the catalogue is concealed, written afresh from its physical definition, not from the catalogue's code.

A concealment draws what is not its strength (where a stop sits, which harmonic a motor cogs at), and turns a dimensionless
strength into parameters; ``plant`` then puts it into a scene. The visibility of the result is measured elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from harness.proof.rigs import Segment
from harness.proof.scene import FINE_STEP, Scene, Signal
from harness.proof.truth import DryFriction

Array = NDArray[np.float64]
Parameters = Mapping[str, float]
Draws = Mapping[str, float]


@dataclass(frozen=True)
class Concealment:
    """One effect as something to hide.

    site: "joint", "link", "channel" or "base".
    draw: (rng, segment, amplitude) -> what does not scale with the strength.
    parameters: (strength, draws, segment, amplitude) -> true parameters in SI; strength 1 is plainly visible in a clean recording.
    plant: (scene, segment index, parameters).
    needs_drive, needs_armature, needs_freedom: the rig must be driven, must have an armature, must not be driven.
    everywhere: acts on the rig as a whole, and is told of its first joint.
    joints: number of joints of the rigs it is tried on.
    stated: an effect that the nominal model states, of which this one is another form; ``parameters`` and ``plant`` are given its
        parameters too, among the draws and among their own.
    alone: no part of pairs and triples: it hides nothing else, and nothing else hides it.
    """

    effect: str
    site: str
    draw: Callable[[np.random.Generator, Segment, float], Draws]
    parameters: Callable[[float, Draws, Segment, float], dict[str, float]]
    plant: Callable[[Scene, int, Parameters], None]
    needs_drive: bool = False
    needs_armature: bool = False
    needs_freedom: bool = False
    everywhere: bool = False
    joints: tuple[int, ...] = (1, 2)
    stated: str = ""
    alone: bool = False


CONCEALMENTS: dict[str, Concealment] = {}


def _nothing(rng: np.random.Generator, segment: Segment, amplitude: float) -> Draws:
    return {}


def _add(
    effect: str, site: str, draw: Callable, parameters: Callable, plant: Callable, **options: Any
) -> None:  # fmt: skip
    CONCEALMENTS[effect] = Concealment(effect, site, draw, parameters, plant, **options)


def _joint_torque(scene: Scene, k: int, law: Callable[[float, float, float], float]) -> None:
    """Let a torque law (t, position, velocity) act at joint ``k``."""
    dof = scene.dof(scene.rig.joints[k])

    def torque(t: float, q: Array, v: Array) -> Array:
        force = np.zeros(len(v))
        force[dof] = law(t, q[dof], v[dof])
        return force

    scene.torques.append(torque)


def _rate(s: Segment) -> float:
    """Angular rate of the small swing of the segment alone [rad/s]."""
    return float(np.sqrt(s.gravity_moment / s.inertia_about_joint))


# --- joint dissipation ---------------------------------------------------------------------------------------------


def _viscous(scene: Scene, k: int, p: Parameters) -> None:
    _joint_torque(scene, k, lambda t, q, v: -p["coefficient"] * v)


_add(
    "viscous_damping", "joint", _nothing,
    lambda f, d, s, a: {"coefficient": 0.02 * f * s.inertia_about_joint * _rate(s)}, _viscous,
)  # fmt: skip


def _coulomb(scene: Scene, k: int, p: Parameters) -> None:
    scene.dry.append(DryFriction(scene.dof(scene.rig.joints[k]), lambda v, n, q: p["torque"], lambda n, q: p["torque"]))


_add("coulomb_friction", "joint", _nothing, lambda f, d, s, a: {"torque": 0.01 * f * s.gravity_moment}, _coulomb)


def _stribeck(scene: Scene, k: int, p: Parameters) -> None:
    fc, fs, vs = p["coulomb_torque"], p["static_torque"], p["stribeck_velocity"]
    scene.dry.append(
        DryFriction(
            scene.dof(scene.rig.joints[k]),
            lambda v, n, q: fc + (fs - fc) * float(np.exp(-((v / vs) ** 2))),
            lambda n, q: fs,
        )
    )


_add(
    "stribeck_friction", "joint",
    lambda rng, s, a: {"ratio": rng.uniform(1.6, 3.0), "velocity": rng.uniform(0.05, 0.3) * a * _rate(s)},
    lambda f, d, s, a: {
        "coulomb_torque": 0.01 * f * s.gravity_moment,
        "static_torque": 0.01 * f * d["ratio"] * s.gravity_moment,
        "stribeck_velocity": d["velocity"],
    },
    _stribeck,
)  # fmt: skip


def _load(scene: Scene, k: int, p: Parameters) -> None:
    scene.dry.append(
        DryFriction(
            scene.dof(scene.rig.joints[k]),
            lambda v, n, q: p["mu_radius"] * n,
            lambda n, q: p["mu_radius"] * n,
            loaded=True,
        )
    )


_add("load_dependent_friction", "joint", _nothing, lambda f, d, s, a: {"mu_radius": 0.01 * f * s.com}, _load)


def _drag(scene: Scene, k: int, p: Parameters) -> None:
    _joint_torque(scene, k, lambda t, q, v: -p["coefficient"] * v * abs(v))


_add("quadratic_drag", "joint", _nothing, lambda f, d, s, a: {"coefficient": 0.03 * f * s.inertia_about_joint}, _drag)


def _dahl(scene: Scene, k: int, p: Parameters) -> None:
    dof = scene.dof(scene.rig.joints[k])
    limit, stiffness = p["torque"], p["stiffness"]

    def rate(t: float, q: Array, v: Array, z: Array) -> Array:
        return np.array([stiffness * v[dof] * (1.0 - np.sign(v[dof]) * z[0] / limit)])

    def torque(t: float, q: Array, v: Array, z: Array) -> Array:
        force = np.zeros(len(v))
        force[dof] = -z[0]
        return force

    scene.states.append((1, rate, torque))


_add(
    "dahl_friction", "joint", lambda rng, s, a: {"reach": rng.uniform(0.05, 0.3) * a},
    lambda f, d, s, a: {
        "torque": 0.01 * f * s.gravity_moment, "stiffness": 0.01 * f * s.gravity_moment / d["reach"],
    },
    _dahl,
)  # fmt: skip


# --- joint stiffness and torque ------------------------------------------------------------------------------------


def _spring(scene: Scene, k: int, p: Parameters) -> None:
    _joint_torque(scene, k, lambda t, q, v: -p["stiffness"] * (q - p["rest_angle"]))


_add(
    "joint_stiffness", "joint", lambda rng, s, a: {"rest": rng.choice([0.0, rng.uniform(-0.5, 0.5)])},
    lambda f, d, s, a: {"stiffness": 0.2 * f * s.gravity_moment, "rest_angle": d["rest"]}, _spring,
)  # fmt: skip


def _cubic(scene: Scene, k: int, p: Parameters) -> None:
    _joint_torque(scene, k, lambda t, q, v: -p["stiffness"] * q**3)


_add("cubic_stiffness", "joint", _nothing, lambda f, d, s, a: {"stiffness": 0.1 * f * s.gravity_moment}, _cubic)


def _constant(scene: Scene, k: int, p: Parameters) -> None:
    _joint_torque(scene, k, lambda t, q, v: p["torque"])


_add(
    "constant_torque", "joint", lambda rng, s, a: {"sign": rng.choice([-1.0, 1.0])},
    lambda f, d, s, a: {"torque": 0.03 * f * d["sign"] * s.gravity_moment}, _constant,
)  # fmt: skip


def _cogging(scene: Scene, k: int, p: Parameters) -> None:
    _joint_torque(scene, k, lambda t, q, v: p["amplitude"] * float(np.sin(p["periods"] * q + p["phase"])))


_add(
    "cogging_torque", "joint",
    lambda rng, s, a: {"periods": float(rng.integers(6, 25)), "phase": rng.uniform(-np.pi, np.pi)},
    lambda f, d, s, a: {"amplitude": 0.03 * f * s.gravity_moment, "periods": d["periods"], "phase": d["phase"]}, _cogging,
)  # fmt: skip


def _stop(scene: Scene, k: int, p: Parameters) -> None:
    side = 1.0 if p["angle"] > 0 else -1.0

    def law(t: float, q: float, v: float) -> float:
        depth = side * (q - p["angle"])
        if depth <= 0.0:
            return 0.0
        return -side * max(p["stiffness"] * depth + p["damping"] * side * v, 0.0)

    _joint_torque(scene, k, law)


_add(
    "end_stop", "joint",
    lambda rng, s, a: {"angle": rng.choice([-1.0, 1.0]) * rng.uniform(0.4, 0.8) * a, "rigid": rng.uniform(0.3, 2.0)},
    lambda f, d, s, a: {
        "angle": d["angle"],
        "stiffness": 3.0 * f * d["rigid"] * s.gravity_moment,
        "damping": 0.1 * f * d["rigid"] * s.gravity_moment / _rate(s),
    },
    _stop,
)  # fmt: skip


def _axis(scene: Scene) -> str:
    return " ".join(repr(float(x)) for x in scene.rig.axis)


def _soft_joint(scene: Scene, k: int, p: Parameters) -> None:
    # The drive side keeps armature, damping and encoder; the link follows it through the spring.
    joint = scene.rig.joints[k]
    scene.inserts[k] = (
        f'<joint name="{joint}_inserted" type="hinge" axis="{_axis(scene)}" stiffness="{float(p["stiffness"])!r}" '
        f'damping="{float(p["damping"])!r}"/>'
    )


_add(
    "joint_flexibility", "joint", lambda rng, s, a: {"ratio": rng.uniform(0.01, 0.05)},
    lambda f, d, s, a: {
        "stiffness": 8.0 * s.gravity_moment / f,
        "damping": 2 * d["ratio"] * float(np.sqrt(8.0 * s.gravity_moment / f * s.inertia_about_joint)),
    },
    _soft_joint, needs_drive=True, needs_armature=True, joints=(1,),
)  # fmt: skip


def _play(scene: Scene, k: int, p: Parameters) -> None:
    joint, s = scene.rig.joints[k], scene.rig.segments[k]
    scene.inserts[k] = f'<joint name="{joint}_inserted" type="hinge" axis="{_axis(scene)}"/>'
    dof = scene.dof(joint) + 1
    half = p["gap"] / 2
    # Steel teeth: far stiffer than anything else in the rig, and they lose most of a blow's energy.
    rate = 2 * np.pi * 50.0
    stiffness = s.inertia_about_joint * rate**2
    damping = 2 * 0.4 * s.inertia_about_joint * rate

    def teeth(t: float, q: Array, v: Array) -> Array:
        force = np.zeros(len(v))
        depth = abs(q[dof]) - half
        if depth > 0.0:
            side = np.sign(q[dof])
            force[dof] = -side * max(stiffness * depth + damping * side * v[dof], 0.0)
        return force

    scene.torques.append(teeth)


_add(
    "backlash", "joint", _nothing, lambda f, d, s, a: {"gap": 0.05 * f}, _play,
    needs_drive=True, needs_armature=True, joints=(1,),
)  # fmt: skip


# Three hinges that stand for a uniform beam: they give as much under any moment that is at most quadratic along it, and the first
# frequency of a rod on a free hub, with up to twice its mass at the end, is within half a hundredth of the beam's.
HINGES = (0.127, 0.5, 0.873)
GIVE = (0.2995, 0.4010, 0.2995)


def _bend(scene: Scene, k: int, p: Parameters) -> None:
    joint = scene.rig.joints[k]
    rate = 2 * np.pi * p["frequency"]

    def elements(stiffness: float, damping: float) -> list[tuple[float, str]]:
        return [
            (at, f'<joint name="{joint}_bend{i}" type="hinge" axis="{_axis(scene)}" stiffness="{float(stiffness / give)!r}" '
             f'damping="{float(damping / give)!r}"/>')
            for i, (at, give) in enumerate(zip(HINGES, GIVE, strict=True))
        ]  # fmt: skip

    # With the hub free and gravity left out, what bends has the frequencies of (M⁻¹ restricted to the bends) times stiffness.
    scene.splits[k] = elements(0.0, 0.0)
    truth = scene.truth()
    mujoco.mj_forward(truth.model, truth.data)
    mass = np.zeros((truth.n, truth.n))
    mujoco.mj_fullM(truth.model, truth.data, mass)
    bends = [truth.dof[f"{joint}_bend{i}"] for i in range(len(HINGES))]
    mobility = np.linalg.inv(mass)[np.ix_(bends, bends)]
    softest = float(np.linalg.eigvals(mobility / np.array(GIVE)).real.min())
    stiffness = rate**2 / softest
    scene.splits[k] = elements(stiffness, 2 * p["damping_ratio"] * stiffness / rate)


_add(
    "link_flexibility", "link", lambda rng, s, a: {"ratio": rng.uniform(0.005, 0.03)},
    lambda f, d, s, a: {"frequency": 4.0 * _rate(s) / (2 * np.pi) / np.sqrt(f), "damping_ratio": d["ratio"]},
    _bend, needs_drive=True, joints=(1,),
)  # fmt: skip


# --- inertia and geometry ------------------------------------------------------------------------------------------


def _payload(scene: Scene, k: int, p: Parameters) -> None:
    s, extra = scene.rig.segments[k], p["mass"]
    mass = s.mass + extra
    com = (s.mass * s.com + extra * s.length) / mass
    inertia = s.inertia + s.mass * (com - s.com) ** 2 + extra * (s.length - com) ** 2
    scene.edit_segment(k, mass=mass, com=com, inertia=inertia)


_add("payload_mass", "link", _nothing, lambda f, d, s, a: {"mass": 0.3 * f * s.mass}, _payload)


def _inertia(scene: Scene, k: int, p: Parameters) -> None:
    scene.edit_segment(k, armature=scene.rig.segments[k].armature + p["inertia"])


_add("added_inertia", "joint", _nothing, lambda f, d, s, a: {"inertia": 0.2 * f * s.inertia_about_joint}, _inertia)


def _com(scene: Scene, k: int, p: Parameters) -> None:
    scene.edit_segment(k, com=scene.rig.segments[k].com + p["offset"])


_add(
    "com_offset", "link", lambda rng, s, a: {"sign": rng.choice([-1.0, 1.0])},
    lambda f, d, s, a: {"offset": 0.15 * f * d["sign"] * s.com}, _com,
)  # fmt: skip


# --- base ----------------------------------------------------------------------------------------------------------


def _tilt(scene: Scene, k: int, p: Parameters) -> None:
    axis = np.array(scene.rig.axis)
    c, s = np.cos(p["angle"]), np.sin(p["angle"])
    # A base turned by +angle about the joint axis sees gravity turned by -angle.
    down = np.array([0.0, 0.0, -scene.rig.gravity])
    turned = down * c - np.cross(axis, down) * s
    scene.gravity = lambda t: turned


_add(
    "base_tilt", "base", lambda rng, s, a: {"sign": rng.choice([-1.0, 1.0])},
    lambda f, d, s, a: {"angle": 0.03 * f * d["sign"]}, _tilt,
)  # fmt: skip


def _horizontal(scene: Scene) -> Array:
    """Horizontal direction in the plane of motion along which a positive first joint moves the hanging tip."""
    return np.cross(np.array(scene.rig.axis), np.array([0.0, 0.0, -1.0]))


def _shake(scene: Scene, k: int, p: Parameters) -> None:
    along = _horizontal(scene)
    down = np.array([0.0, 0.0, -scene.rig.gravity])

    def gravity(t: float) -> Array:
        return down - along * p["amplitude"] * np.sin(2 * np.pi * p["frequency"] * t + p["phase"])

    scene.gravity = gravity


_add(
    "base_excitation", "base",
    lambda rng, s, a: {"frequency": rng.uniform(0.4, 3.0) * _rate(s) / (2 * np.pi), "phase": rng.uniform(-np.pi, np.pi)},
    lambda f, d, s, a: {"amplitude": 0.1 * f, "frequency": d["frequency"], "phase": d["phase"]}, _shake, joints=(1,),
)  # fmt: skip


def _loose_base(scene: Scene, k: int, p: Parameters) -> None:
    along = " ".join(repr(float(x)) for x in _horizontal(scene))
    scene.base = (
        f'<inertial pos="0 0 0" mass="{p["mass"]!r}" diaginertia="1e-3 1e-3 1e-3"/>'
        f'<joint name="base_slide" type="slide" axis="{along}" stiffness="{p["stiffness"]!r}" damping="{p["damping"]!r}"/>'
    )


_add(
    "base_compliance", "base",
    lambda rng, s, a: {"mass": rng.uniform(1.0, 5.0) * s.mass, "ratio": rng.uniform(0.02, 0.1)},
    lambda f, d, s, a: {
        "stiffness": s.mass * 9.81 / s.com / (0.1 * f),
        "mass": d["mass"],
        "damping": 2 * d["ratio"] * float(np.sqrt(s.mass * 9.81 / s.com / (0.1 * f) * d["mass"])),
    },
    _loose_base,
)  # fmt: skip


# --- sensors -------------------------------------------------------------------------------------------------------


def _sense(scene: Scene, k: int, stage: Callable[[Signal], Signal]) -> None:
    scene.signal.setdefault(scene.rig.joints[k], []).append(stage)


def _signed(rng: np.random.Generator, s: Segment, a: float) -> Draws:
    return {"sign": rng.choice([-1.0, 1.0])}


_add(
    "sensor_offset", "channel", _signed, lambda f, d, s, a: {"offset": 0.03 * f * d["sign"]},
    lambda scene, k, p: _sense(scene, k, lambda g: lambda t: g(t) + p["offset"]),
)  # fmt: skip
_add(
    "sensor_gain", "channel", _signed, lambda f, d, s, a: {"gain": 1.0 + 0.05 * f * d["sign"]},
    lambda scene, k, p: _sense(scene, k, lambda g: lambda t: p["gain"] * g(t)),
)  # fmt: skip
_add(
    "sensor_delay", "channel", _nothing, lambda f, d, s, a: {"delay": 0.05 * f / _rate(s)},
    lambda scene, k, p: _sense(scene, k, lambda g: lambda t: g(np.maximum(t - p["delay"], 0.0))),
)  # fmt: skip
_add(
    "sensor_nonlinearity", "channel", lambda rng, s, a: {"mix": rng.uniform(-1, 1), "sign": rng.choice([-1.0, 1.0])},
    lambda f, d, s, a: {"quadratic": 0.03 * f * d["mix"] / a, "cubic": 0.05 * f * d["sign"] / a**2},
    lambda scene, k, p: _sense(
        scene, k, lambda g: lambda t: g(t) + p["quadratic"] * g(t) ** 2 + p["cubic"] * g(t) ** 3
    ),
)  # fmt: skip
_add(
    "sensor_drift", "channel", _signed, lambda f, d, s, a: {"rate": 0.003 * f * d["sign"]},
    lambda scene, k, p: _sense(scene, k, lambda g: lambda t: g(t) + p["rate"] * t),
)  # fmt: skip
_add(
    "sensor_saturation", "channel", _nothing, lambda f, d, s, a: {"limit": a * float(np.exp(-0.2 * f))},
    lambda scene, k, p: _sense(scene, k, lambda g: lambda t: np.clip(g(t), -p["limit"], p["limit"])),
)  # fmt: skip


def filtered(g: Signal, cutoff: float, high: bool) -> Signal:
    """First-order filter of straight lines between the points of the fine grid, exact for them at any cutoff.

    A low-pass has settled on the first value when the recording starts; a high-pass on zero, the hanging link.
    """
    grid = np.arange(0.0, 200.0, FINE_STEP)
    grid = grid[grid <= getattr(g, "x", np.array([60.0]))[-1]]
    x = g(grid)
    # y' = ω (x − y) over a step h: y₁ = a y₀ + b₀ x₀ + b₁ x₁ with a = exp(−ω h).
    turn = 2.0 * np.pi * cutoff * FINE_STEP
    a, mean = np.exp(-turn), -np.expm1(-turn) / turn
    rest = 0.0 if high else x[0]
    low = lfilter([1.0 - mean, mean - a], [1.0, -a], x - rest, zi=[(mean - 1.0) * (x[0] - rest)])[0] + rest
    y = x - low if high else low
    return lambda t: np.interp(t, grid, y)


_add(
    "sensor_lowpass", "channel", _nothing, lambda f, d, s, a: {"cutoff": _rate(s) / (2 * np.pi) / (0.1 * f)},
    lambda scene, k, p: _sense(scene, k, lambda g: filtered(g, p["cutoff"], high=False)),
)  # fmt: skip
_add(
    "sensor_highpass", "channel", _nothing, lambda f, d, s, a: {"cutoff": 0.03 * f * _rate(s) / (2 * np.pi)},
    lambda scene, k, p: _sense(scene, k, lambda g: filtered(g, p["cutoff"], high=True)),
)  # fmt: skip


def _skew(scene: Scene, k: int, p: Parameters) -> None:
    # The clock writes t = factor · true time: what it calls t happened at t / factor, and so was the effort it wrote down.
    factor = p["factor"]
    for joint in scene.rig.joints:
        scene.signal.setdefault(joint, []).append(lambda g: lambda t: g(t / factor))
    scene.command.append(lambda u: lambda t: u(factor * t))


_add(
    "clock_skew", "channel", _signed, lambda f, d, s, a: {"factor": 1.0 + 0.03 * min(f, 6.0) * d["sign"]}, _skew,
    everywhere=True,
)  # fmt: skip


# --- inputs --------------------------------------------------------------------------------------------------------


_add(
    "actuator_gain", "joint", _signed, lambda f, d, s, a: {"gain": 1.0 + 0.2 * f * d["sign"]},
    lambda scene, k, p: scene.command.append(lambda u: lambda t: p["gain"] * u(t)), needs_drive=True,
)  # fmt: skip
_add(
    "actuator_delay", "joint", _nothing, lambda f, d, s, a: {"delay": 0.1 * f / _rate(s)},
    lambda scene, k, p: scene.command.append(lambda u: lambda t: np.where(t >= p["delay"], u(t - p["delay"]), 0.0)),
    needs_drive=True,
)  # fmt: skip


def _deadzone(scene: Scene, k: int, p: Parameters) -> None:
    w = p["width"]
    scene.command.append(lambda u: lambda t: np.sign(u(t)) * np.maximum(np.abs(u(t)) - w, 0.0))


_add("actuator_deadzone", "joint", _nothing, lambda f, d, s, a: {"width": 0.03 * f * s.gravity_moment}, _deadzone,
     needs_drive=True)  # fmt: skip


# Recordings are driven by four waves of up to 0.12 of the weight's torque each (``draw``), which seldom add up.
_add(
    "actuator_saturation", "joint", _nothing,
    lambda f, d, s, a: {"limit": 0.2 * float(np.exp(-0.2 * f)) * s.gravity_moment},
    lambda scene, k, p: scene.command.append(lambda u: lambda t: np.clip(u(t), -p["limit"], p["limit"])), needs_drive=True,
)  # fmt: skip


def _hum(scene: Scene, k: int, p: Parameters) -> None:
    def stage(g: Signal) -> Signal:
        # Mains know nothing of when a recording begins: far digits of where it does stand for the phase.
        phase = 1e5 * float(g(np.zeros(1))[0])
        return lambda t: g(t) + p["amplitude"] * np.sin(2 * np.pi * p["frequency"] * t + phase)

    _sense(scene, k, stage)


# --- other forms of what the model states --------------------------------------------------------------------------


def _creep(scene: Scene, k: int, p: Parameters) -> None:
    _joint_torque(scene, k, lambda t, q, v: -p["torque"] * float(np.tanh(v / p["velocity"])))


_add(
    "friction_creep", "joint", _nothing, lambda f, d, s, a: {"velocity": 0.03 * f * a * _rate(s)}, _creep,
    stated="coulomb_friction",
)  # fmt: skip


def _constrain(scene: Scene, k: int, law: Callable[[float, float, float, float], float]) -> None:
    scene.constraint = (scene.dof(scene.rig.joints[k]), law)


def _soft_friction(scene: Scene, k: int, p: Parameters) -> None:
    # As MuJoCo's documentation states the friction loss of a joint: the force that brings it to rest by the time constant against a
    # regularizing inertia, cut off at the loss.
    def law(q: float, v: float, free: float, mobility: float) -> float:
        wanted = -(free + v / p["time"]) / (mobility + 1.0 / p["inertia"])
        return float(np.clip(wanted, -p["torque"], p["torque"]))

    _constrain(scene, k, law)


_add(
    "friction_softness", "joint", lambda rng, s, a: {"ratio": rng.uniform(2.0, 20.0)},
    lambda f, d, s, a: {"time": 0.02 * f / _rate(s), "inertia": d["ratio"] * s.inertia_about_joint}, _soft_friction,
    stated="coulomb_friction",
)  # fmt: skip


def _heavy_stop(scene: Scene, k: int, p: Parameters) -> None:
    side = 1.0 if p["angle"] > 0 else -1.0

    def law(q: float, v: float, free: float, mobility: float) -> float:
        depth = side * (q - p["angle"])
        if depth <= 0.0:
            return 0.0
        wanted = p["stiffness"] * depth + p["damping"] * side * v + p["inertia"] * side * free
        return -side * max(wanted / (1.0 + p["inertia"] * mobility), 0.0)

    _constrain(scene, k, law)


_add(
    "stop_inertia", "joint", _nothing, lambda f, d, s, a: {"inertia": 2.0 * f * s.inertia_about_joint}, _heavy_stop,
    stated="end_stop",
)  # fmt: skip

# Last, so that what a seed draws of the others stays as it was. Mains, or what they look like to slow sampling.
_add(
    "sensor_hum", "channel", lambda rng, s, a: {"frequency": rng.uniform(15.0, 45.0)},
    lambda f, d, s, a: {"amplitude": 0.003 * f * a, "frequency": d["frequency"]}, _hum, alone=True,
)  # fmt: skip


def _beside(scene: Scene, k: int, p: Parameters) -> None:
    scene.edit_segment(k, side=scene.rig.segments[k].side + p["offset"])


_add(
    "com_side_offset", "link", _signed, lambda f, d, s, a: {"offset": 0.05 * f * d["sign"] * s.com}, _beside,
)  # fmt: skip


def _zeros(scene: Scene, k: int, p: Parameters) -> None:
    scene.zeros[scene.rig.joints[k]] = [p[f"zero_{run}"] for run in range(len(scene.runs))]


def _spread(rng: np.random.Generator, s: Segment, a: float) -> Draws:
    # Apart from one another, or one offset would be all there is.
    values = rng.permutation([-1.0, rng.uniform(-0.5, 0.5), 1.0])
    return {f"zero_{run}": float(value) for run, value in enumerate(values)}


_add(
    "sensor_zero", "channel", _spread, lambda f, d, s, a: {name: 0.03 * f * value for name, value in d.items()}, _zeros,
)  # fmt: skip


def _uneven(scene: Scene, k: int, p: Parameters) -> None:
    _sense(scene, k, lambda g: lambda t: g(t) + p["amplitude"] * np.sin(p["periods"] * g(t) + p["phase"]))


_add(
    "encoder_interpolation", "channel",
    lambda rng, s, a: {
        "periods": float(rng.choice([1.0, float(rng.integers(2, 65))])), "phase": rng.uniform(-np.pi, np.pi),
    },
    lambda f, d, s, a: {"amplitude": 0.03 * f / np.sqrt(d["periods"]), "periods": d["periods"], "phase": d["phase"]},
    _uneven,
)  # fmt: skip


def _hold(scene: Scene, k: int, p: Parameters) -> None:
    # The hand holds what the release state is until it lets go.
    for joint in scene.rig.joints:
        scene.signal.setdefault(joint, []).insert(0, lambda g: lambda t: g(np.maximum(t - p["delay"], 0.0)))


_add(
    "late_release", "channel", _nothing, lambda f, d, s, a: {"delay": 0.1 * f / _rate(s)}, _hold,
    needs_freedom=True, everywhere=True,
)  # fmt: skip
