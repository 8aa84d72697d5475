"""Arms of two and three links, rigid and flexible, falling and driven: native modes against finite elements.

ANCF elements stiffen by rotation, a floating frame does not: each is held against the native model that does as it does.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.cases.beams import LENGTH, STEEL, THICKNESS, WIDTH, strip
from harness.cases.case import NATIVE, Array, Series
from harness.cases.checks.deflection import tip_difference
from harness.cases.checks.trajectory import initial_state
from harness.cases.paper.study import Progress, Study, silent
from harness.cases.pendulums import GRAVITY, HUB, bar, hinge
from harness.compare.spectrum import match_modes
from harness.engines import registry
from harness.engines.exudyn_ancf import Ancf
from harness.engines.exudyn_ffrf import Ffrf
from harness.engines.protocol import EngineModel
from harness.errors import EngineUnavailableError, UnsupportedError
from harness.journal import Journal
from harness.parallel import parallel_map
from harness.system import Link, System, Trajectory
from harness.system.description import constant

# R is a rigid bar, F a strip of the same steel; the first stands at the base.
ARMS = ("F", "RF", "FR", "FF", "RFR", "FRF")
MODES = (1, 2, 3, 4, 5)
ANCF, FFRF = "exudyn_ancf", "exudyn_ffrf"
PEERS = (ANCF, FFRF)
SHAPES = ("auto", "clamped_free")
# Step of the native engine, with which five modes' vibrations are followed [s].
OWN_STEP = 1e-4
# Vibrations that the floating frame keeps of each bar.
VIBRATIONS = 8


def arm(
    kinds: str, *, modes: int = 3, gravity: float = GRAVITY, stiffening: bool = True, shapes: str = "auto"
) -> System:
    """An arm of links by letter, each 0.30 m of 25 × 1 mm steel, hinged end to end on the paper's hub, hanging at zero.

    shapes: of the modes.
    """
    mass = STEEL * LENGTH * WIDTH * THICKNESS
    links, joints = [], []
    for k, kind in enumerate(kinds):
        name = f"link{k + 1}"
        links.append(bar(name, LENGTH, mass) if kind == "R" else _strip(name, modes, stiffening, shapes))
        parent = "base" if k == 0 else f"link{k}"
        # A torque on the massless end of a beam turns it at once, and what is seen from there is then of no frequency; the
        # paper's joint has a hub.
        drop, hub = (0.0, HUB) if k == 0 else (LENGTH, 0.0)
        joints.append(hinge(f"joint{k + 1}", parent, name, drop=drop, armature=hub))
    return System(f"arm {kinds}", tuple(joints), tuple(links), gravity=constant([0.0, 0.0, -gravity]))


def _strip(name: str, modes: int, stiffening: bool, shapes: str) -> Link:
    made = strip(name, modes=modes, stiffening=stiffening)
    assert made.beam is not None
    return replace(made, beam=replace(made.beam, shapes=shapes))


@dataclass(frozen=True)
class Motion:
    """One run of one arm: falling from a bent pose, or driven at its first joint while it hangs.

    modes: numbers of native modes on each strip; elements: of ANCF on each strip; bricks: of the floating frame's mesh;
    step: of both [s].
    """

    kinds: str
    driven: bool
    modes: tuple[int, ...]
    duration: float
    elements: int
    bricks: int
    step: float

    @property
    def what(self) -> str:
        return "driven" if self.driven else "falling"

    @property
    def key(self) -> str:
        """Name of the motion in a study."""
        return f"{self.kinds} {self.what}"

    @property
    def start(self) -> dict[str, float]:
        """Joint positions at the start by name [rad]; zero where not named."""
        return {} if self.driven else {"joint1": -1.0} | ({"joint2": -0.5} if len(self.kinds) > 1 else {})

    def torque(self, time: Array, n: int) -> Array | None:
        """Two periods of a sine of 0.05 N·m at the first joint, (T, n), held from sample to sample."""
        if not self.driven:
            return None
        tau = np.zeros((len(time), n))
        tau[:, 0] = 0.05 * np.sin(2.0 * math.pi * 2.0 / self.duration * time)
        return tau

    def run(self, model: EngineModel, system: System, step: float) -> Trajectory:
        """The motion in one engine, at 2 kHz."""
        time = np.linspace(0.0, self.duration, round(self.duration * 2000.0) + 1)
        torque = self.torque(time, len(system.coordinate_names))
        return model.simulate(*initial_state(system, self.start, {}), time, tau=torque, step=step)


def compared(motion: Motion) -> tuple[Motion, dict[str, float] | str]:
    """RMS errors of the tip deflections over their peak, by ``_name``, or why there are none.

    ``apart``: how far the floating frame is from ANCF, which stiffen by rotation. ``exudyn_…``: what twice the step changes
    of that peer, whose own error is a third of it.
    """
    errors: dict[str, float] = {}
    truths: list[Trajectory] = []
    try:
        for peer in PEERS:
            system = arm(motion.kinds, stiffening=peer == ANCF)
            model = _peer(peer, system, motion.elements, motion.bricks)
            truths.append(motion.run(model, system, motion.step))
            errors[peer] = tip_difference(motion.run(model, system, 2.0 * motion.step), truths[-1])[0]
    except (UnsupportedError, EngineUnavailableError) as reason:
        return motion, str(reason)
    errors["apart"] = tip_difference(truths[1], truths[0])[0]
    for peer, truth in zip(PEERS, truths, strict=True):
        for shapes in SHAPES:
            for modes in motion.modes:
                own = arm(motion.kinds, modes=modes, stiffening=peer == ANCF, shapes=shapes)
                run = motion.run(registry.engine(NATIVE).build(own), own, OWN_STEP)
                errors[_name(peer, shapes, modes)] = tip_difference(run, truth)[0]
    return motion, errors


def _name(peer: str, shapes: str, modes: int) -> str:
    return f"{peer} {shapes} {modes}"


def _peer(peer: str, system: System, elements: int, bricks: int) -> EngineModel:
    if peer == ANCF:
        return Ancf(elements=elements).build(system)
    return Ffrf(elements=bricks, modes=VIBRATIONS).build(system)


@dataclass(frozen=True)
class Turned:
    """First natural frequencies [Hz] of a weightless arm with its second joint at ``angle`` [rad]; peers' matched to ours."""

    angle: float
    own: list[float]
    peers: dict[str, list[float]]


def configurations(kinds: str, angles: Sequence[float], elements: int, bricks: int) -> list[Turned]:
    """Natural frequencies by the angle of the second joint, native with five modes on each strip, and finite elements."""
    ours = arm(kinds, modes=5, gravity=0.0)
    models = {NATIVE: (ours, registry.engine(NATIVE).build(ours))}
    try:
        for peer in PEERS:
            system = arm(kinds, gravity=0.0, stiffening=peer == ANCF)
            models[peer] = system, _peer(peer, system, elements, bricks)
    except EngineUnavailableError:
        pass
    found = []
    for angle in angles:
        all_of = {}
        for name, (system, model) in models.items():
            q, _ = initial_state(system, {"joint2": angle}, {})
            all_of[name] = np.array([f for f in model.frequencies(q) if f > 0.1])
        own = all_of.pop(NATIVE)[:3]
        matched = {}
        for peer, other in all_of.items():
            pairs = dict(match_modes(own, other))
            matched[peer] = [float(other[pairs[k]]) if k in pairs else math.nan for k in range(len(own))]
        found.append(Turned(angle, own.tolist(), matched))
    return found


def links(
    *,
    quick: bool = False,
    workers: int | None = None,
    progress: Progress = silent,
    journal: Journal | None = None,
) -> Study:
    """Tip error against modes for every arm and motion, and frequency against configuration.

    quick: shorter motions, fewer modes, elements and angles.

    journal: keeps each motion's errors as they come; what it has is not run again.
    """
    modes = MODES[:3] if quick else MODES
    duration, elements, bricks, step = (0.15, 8, 96, 5e-5) if quick else (0.25, 16, 192, 2.5e-5)
    motions = [
        Motion(kinds, driven, modes, duration, elements, bricks, step) for kinds in ARMS for driven in (False, True)
    ]
    kept = {} if journal is None else dict(journal.found)
    left = [motion for motion in motions if motion.key not in kept]

    def done(index: int, outcome: tuple[Motion, dict[str, float] | str]) -> None:
        motion, errors = outcome
        kept[motion.key] = errors
        if journal is not None:
            journal.add(motion.key, errors)
        progress(len(kept), len(motions) + 1, left[index].key)

    parallel_map(compared, left, workers=workers, done=done)
    angles = np.radians(np.linspace(0.0, 150.0, 4 if quick else 11))
    turned = {kinds: configurations(kinds, angles.tolist(), elements, bricks) for kinds in ("FF", "RF")}
    progress(len(motions) + 1, len(motions) + 1, "frequencies")
    return _told([(motion, kept[motion.key]) for motion in motions], turned, modes)


def _told(
    ran: Sequence[tuple[Motion, dict[str, float] | str]], turned: dict[str, list[Turned]], modes: Sequence[int]
) -> Study:
    plural = [f"{m} mode{'s' if m > 1 else ''}" for m in modes]
    heads = ("arm", "motion", "shapes", *(f"{count}: ANCF, FFRF" for count in plural))
    rows: list[tuple[str, ...]] = []
    apart: list[tuple[str, ...]] = []
    series: list[Series] = []
    numbers: dict[str, float] = {}
    for motion, errors in ran:
        if isinstance(errors, str):
            rows.append((motion.kinds, motion.what, errors, *[""] * len(modes)))
            continue
        apart.append((motion.kinds, motion.what, *(f"{errors[name]:.2g}" for name in ("apart", *PEERS))))
        numbers[f"{motion.kinds}_{motion.what}_apart"] = errors["apart"]
        for shapes in SHAPES:
            pairs = (", ".join(f"{errors[_name(peer, shapes, m)]:.2g}" for peer in PEERS) for m in modes)
            rows.append((motion.kinds, motion.what, shapes, *pairs))
            for peer in PEERS:
                of_modes = tuple(errors[_name(peer, shapes, m)] for m in modes)
                numbers |= {
                    f"{motion.kinds}_{motion.what}_{shapes}_{peer}_{m}": error
                    for m, error in zip(modes, of_modes, strict=True)
                }
                series.append(
                    Series(
                        "paper",
                        f"tip error against modes {motion.what} {peer}",
                        f"{motion.kinds}, {shapes}",
                        tuple(float(m) for m in modes),
                        of_modes,
                        "modes on each strip",
                        "RMS of tip deflection over its peak",
                        style="dashed" if shapes == "clamped_free" else "line",
                        log="y",
                    )
                )
    # An arm has one colour with either kind of modes where those of one kind come first.
    series.sort(key=lambda line: line.style == "dashed")
    tables = {
        "tip_error": (heads, rows),
        "stiffening": (("arm", "motion", "FFRF against ANCF", "ANCF, twice the step", "FFRF, twice the step"), apart),
        "frequencies": _frequency_table(turned),
    }
    for kinds, found in turned.items():
        series += _frequency_series(kinds, found)
        numbers |= {
            f"{kinds}_frequency_{k + 1}_{round(math.degrees(row.angle))}": value
            for row in found
            for k, value in enumerate(row.own)
        }
    return Study(tables, tuple(series), numbers)


def _frequency_table(turned: dict[str, list[Turned]]) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    rows = [
        (
            kinds,
            f"{math.degrees(row.angle):.0f}",
            _hertz(row.own),
            *(_hertz(row.peers[peer]) if peer in row.peers else "" for peer in PEERS),
        )
        for kinds, found in turned.items()
        for row in found
    ]
    return ("arm", "second joint [°]", "native [Hz]", "ANCF [Hz]", "FFRF [Hz]"), rows


def _frequency_series(kinds: str, found: Sequence[Turned]) -> list[Series]:
    angles = tuple(math.degrees(row.angle) for row in found)
    series = []
    for k in range(min(len(row.own) for row in found)):
        lines = {NATIVE: [row.own[k] for row in found]} | {
            peer: [row.peers[peer][k] for row in found] for peer in found[0].peers
        }
        for label, values in lines.items():
            series.append(
                Series(
                    "paper",
                    f"frequency against configuration {kinds}",
                    f"{label}, {k + 1}",
                    angles,
                    tuple(values),
                    "angle of the second joint [°]",
                    "frequency [Hz]",
                    style="line" if label == NATIVE else "dashed",
                )
            )
    return series


def _hertz(values: Sequence[float]) -> str:
    return ", ".join("–" if math.isnan(v) else f"{v:.4g}" for v in values)
