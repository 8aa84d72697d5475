"""Arms of two and three links, rigid and flexible, falling and driven: native modes against finite elements."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from harness.cases.beams import LENGTH, STEEL, THICKNESS, WIDTH, strip
from harness.cases.case import NATIVE, Array, Series
from harness.cases.checks.deflection import tip_difference, with_modes
from harness.cases.checks.trajectory import initial_state
from harness.cases.paper.study import Progress, Study, silent
from harness.cases.pendulums import GRAVITY, bar, hinge
from harness.compare.spectrum import match_modes
from harness.engines import registry
from harness.engines.exudyn_ancf import Ancf
from harness.engines.protocol import EngineModel
from harness.errors import EngineUnavailableError, UnsupportedError
from harness.journal import Journal
from harness.parallel import parallel_map
from harness.system import Link, System
from harness.system.description import constant

# R is a rigid bar, F a strip of the same steel; the first stands at the base.
ARMS = ("F", "RF", "FR", "FF", "RFR", "FRF")
MODES = (1, 2, 3, 4, 5)


def arm(
    kinds: str, *, modes: int = 3, gravity: float = GRAVITY, stiffening: bool = True, shapes: str = "auto"
) -> System:
    """An arm of links by letter, each 0.30 m of 25 × 1 mm steel, hinged end to end, hanging at zero; shapes: of modes."""
    mass = STEEL * LENGTH * WIDTH * THICKNESS
    links, joints = [], []
    for k, kind in enumerate(kinds):
        name = f"link{k + 1}"
        links.append(bar(name, LENGTH, mass) if kind == "R" else _strip(name, modes, stiffening, shapes))
        parent = "base" if k == 0 else f"link{k}"
        joints.append(hinge(f"joint{k + 1}", parent, name, drop=0.0 if k == 0 else LENGTH))
    return System(f"arm {kinds}", tuple(joints), tuple(links), gravity=constant([0.0, 0.0, -gravity]))


def _strip(name: str, modes: int, stiffening: bool, shapes: str) -> Link:
    made = strip(name, modes=modes, stiffening=stiffening)
    assert made.beam is not None
    return replace(made, beam=replace(made.beam, shapes=shapes))


@dataclass(frozen=True)
class Motion:
    """One run of one arm: falling from a bent pose, or driven at its first joint while it hangs; peer of finite elements.

    shapes: of the native modes.
    """

    kinds: str
    driven: bool
    peer: str
    shapes: str
    modes: tuple[int, ...]
    duration: float
    elements: int

    @property
    def key(self) -> str:
        """Name of the motion in a study."""
        return f"{self.kinds} {'driven' if self.driven else 'falling'} {self.shapes} {self.peer}"

    def torque(self, time: Array, n: int) -> Array | None:
        """Two periods of a sine of 0.05 N·m at the first joint, (T, n), held from sample to sample."""
        if not self.driven:
            return None
        tau = np.zeros((len(time), n))
        tau[:, 0] = 0.05 * np.sin(2.0 * math.pi * 2.0 / self.duration * time)
        return tau


def compared(motion: Motion) -> tuple[Motion, dict[int, float] | str]:
    """RMS error of the tip deflections over their peak by number of modes, or why there is none."""
    stiffening = motion.peer == "exudyn_ancf"
    time = np.linspace(0.0, motion.duration, round(motion.duration * 2000.0) + 1)
    system = arm(motion.kinds, stiffening=stiffening, shapes=motion.shapes)
    start = {} if motion.driven else {"joint1": -1.0} | ({"joint2": -0.5} if len(motion.kinds) > 1 else {})
    try:
        peer = _ancf(system, motion.elements) if stiffening else registry.engine(motion.peer).build(system)
        truth = peer.simulate(
            *initial_state(system, start, {}),
            time,
            tau=motion.torque(time, len(system.coordinate_names)),
            step=5e-5,
        )
    except (UnsupportedError, EngineUnavailableError) as reason:
        return motion, str(reason)
    errors = {}
    for modes in motion.modes:
        own = with_modes(system, modes)
        model = registry.engine(NATIVE).build(own)
        run = model.simulate(*initial_state(own, start, {}), time, tau=motion.torque(time, len(own.coordinate_names)))
        errors[modes] = tip_difference(run, truth)[0]
    return motion, errors


def _ancf(system: System, elements: int) -> EngineModel:
    return cast(EngineModel, Ancf(elements=elements).build(system))


def configurations(kinds: str, angles: Sequence[float], elements: int) -> list[tuple[float, list[float], list[float]]]:
    """First natural frequencies [Hz] of a weightless arm by the angle of its second joint [rad]: native, and ANCF's matched."""
    system = arm(kinds, modes=5, gravity=0.0)
    ours = registry.engine(NATIVE).build(system)
    try:
        Ancf().version()
        theirs: EngineModel | None = _ancf(system, elements)
    except EngineUnavailableError:
        theirs = None
    found = []
    for angle in angles:
        q, _ = initial_state(system, {"joint2": angle}, {})
        own = np.array([f for f in ours.frequencies(q) if f > 0.1])[:3]
        matched: list[float] = []
        if theirs is not None:
            other = np.array([f for f in theirs.frequencies(q) if f > 0.1])
            pairs = dict(match_modes(own, other))
            matched = [float(other[pairs[k]]) if k in pairs else math.nan for k in range(len(own))]
        found.append((angle, own.tolist(), matched))
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
    duration, elements = (0.15, 8) if quick else (0.5, 16)
    motions = [
        Motion(kinds, driven, peer, shapes, modes, duration, elements)
        for kinds in ARMS
        for driven, shapes in ((False, "auto"), (True, "auto"), (True, "clamped_free"))
        # The floating frame is set up for one beam on the base, and does not stiffen.
        for peer in (("exudyn_ancf", "exudyn_ffrf") if kinds == "F" else ("exudyn_ancf",))
    ]
    kept = {} if journal is None else dict(journal.found)
    left = [motion for motion in motions if motion.key not in kept]

    def done(index: int, outcome: tuple[Motion, dict[int, float] | str]) -> None:
        motion, errors = outcome
        kept[motion.key] = errors if isinstance(errors, str) else {str(m): error for m, error in errors.items()}
        if journal is not None:
            journal.add(motion.key, kept[motion.key])
        progress(len(kept), len(motions) + 1, left[index].key)

    parallel_map(compared, left, workers=workers, done=done)
    ran = [
        (m, kept[m.key] if isinstance(kept[m.key], str) else {int(k): float(e) for k, e in kept[m.key].items()})
        for m in motions
    ]
    angles = np.radians(np.linspace(0.0, 150.0, 4 if quick else 11))
    turned = {kinds: configurations(kinds, angles.tolist(), elements) for kinds in ("FF", "RF")}
    progress(len(motions) + 1, len(motions) + 1, "frequencies")
    return _told(ran, turned, modes)


def _told(
    ran: Sequence[tuple[Motion, dict[int, float] | str]],
    turned: dict[str, list[tuple[float, list[float], list[float]]]],
    modes: Sequence[int],
) -> Study:
    heads = ("arm", "motion", "shapes", "against", *(f"{m} mode{'s' if m > 1 else ''}" for m in modes))
    rows: list[tuple[str, ...]] = []
    series: list[Series] = []
    numbers: dict[str, float] = {}
    for motion, errors in ran:
        what = "driven" if motion.driven else "falling"
        if isinstance(errors, str):
            rows.append((motion.kinds, what, motion.shapes, motion.peer, errors, *[""] * (len(modes) - 1)))
            continue
        rows.append((motion.kinds, what, motion.shapes, motion.peer, *(f"{errors[m]:.2g}" for m in modes)))
        numbers |= {f"{motion.kinds}_{what}_{motion.shapes}_{motion.peer}_{m}": errors[m] for m in modes}
        series.append(
            Series(
                "paper",
                f"tip error against modes {what}",
                f"{motion.kinds}, {motion.shapes}, {motion.peer}",
                tuple(float(m) for m in modes),
                tuple(errors[m] for m in modes),
                "modes on each strip",
                "RMS of tip deflection over its peak",
                style="dashed" if motion.shapes == "clamped_free" else "line",
                log="y",
            )
        )
    frequency_heads = ("arm", "second joint [°]", "native [Hz]", "ANCF [Hz]")
    frequency_rows = []
    for kinds, found in turned.items():
        for angle, own, other in found:
            frequency_rows.append((kinds, f"{math.degrees(angle):.0f}", _hertz(own), _hertz(other)))
        for k in range(min(len(own) for _, own, _ in found)):
            for label, pick, dashed in ((NATIVE, 1, False), ("exudyn_ancf", 2, True)):
                values = [row[pick][k] if k < len(row[pick]) else math.nan for row in found]  # type: ignore[index,arg-type]
                series.append(
                    Series(
                        "paper",
                        f"frequency against configuration {kinds}",
                        f"{label}, {k + 1}",
                        tuple(math.degrees(row[0]) for row in found),
                        tuple(values),
                        "angle of the second joint [°]",
                        "frequency [Hz]",
                        style="dashed" if dashed else "line",
                    )
                )
        numbers |= {
            f"{kinds}_frequency_{k + 1}_{round(math.degrees(row[0]))}": row[1][k]
            for row in found
            for k in range(len(row[1]))
        }
    return Study({"tip_error": (heads, rows), "frequencies": (frequency_heads, frequency_rows)}, tuple(series), numbers)


def _hertz(values: Sequence[float]) -> str:
    return ", ".join("–" if math.isnan(v) else f"{v:.4g}" for v in values)
