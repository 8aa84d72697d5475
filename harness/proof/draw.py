"""Cases drawn at random: what is concealed, on which rig, how strongly, seen by which sensor."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from harness.proof.alike import FAMILIES
from harness.proof.concealments import CONCEALMENTS, Concealment
from harness.proof.outside import OUTSIDE
from harness.proof.rigs import Rig, deviate, draw_rig
from harness.proof.scene import Planted, Run, Scene, Sensor
from harness.proof.strength import Sight

Array = NDArray[np.float64]

RATES = (100.0, 200.0, 250.0, 500.0)
# Of a quick proof's recordings: how many, and at most how long [s] and at what rate [Hz].
SHORT_RUNS, SHORT_DURATION, SHORT_RATE = 2, 6.0, 250.0
# Share of disguised cases with a large rotor, and of those that state a law which acts as stated.
DISGUISED = 0.15
FAINTEST = 1.0  # visibility that what is concealed has at least


class UnseenError(RuntimeError):
    """No strength makes a concealed effect show in the recordings drawn: a stop that no motion reaches."""


class Model(Protocol):
    """A rig as a user's model file states it."""

    @property
    def joints(self) -> tuple[str, ...]: ...

    def toml(self) -> str: ...


class Recorded(Protocol):
    """Something that can be let run and recorded."""

    @property
    def runs(self) -> Sequence[Run]: ...

    @property
    def sensor(self) -> Sensor: ...

    def std(self, column: str) -> float: ...

    def record(self, index: int, instants: Array | None = None) -> dict[str, Array]: ...


@dataclass(frozen=True)
class Case:
    """A drawn case: the answer and all that is needed to let it run.

    kind: "clean", "single", "pair", "triple" or "outside"; visibility: d of each planted effect, in the order of ``planted``.
    make: the scene on a given true rig, everything planted; scene: on this case's true rig.
    """

    name: str
    kind: str
    nominal: Model
    rig: Model
    planted: tuple[Planted, ...]
    visibility: tuple[float, ...]
    make: Callable[[Any], Recorded]

    @property
    def scene(self) -> Recorded:
        return self.make(self.rig)


def _draw_sensor(rng: np.random.Generator, short: bool) -> Sensor:
    rate = float(rng.choice([r for r in RATES if r <= SHORT_RATE] if short else RATES))
    std = float(np.exp(rng.uniform(np.log(2e-4), np.log(5e-3))))
    colour = float(rng.choice([0.0, 0.0, 0.0, rng.uniform(0.3, 0.9)]))
    step = float(rng.choice([0.0, 0.0, 2 * np.pi / 4096, 2 * np.pi / 16384]))
    jitter = float(rng.choice([0.0, 0.0, 0.0, 0.08 / rate]))
    return Sensor(rate, std, colour, min(step, 2 * std), jitter)


def _draw_runs(rng: np.random.Generator, rig: Rig, driven: bool, short: bool) -> tuple[tuple[Run, ...], float]:
    """Two or three runs; the last is the one that diagnosis will hold out. Also the largest release angle [rad]."""
    swing = rig.natural_frequency
    count = SHORT_RUNS if short else int(rng.integers(2, 4))
    duration = float(np.clip(rng.uniform(8, 16) / swing, 5.0, SHORT_DURATION if short else 16.0))
    n = len(rig.segments)
    top = float(rng.uniform(0.5, 2.2)) if n == 1 else float(rng.uniform(0.3, 0.8))
    runs = []
    for k in range(count):
        angle = top * (1.0 if k == 0 else float(rng.uniform(0.5, 1.0))) * float(rng.choice([-1.0, 1.0]))
        q0 = [angle] + [float(rng.uniform(-0.5, 0.5)) * top for _ in range(n - 1)]
        drive: tuple[tuple[float, float, float], ...] = ()
        if driven:
            # Away from resonance, so that the swing stays bounded and the motion predictable.
            torque = 0.12 * rig.segments[0].gravity_moment
            drive = tuple(
                (
                    torque * float(rng.uniform(0.3, 1.0)),
                    swing * float(rng.choice([rng.uniform(0.15, 0.75), rng.uniform(1.3, 2.2)])),
                    float(rng.uniform(-3, 3)),
                )
                for _ in range(4)
            )
            q0 = [0.3 * x for x in q0]
        runs.append(Run(tuple(q0), (0.0,) * n, duration, drive))
    return tuple(runs), top


def _held(runs: Sequence[Run], sensor: Sensor, rng: np.random.Generator) -> tuple[Run, ...]:
    """The runs with commands that are held from sample to sample, as a controller does, or not, at even odds."""
    if sensor.jitter or rng.random() < 0.5:
        return tuple(runs)
    return tuple(replace(run, held=1.0 / sensor.rate) for run in runs)


def _names(kind: str, rng: np.random.Generator, forced: Sequence[str]) -> list[str]:
    if forced:
        return list(forced)
    if kind in ("clean", "outside"):
        return []
    size = {"single": 1, "pair": 2, "triple": 3}[kind]
    names = [name for name, c in CONCEALMENTS.items() if not (c.stated or c.alone)]
    while True:
        chosen = [str(x) for x in rng.choice(names, size, replace=False)]
        needs = [CONCEALMENTS[name] for name in chosen]
        fit = not (any(c.needs_drive for c in needs) and any(c.needs_freedom for c in needs))
        if fit and all(len(family.intersection(chosen)) <= 1 for family in FAMILIES):
            return chosen


def _site(rig: Rig, c: Concealment, k: int) -> str:
    s = rig.segments[k]
    return {"joint": s.joint, "link": s.link, "channel": f"{s.joint}.position", "base": "base"}[c.site]


ADDING = ("base_compliance", "joint_flexibility", "backlash", "link_flexibility")


def _rank(c: Concealment) -> int:
    """Place in the order of planting."""
    if c.effect in ADDING:
        return 1 + ADDING.index(c.effect)
    return 0 if c.site == "link" else 1 + len(ADDING)


def _large_rotors(rig: Rig, rng: np.random.Generator) -> Rig:
    """The rig with rotors that matter in its motion."""
    motor = [replace(s, armature=float(rng.uniform(0.05, 0.3)) * s.inertia_about_joint) for s in rig.segments]
    return replace(rig, segments=tuple(motor))


def _stated(
    rig: Rig, names: Sequence[str], rng: np.random.Generator, top: float
) -> tuple[str, int, dict[str, float]] | None:
    """A law beside what is concealed that the model may state as it acts: effect, number of the joint, parameters; or None."""
    beside = [
        name
        for name in sorted({c.stated for c in CONCEALMENTS.values() if c.stated})
        if not any(name == other or any({name, other} <= family for family in FAMILIES) for other in names)
    ]
    if not beside:
        return None
    name, k = str(rng.choice(beside)), int(rng.integers(len(rig.segments)))
    c = CONCEALMENTS[name]
    return (
        name,
        k,
        {
            key: float(x)
            for key, x in c.parameters(1.0, c.draw(rng, rig.segments[k], top), rig.segments[k], top).items()
        },
    )


def draw_case(
    kind: str, seed: int, index: int, *, effects: Sequence[str] = (), target: float | None = None, short: bool = False,
    disguised: bool = False,
) -> Case:  # fmt: skip
    """One case.

    kind: "clean", "single", "pair", "triple", "outside"; effects: names to conceal (drawn if empty; for "outside" the kind).
    target: visibility d to aim at (drawn log-uniformly if None). short: two short recordings at moderate rates.
    disguised: also give some models what only those of certain concealments have otherwise (a large rotor, an effect that is stated
    and acts as stated), so that no model tells what is concealed; other draws of a seed stay as they are.
    Raises UnseenError where what is drawn would not show.
    """
    rng = np.random.default_rng([seed, index, crc32(kind.encode())])
    names = _names(kind, rng, effects if kind != "outside" else ())
    chosen = [CONCEALMENTS[name] for name in names]
    two = rng.random() < 0.3 and kind != "outside" and all(2 in c.joints for c in chosen)
    rig = draw_rig(rng, 2 if two else 1)
    aside = np.random.default_rng([seed, index, crc32(b"disguise")])
    if any(c.needs_armature for c in chosen):
        rig = _large_rotors(rig, rng)
    elif disguised and aside.random() < DISGUISED:
        rig = _large_rotors(rig, aside)
    driven = any(c.needs_drive for c in chosen) or rng.random() < 0.2
    driven = driven and not any(c.needs_freedom for c in chosen)
    runs, top = _draw_runs(rng, rig, driven, short)
    sensor = _draw_sensor(rng, short)
    true = deviate(rig, rng)
    sites = [
        0 if (c.site == "base" or c.effect.startswith("actuator") or c.everywhere)
        else int(rng.integers(len(rig.segments)))
        for c in chosen
    ]  # fmt: skip
    draws = [
        {name: float(x) for name, x in c.draw(rng, rig.segments[k], top).items()}
        for c, k in zip(chosen, sites, strict=True)
    ]
    for i, (c, k) in enumerate(zip(chosen, sites, strict=True)):
        if c.stated:
            stated = CONCEALMENTS[c.stated]
            known = stated.parameters(1.0, stated.draw(rng, rig.segments[k], top), rig.segments[k], top)
            known = {name: float(x) for name, x in known.items()}
            draws[i] |= known
            attached = ((c.stated, _site(rig, stated, k), known),)
            rig, true = replace(rig, stated=attached), replace(true, stated=attached)
    known_law = None
    # What is outside the catalogue may rub at the same joint.
    if disguised and kind != "outside" and not rig.stated and aside.random() < DISGUISED:
        known_law = _stated(rig, names, aside, top)
    if known_law:
        name, k, values = known_law
        attached = ((name, _site(rig, CONCEALMENTS[name], k), values),)
        rig, true = replace(rig, stated=attached), replace(true, stated=attached)
    # How strong things have to be is sought with smooth efforts.
    recorded = _held(runs, sensor, np.random.default_rng([seed, index, crc32(b"held")])) if driven else runs
    strange = str(effects[0]) if kind == "outside" and effects else str(rng.choice(list(OUTSIDE)))
    own = int(rng.integers(2**31))
    motions: dict[tuple[object, ...], tuple[Array, Array]] = {}

    def build(on: Rig, strengths: Sequence[float], outside: float, *, as_recorded: bool = False) -> Scene:
        scene = Scene(on, recorded if as_recorded else runs, sensor, motions=motions)
        # Changes of inertia first: they alter the rig; then what adds degrees of freedom, the base before the joints on it;
        # then laws, which act on degrees of freedom that must all be there.
        order = sorted(range(len(chosen)), key=lambda i: _rank(chosen[i]))
        for i in order:
            c, k = chosen[i], sites[i]
            if strengths[i] > 0.0:
                p = c.parameters(strengths[i], draws[i], rig.segments[k], top)
                c.plant(scene, k, {**draws[i], **p} if c.stated else p)
            elif c.stated:
                CONCEALMENTS[c.stated].plant(scene, k, draws[i])
        if known_law:
            name, k, values = known_law
            CONCEALMENTS[name].plant(scene, k, values)
        if kind == "outside" and outside > 0.0:
            OUTSIDE[strange](scene, np.random.default_rng(own), outside, top)
        return scene

    off = [0.0] * len(chosen)
    if kind == "clean":
        return Case(f"{kind}-{index}", kind, rig, true, (), (), lambda on: build(on, off, 0.0, as_recorded=True))

    lowest, highest = (3.0, 300.0) if kind in ("single",) else (15.0, 300.0)
    sight = Sight.of(true, runs, sensor, build(true, off, 0.0))

    # Of several effects, each by itself: how far they mask one another is for the diagnosis to find out.
    strengths: list[float] = []
    seen: list[float] = []
    for i in range(len(chosen)):
        aim = target or float(np.exp(rng.uniform(np.log(lowest), np.log(highest))))

        def make(f: float, i: int = i) -> Scene:
            return build(true, [f if j == i else 0.0 for j in range(len(chosen))], 0.0)

        f, d = sight.strength(make, aim)
        strengths.append(f)
        seen.append(d)
    outside = 0.0
    if kind == "outside":
        aim = target or float(np.exp(rng.uniform(np.log(lowest), np.log(highest))))
        outside, d = sight.strength(lambda f: build(true, off, f), aim)
        seen.append(d)
    if min(seen) < FAINTEST:
        raise UnseenError(f"{kind} {index} conceals something that does not show")
    planted = [
        Planted(c.effect, _site(rig, c, k), c.parameters(f, d, rig.segments[k], top))
        for c, k, f, d in zip(chosen, sites, strengths, draws, strict=True)
    ]
    if kind == "outside":
        planted.append(Planted(strange, rig.joints[0], {"strength": outside}))
    return Case(
        f"{kind}-{index}",
        kind,
        rig,
        true,
        tuple(planted),
        tuple(seen),
        lambda on: build(on, strengths, outside, as_recorded=True),
    )
