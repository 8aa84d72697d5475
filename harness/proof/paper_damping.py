"""The paper's open question: its recordings leave the linear model after some 7 s. Which damping is it, and when can one know?

On the paper's rig, read by its potentiometer, damping of five kinds is concealed, each beside a viscous part, so strong that
the first swings decay as by the paper's ξ = 1.9e-3 N·m·s. Recordings of growing length from several releases are diagnosed
without the answer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.cases.case import Series
from harness.cases.paper.rig import rigid
from harness.cases.paper.study import Progress, Study, silent
from harness.cases.pendulums import MASS, PAYLOAD, paper_small_frequency
from harness.cases.rigid_pendulum_damped import DAMPING
from harness.cases.single_run import run_once
from harness.compare.decay.estimate import departure
from harness.compare.decay.oscillator import losses
from harness.compare.decay.swings import half_swings
from harness.diagnose.diagnose import diagnose
from harness.errors import InputError
from harness.parallel import parallel_map
from harness.recording.instruments import WireWound
from harness.recording.recording import Channel, Recording
from harness.system import Attachment, System

KINDS = ("coulomb_friction", "stribeck_friction", "quadratic_drag", "load_dependent_friction", "dahl_friction")
# What the diagnosis may blame: everything that takes energy out, and what a potentiometer does to an angle.
MAY = (*KINDS, "viscous_damping", "sensor_offset", "sensor_gain", "sensor_nonlinearity", "constant_torque")
DURATIONS, RELEASES = (4.0, 7.0, 10.0, 15.0, 20.0), (20.0, 45.0, 90.0)
RATE = 100.0


@dataclass(frozen=True)
class Concealed:
    """One truth: kind, its parameters, viscous coefficient beside it [N·m·s], share of the first swings' loss that it takes."""

    kind: str
    parameters: tuple[tuple[str, float], ...]
    viscous: float
    share: float

    def system(self) -> System:
        """The rig with it."""
        attached = Attachment(self.kind, "pivot", dict(self.parameters))
        return replace(rigid(damping=self.viscous), attachments=(attached,))


@dataclass(frozen=True)
class Trial:
    """One recording to diagnose: of which truth, released at [°], for [s], seed of its noise."""

    truth: Concealed
    release: float
    duration: float
    seed: int


@dataclass(frozen=True)
class Answer:
    """What came of a trial: effects found, those it could not tell them from, verdict, and when the linear model left it [s]."""

    trial: Trial
    found: tuple[str, ...]
    rivals: tuple[str, ...]
    verdict: str
    left: float | None

    @property
    def named(self) -> bool:
        """The kind is among what was found, and no other non-linear one."""
        return self.truth_kind in self.found and not set(KINDS) - {self.truth_kind} & set(self.found)

    @property
    def truth_kind(self) -> str:
        return self.trial.truth.kind

    @property
    def nonlinear(self) -> bool:
        """Some non-linear damping was found."""
        return bool(set(KINDS) & set(self.found))


def conceal(kind: str, rng: np.random.Generator) -> Concealed:
    """Damping of a kind that takes 40 to 70 % of what the first swings from 90° lose by ξ = 1.9e-3, viscous damping the rest."""
    share = float(rng.uniform(0.4, 0.7))
    circular = 2.0 * math.pi * paper_small_frequency()
    viscous, dry, square = losses(np.array([1.3]), circular, sine=True)[:, 0]
    torque = share * DAMPING * viscous / dry
    mean_force = (
        (MASS + PAYLOAD) * 9.81 * 1.6
    )  # a swing from 90° weighs three times its weight at the bottom, less above
    parameters = {
        "coulomb_friction": {"torque": torque},
        "stribeck_friction": {
            "coulomb_torque": torque,
            "static_torque": torque * float(rng.uniform(1.5, 2.0)),
            "stribeck_velocity": float(rng.uniform(0.3, 0.8)),
        },
        "quadratic_drag": {"coefficient": share * DAMPING * viscous / square},
        "load_dependent_friction": {"mu_radius": torque / mean_force},
        "dahl_friction": {"torque": torque, "stiffness": torque / float(rng.uniform(0.03, 0.1))},
    }[kind]
    return Concealed(kind, tuple(parameters.items()), (1.0 - share) * DAMPING, share)


def record(trial: Trial) -> Recording:
    """The trial's recording: the pivot's angle by the wire-wound potentiometer."""
    time = np.arange(int(trial.duration * RATE) + 1) / RATE
    run = run_once(trial.truth.system(), time, {"pivot": -math.radians(trial.release)}, {})
    read = WireWound(windings=3000).read(np.asarray(run.columns["pivot.position"]), np.random.default_rng(trial.seed))
    return Recording("release", "", time, (Channel("pivot.position", "pivot", "position", "rad", read),))


def asked(trial: Trial) -> Answer:
    """One trial diagnosed, with a nominal model that has no damping at all."""
    recording = record(trial)
    try:
        left = departure(half_swings(recording.time, recording.channels[0].values, sine=True))
    except InputError:
        left = None
    result = diagnose([recording], replace(rigid(damping=0.0), tolerance=0.01), only=MAY)
    found = [finding for finding in result.findings if finding.get("grade") != "possible"]
    rivals = {str(r) for finding in found for r in finding.get("indistinguishable_from", ())}
    return Answer(
        trial, tuple(str(finding["effect"]) for finding in found), tuple(sorted(rivals)), str(result.verdict), left
    )


def departures(seed: int, *, duration: float = 25.0) -> Study:
    """When the viscous model of the first four swings leaves the recording, by kind and release; truths as in ``damping``."""
    rng = np.random.default_rng(seed)
    truths = [conceal(kind, rng) for kind in KINDS]
    heads = ("concealed", "share of the loss", *(f"from {release:g}°" for release in reversed(RELEASES)))
    rows: list[tuple[str, ...]] = []
    series: list[Series] = []
    numbers: dict[str, float] = {}
    for truth in truths:
        left: list[float | None] = []
        for release in RELEASES:
            recording = record(Trial(truth, release, duration, int(rng.integers(2**31))))
            try:
                left.append(departure(half_swings(recording.time, recording.channels[0].values, sine=True)))
            except InputError:
                left.append(None)
        cells = ["not" if t is None else f"{t:.1f} s" for t in reversed(left)]
        rows.append((truth.kind, f"{100.0 * truth.share:.0f} %", *cells))
        times = [math.nan if t is None else t for t in left]
        series.append(
            Series(
                "paper",
                "when the linear model leaves",
                truth.kind.replace("_", " "),
                RELEASES,
                tuple(times),
                "release [°]",
                "time of departure [s]",
                style="points",
            )
        )
        numbers |= {f"{truth.kind}_{release:g}": t for release, t in zip(RELEASES, times, strict=True)}
    return Study({"departure": (heads, rows)}, tuple(series), numbers)


def damping(seed: int, *, quick: bool = False, progress: Progress = silent) -> Study:
    """Every kind, release and length diagnosed; truths drawn from the seed. quick: from 90° alone, three lengths."""
    rng = np.random.default_rng(seed)
    truths = [conceal(kind, rng) for kind in KINDS]
    releases, durations = ((90.0,), (4.0, 10.0, 20.0)) if quick else (RELEASES, DURATIONS)
    trials = [
        Trial(truth, release, duration, int(rng.integers(2**31)))
        for truth in truths
        for release in releases
        for duration in durations
    ]
    count = 0

    def done(index: int, answer: Answer) -> None:
        nonlocal count
        count += 1
        progress(count, len(trials), f"{answer.truth_kind}, {trials[index].release:g}°, {trials[index].duration:g} s")

    answers = parallel_map(asked, trials, done=done)
    return told(answers, truths, releases, durations)


def told(
    answers: Sequence[Answer], truths: Sequence[Concealed], releases: Sequence[float], durations: Sequence[float]
) -> Study:
    """Tables and curves of the answers."""
    heads = (
        "concealed",
        "share of the loss",
        "released at",
        *(f"{d:g} s" for d in durations),
        "linear model leaves at",
    )
    rows = []
    for truth in truths:
        for release in releases:
            mine = {a.trial.duration: a for a in answers if a.trial.truth == truth and a.trial.release == release}
            left = mine[max(durations)].left
            rows.append(
                (
                    truth.kind,
                    f"{100.0 * truth.share:.0f} %",
                    f"{release:g}°",
                    *(_cell(mine[d]) for d in durations),
                    "not" if left is None else f"{left:.1f} s",
                )
            )
    series: list[Series] = []
    numbers: dict[str, float] = {}
    for what, counts in (("named", lambda a: a.named), ("nonlinear", lambda a: a.nonlinear)):
        for release in releases:
            shares = [
                float(np.mean([counts(a) for a in answers if a.trial.release == release and a.trial.duration == d]))
                for d in durations
            ]
            series.append(
                Series(
                    "paper",
                    "seconds it takes to know",
                    f"{'kind named' if what == 'named' else 'told non-linear'}, from {release:g}°",
                    tuple(durations),
                    tuple(shares),
                    "length of the recording [s]",
                    "share of the five kinds",
                    style="line" if what == "named" else "dashed",
                )
            )
            numbers |= {f"{what}_{release:g}_{d:g}": share for d, share in zip(durations, shares, strict=True)}
    parameters = [
        (t.kind, f"{t.viscous:.3g}", ", ".join(f"{name} {value:.3g}" for name, value in t.parameters)) for t in truths
    ]
    return Study(
        {"open_question": (heads, rows), "concealed": (("kind", "viscous [N·m·s]", "parameters"), parameters)},
        tuple(series),
        numbers,
    )


def _cell(answer: Answer) -> str:
    if answer.named:
        return "named"
    if not answer.found:
        return "nothing found" if answer.verdict in ("consistent",) else answer.verdict.replace("_", " ")
    others = " + ".join(effect for effect in answer.found if effect != "viscous_damping") or "viscous alone"
    return f"in a class: {others}" if answer.truth_kind in answer.rivals else others
