"""Flexible rigs: what is concealed in them is simulated by Exudyn's ANCF cable elements.

A strip of spring steel hangs on a free hub; pivot angle and tip deflection are recorded. The nominal model keeps three
modes (one where a further mode is concealed); the truth is a finite-element beam that knows no modes at all.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import tomli_w
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from harness.engines.exudyn_ancf import Ancf
from harness.proof.draw import Case
from harness.proof.model_file import model_file
from harness.proof.scene import Planted, Run, Sensor
from harness.proof.visibility import whiten
from harness.system import System, load

Array = NDArray[np.float64]

# Twelve elements at this step are within 0.11 % RMS of the peak deflection of twenty-four at 2e-5 s over 3 s, joint angles
# within 1e-5 rad RMS: what they are off by cannot be told from thousands of samples with the noise that is drawn.
ELEMENTS, STEP = 12, 5e-5
DEFLECTION_NOISE = (0.02, 0.06)  # share of the peak deflection
EFFECTS = (
    "flexural_rigidity", "modal_damping", "higher_mode", "geometric_stiffening", "payload_mass", "viscous_damping",
    "sensor_gain",
)  # fmt: skip


@dataclass(frozen=True)
class Strip:
    """A flexible pendulum's data: SI; ``modes`` and ``stiffening`` are what its model file says."""

    length: float
    width: float
    thickness: float
    density: float
    modulus: float
    armature: float
    damping: float
    material_damping: float
    payload: float
    modes: int
    stiffening: bool
    tolerance: float

    @property
    def joints(self) -> tuple[str, ...]:
        return ("pivot",)

    def toml(self) -> str:
        """The strip as a model file."""
        link = {
            "name": "strip",
            "length": self.length,
            "direction": [0.0, 0.0, -1.0],
            "bending": [1.0, 0.0, 0.0],
            "section": {"width": self.width, "thickness": self.thickness},
            "material": {"youngs_modulus": self.modulus, "density": self.density, "damping": self.material_damping},
            "modes": self.modes,
            "geometric_stiffening": self.stiffening,
            "payload": self.payload,
        }
        joint = {
            "name": "pivot", "type": "continuous", "parent": "base", "child": "strip", "axis": [0.0, 1.0, 0.0],
            "armature": self.armature, "damping": self.damping,
        }  # fmt: skip
        return tomli_w.dumps(
            {
                "name": "strip",
                "gravity": [0.0, 0.0, -9.81],
                "tolerance": self.tolerance,
                "joint": [joint],
                "link": [link],
            }
        )

    def system(self) -> System:
        with model_file(self.toml()) as path:
            return load(path)


@dataclass(frozen=True)
class StripScene:
    """A strip, its releases, its sensors; ``gain`` acts on the deflection's channel."""

    strip: Strip
    runs: tuple[Run, ...]
    sensor: Sensor
    deflection_std: float
    gain: float = 1.0
    cache: dict[int, dict[str, CubicSpline]] = field(default_factory=dict, compare=False)

    def std(self, column: str) -> float:
        """White noise of a channel [its unit]."""
        return self.deflection_std if column.endswith("deflection") else self.sensor.std

    def record(self, index: int, instants: Array | None = None) -> dict[str, Array]:
        """Noise-free samples of one run."""
        run = self.runs[index]
        if instants is None:
            instants = np.arange(0.0, run.duration, 1.0 / self.sensor.rate)
        if index not in self.cache:
            system = self.strip.system()
            model = Ancf(elements=ELEMENTS).build(system)
            n = len(system.coordinate_names)
            grid = np.arange(0.0, run.duration + 2e-3, 1e-3)
            start, rest = np.zeros(n), np.zeros(n)
            start[0] = run.q0[0]
            motion = model.simulate(start, rest, grid, step=STEP)
            self.cache[index] = {
                "pivot.position": CubicSpline(grid, motion.position[:, 0]),
                "strip.tip_deflection": CubicSpline(grid, motion.channels["strip.tip_deflection"]),
            }
        dense = self.cache[index]
        return {
            "time": instants,
            "pivot.position": dense["pivot.position"](instants),
            "strip.tip_deflection": self.gain * dense["strip.tip_deflection"](instants),
        }


def _whitened(scene: StripScene) -> Array:
    rows = []
    for index in range(len(scene.runs)):
        for column, values in scene.record(index).items():
            if column != "time":
                rows.append(whiten(values, Sensor(scene.sensor.rate, scene.std(column))))
    return np.concatenate(rows)


def draw_flexible(kind: str, seed: int, index: int, effect: str = "") -> Case:
    """One flexible case: kind "clean" or "single"; the visibility of its effect is not projected off the nuisances.

    The finite-element truth costs seconds a run, so its sensitivities are not computed; visibility here is the plain
    distance that the effect moves the recording, in noise, and effects are drawn strong.
    """
    rng = np.random.default_rng([seed, index, 77])
    effect = effect if kind == "single" else ""
    tolerance = float(rng.choice([0.005, 0.01]))
    length = float(rng.uniform(0.25, 0.4))
    strip = Strip(
        length=length,
        width=float(rng.uniform(0.018, 0.03)),
        thickness=float(rng.uniform(0.0008, 0.0012)),
        density=7850.0,
        modulus=2.0e11,
        armature=float(rng.uniform(1e-5, 5e-5)),
        damping=float(rng.choice([0.0, 1e-4])),
        material_damping=float(rng.choice([0.0, 2e-5])) if effect != "modal_damping" else 0.0,
        payload=float(rng.choice([0.0, 0.01])) if effect != "payload_mass" else 0.0,
        modes=1 if effect == "higher_mode" else 3,
        stiffening=effect != "geometric_stiffening",
        tolerance=tolerance,
    )

    def off() -> float:
        return 1.0 + tolerance * float(np.clip(rng.normal(), -2.0, 2.0))

    true = dict(strip.__dict__)
    for name in ("length", "density", "modulus", "armature"):
        true[name] *= off()
    base = Strip(**{**true, "modes": 3})
    runs = tuple(Run((float(a),), (0.0,), 3.0) for a in rng.uniform(0.9, 1.6, 2) * rng.choice([-1.0, 1.0], 2))
    sensor = Sensor(rate=float(rng.choice([500.0, 1000.0])), std=float(rng.uniform(3e-4, 1e-3)))
    planted: list[Planted] = []
    gain = 1.0
    if effect == "flexural_rigidity":
        factor = 1.0 + float(rng.choice([-1.0, 1.0])) * float(rng.uniform(0.06, 0.3))
        true["modulus"] *= factor
        planted.append(Planted(effect, "strip", {"factor": factor}))
    elif effect == "modal_damping":
        # Kelvin-Voigt damping gives the first mode, near 37 Hz here, the ratio η ω / 2.
        eta = float(rng.uniform(4e-5, 2e-4))
        true["material_damping"] = eta
        planted.append(Planted(effect, "strip", {}))
    elif effect in ("higher_mode", "geometric_stiffening"):
        true["stiffening"] = True
        planted.append(Planted(effect, "strip", {}))
    elif effect == "payload_mass":
        mass = float(rng.uniform(0.1, 0.4)) * strip.density * strip.width * strip.thickness * length
        true["payload"] = mass
        planted.append(Planted(effect, "strip", {"mass": mass}))
    elif effect == "viscous_damping":
        extra = float(rng.uniform(3e-4, 2e-3))
        true["damping"] += extra
        planted.append(Planted(effect, "pivot", {"coefficient": extra}))
    elif effect == "sensor_gain":
        gain = 1.0 + float(rng.choice([-1.0, 1.0])) * float(rng.uniform(0.08, 0.25))
        planted.append(Planted(effect, "strip.tip_deflection", {"gain": gain}))
    scene = StripScene(Strip(**{**true, "modes": 3}), runs, sensor, 1.0, gain)
    peak = max(float(np.abs(scene.record(i)["strip.tip_deflection"]).max()) for i in range(len(runs)))
    noise = float(rng.uniform(*DEFLECTION_NOISE)) * peak
    scene = StripScene(scene.strip, runs, sensor, noise, gain, scene.cache)
    seen: tuple[float, ...] = ()
    if planted and effect not in ("higher_mode", "geometric_stiffening"):
        # Their absence cannot be simulated by an engine that always has them.
        plain = StripScene(base, runs, sensor, noise)
        seen = (float(np.linalg.norm(_whitened(scene) - _whitened(plain))),)
    elif planted:
        seen = (float("nan"),)
    name = f"flexible-{kind}-{index}"
    return Case(name, kind, strip, scene.strip, tuple(planted), seen, lambda on: scene)
