"""The paper's open question: its recordings leave the linear model after some 7 s. Which damping is it, and when can one know?

On the paper's rig, read by its potentiometer, damping of five kinds is concealed, each beside a viscous part, so strong that
the first swings decay as by the paper's ξ = 1.9e-3 N·m·s. Recordings of growing length from several releases are diagnosed
without the answer.
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.cases.case import Series
from harness.cases.paper.rig import rigid
from harness.cases.paper.study import Progress, Study, Table, silent
from harness.cases.pendulums import MASS, PAYLOAD, paper_small_frequency
from harness.cases.rigid_pendulum_damped import DAMPING
from harness.cases.single_run import run_once
from harness.compare.decay.estimate import departure
from harness.compare.decay.oscillator import losses
from harness.compare.decay.swings import half_swings
from harness.diagnose.diagnose import diagnose
from harness.errors import InputError
from harness.journal import Journal
from harness.parallel import parallel_map
from harness.recording.instruments import WireWound
from harness.recording.recording import Channel, Recording
from harness.system import Attachment, System

KINDS = ("coulomb_friction", "stribeck_friction", "quadratic_drag", "load_dependent_friction", "dahl_friction")
# What the diagnosis may blame: everything that takes energy out, and what a potentiometer does to an angle.
MAY = (*KINDS, "viscous_damping", "sensor_offset", "sensor_gain", "sensor_nonlinearity", "constant_torque")
DURATIONS, RELEASES, DRAWS = (4.0, 7.0, 10.0, 20.0), (20.0, 45.0, 90.0), 2
ASKED_FIRST = (10.0, 20.0, 4.0, 7.0)
RATE = 100.0
LEAVES, PUBLISHED = "when the linear model leaves", 7.0  # s, section 5.1 of the paper: released from the horizontal


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
    """One recording to diagnose: of which truth, released at [°], for [s], seed of its noise; draw: which one of its kind."""

    truth: Concealed
    release: float
    duration: float
    seed: int
    draw: int = 0

    @property
    def key(self) -> str:
        """Name of the trial in a study."""
        return f"{self.draw}/{self.truth.kind}/{self.release:g}/{self.duration:g}"


@dataclass(frozen=True)
class Answer:
    """What came of a trial: effects found, non-linear kinds that the found ones could not be told from, verdict."""

    trial: Trial
    found: tuple[str, ...]
    rivals: tuple[str, ...]
    verdict: str

    @property
    def outcome(self) -> str:
        """One of ``OUTCOMES``."""
        kind, others = self.trial.truth.kind, set(KINDS) & set(self.found)
        if others == {kind}:
            return "likeliest" if set(KINDS) & set(self.rivals) - {kind} else "named"
        if kind in self.rivals:
            return "in a class"
        return "another" if others else "not seen"


OUTCOMES = {
    "named": "the kind alone is found, and told from the other non-linear ones",
    "likeliest": "the kind alone is found, and said to be indistinguishable from another",
    "in a class": "another is found, and said to be indistinguishable from the kind",
    "another": "another non-linear kind is found, or one too many",
    "not seen": "no non-linear damping is found",
}

# What is drawn, and of which outcomes it is the share.
SHARES = {"found": ("named", "likeliest"), "told apart": ("named",)}


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
    read = WireWound().read(np.asarray(run.columns["pivot.position"]), np.random.default_rng(trial.seed))
    return Recording("release", "", time, (Channel("pivot.position", "pivot", "position", "rad", read),))


def asked(trial: Trial) -> Answer:
    """One trial diagnosed, with a nominal model that has no damping at all."""
    result = diagnose([record(trial)], replace(rigid(damping=0.0), tolerance=0.01), only=MAY)
    found = [finding for finding in result.findings if finding.get("grade") != "possible"]
    rivals = {str(rival) for finding in found for rival in finding.get("indistinguishable_from", ())}
    return Answer(trial, tuple(str(f["effect"]) for f in found), tuple(sorted(rivals)), str(result.verdict))


def trials(
    seed: int, *, draws: int = DRAWS, releases: Sequence[float] = RELEASES, durations: Sequence[float] = DURATIONS
) -> tuple[Trial, ...]:
    """Every kind, release and length, draw by draw. A shorter recording is the beginning of a longer one; fewer draws, releases
    or lengths of one seed are a part of more."""
    made = []
    for draw in range(draws):
        for k, kind in enumerate(KINDS):
            truth = conceal(kind, np.random.default_rng([seed, draw, k]))
            for release in releases:
                noise = int(np.random.default_rng([seed, draw, k, round(release)]).integers(2**31))
                made += [Trial(truth, release, duration, noise, draw) for duration in durations]
    return tuple(made)


def left_at(trial: Trial) -> float | None:
    """When the viscous model of the first four swings has left the trial's recording [s]; None if it has not."""
    recording = record(trial)
    try:
        swings = half_swings(recording.time, recording.channels[0].values, sine=True)
    except InputError:
        return None
    return departure(swings, until=float(recording.time[-1]))


def departures(seed: int, *, draws: int = DRAWS, duration: float = 25.0) -> Study:
    """When the viscous model of the first four swings leaves the recording, by kind and release; truths as in ``damping``."""
    times: dict[tuple[str, float], list[float | None]] = {}
    for trial in trials(seed, draws=draws, durations=(duration,)):
        times.setdefault((trial.truth.kind, trial.release), []).append(left_at(trial))
    heads = ("concealed", *(f"from {release:g}°" for release in reversed(RELEASES)))
    rows = [(_words(kind), *(_range(times[kind, r], duration) for r in reversed(RELEASES))) for kind in KINDS]
    published = Series("paper", LEAVES, "published, from the horizontal", RELEASES, (PUBLISHED,) * len(RELEASES),
                       "release [°]", "time of departure [s]", style="dashed")  # fmt: skip
    series = [published]
    for kind in KINDS:
        at = [(release, t) for release in RELEASES for t in times[kind, release] if t is not None]
        series.append(replace(published, label=_words(kind), x=tuple(r for r, _ in at), y=tuple(t for _, t in at),
                              style="points"))  # fmt: skip
    numbers = {
        f"{kind}_{release:g}_{draw}": math.nan if t is None else t
        for (kind, release), found in times.items()
        for draw, t in enumerate(found)
    }
    return Study({"departure": (heads, rows)}, tuple(series), numbers)


def damping(
    seed: int,
    *,
    draws: int = DRAWS,
    quick: bool = False,
    so_far: bool = False,
    workers: int | None = None,
    progress: Progress = silent,
    journal: Journal | None = None,
) -> Study:
    """Every kind, release and length diagnosed, truths drawn from the seed. quick: one draw, from 90° alone, three lengths.

    journal: keeps each answer as it comes; what it has is not asked again, and with so_far nothing else is.
    """
    asking = (
        trials(seed, draws=1, releases=(90.0,), durations=(4.0, 10.0, 20.0)) if quick else trials(seed, draws=draws)
    )
    known = {} if journal is None else dict(journal.found)
    left = [] if so_far else [trial for trial in sorted(asking, key=_turn) if trial.key not in known]
    answers = {trial.key: answer_of(trial, known[trial.key]) for trial in asking if trial.key in known}

    def done(index: int, answer: Answer) -> None:
        answers[left[index].key] = answer
        if journal is not None:
            journal.add(left[index].key, facts_of(answer))
        progress(len(answers), len(asking), left[index].key)

    parallel_map(asked, left, workers=workers, done=done)
    return told([answers[trial.key] for trial in asking if trial.key in answers])


def _turn(trial: Trial) -> tuple[float, ...]:
    """Which trial is asked first: what was asked when a study is stopped should say most."""
    return trial.draw, ASKED_FIRST.index(trial.duration), -trial.release


def facts_of(answer: Answer) -> dict[str, Any]:
    """What an answer says, as plain values."""
    return {"found": list(answer.found), "rivals": list(answer.rivals), "verdict": answer.verdict}


def answer_of(trial: Trial, facts: Mapping[str, Any]) -> Answer:
    """The answer to a trial from its plain values."""
    return Answer(trial, tuple(facts["found"]), tuple(facts["rivals"]), str(facts["verdict"]))


def told(answers: Sequence[Answer]) -> Study:
    """Tables and curves of the answers."""
    releases = sorted({a.trial.release for a in answers}, reverse=True)
    durations = sorted({a.trial.duration for a in answers})
    by: dict[tuple[str, float, float], list[Answer]] = defaultdict(list)
    for answer in answers:
        by[answer.trial.truth.kind, answer.trial.release, answer.trial.duration].append(answer)
    kinds = [kind for kind in KINDS if any(kind == key[0] for key in by)]
    every = max(len(found) for found in by.values())
    seconds = tuple(f"{d:g} s" for d in durations)
    cells = [
        (_words(kind), f"{release:g}°", *(_cell(by[kind, release, d]) for d in durations))
        for kind in kinds
        for release in releases
    ]
    counts = [
        (
            f"{release:g}°",
            outcome,
            *(str(sum(a.outcome == outcome for kind in kinds for a in by[kind, release, d])) for d in durations),
        )
        for release in releases
        for outcome in OUTCOMES
    ]
    needs = [
        (_words(kind), *(_needed({d: by[kind, release, d] for d in durations}) for release in releases))
        for kind in kinds
    ]
    tables = {
        "open_question": (("concealed", "released at", *seconds), cells),
        "outcomes": (("released at", "outcome", *seconds), counts),
        "seconds_it_takes": (("concealed", *(f"from {release:g}°" for release in releases)), needs),
        "concealed": _concealed(answers),
    }
    shares = {
        (name, release, d): _share([[a.outcome in good for a in by[kind, release, d]] for kind in kinds], every)
        for name, good in SHARES.items()
        for release in releases
        for d in durations
    }
    records = tuple({"trial": a.trial.key, **facts_of(a), "outcome": a.outcome} for a in answers)
    numbers = {f"{name}_{release:g}_{d:g}": share for (name, release, d), share in shares.items()}
    return Study(tables, _curves(shares, releases, durations), numbers, records)


def _curves(
    shares: Mapping[tuple[str, float, float], float], releases: Sequence[float], durations: Sequence[float]
) -> tuple[Series, ...]:
    """Shares by length, a line each release, and by release, a line each length; what was not asked of all kinds is left out."""
    made = []
    for name, style in zip(SHARES, ("line", "dashed"), strict=True):
        for release in releases:
            at = [(d, shares[name, release, d]) for d in durations if not math.isnan(shares[name, release, d])]
            made.append(
                _curve(
                    "seconds it takes to know", f"{name}, from {release:g}°", at, "length of the recording [s]", style
                )
            )
        for d in durations:
            at = [(r, shares[name, r, d]) for r in sorted(releases) if not math.isnan(shares[name, r, d])]
            made.append(_curve("release it takes to know", f"{name}, {d:g} s", at, "release [°]", style))
    return tuple(line for line in made if len(line.x) > 1)


def _curve(figure: str, label: str, at: Sequence[tuple[float, float]], x_label: str, style: str) -> Series:
    x, y = tuple(x for x, _ in at), tuple(y for _, y in at)
    return Series("paper", figure, label, x, y, x_label, "share of the concealed truths", style=style)


def _concealed(answers: Sequence[Answer]) -> Table:
    truths = {(a.trial.draw, a.trial.truth.kind): a.trial.truth for a in answers}
    rows = [
        (
            str(draw + 1),
            _words(kind),
            f"{100.0 * truth.share:.0f} %",
            f"{truth.viscous:.3g}",
            ", ".join(f"{name} {value:.3g}" for name, value in truth.parameters),
        )
        for (draw, kind), truth in truths.items()
    ]
    return ("draw", "kind", "share of the first loss", "viscous [N·m·s]", "parameters"), rows


def _share(held: Sequence[Sequence[bool]], every: int) -> float:
    """Share over all kinds, ``every`` answers of each; nan where some were not asked, which would be a share of other things."""
    return float(np.mean(held)) if all(len(answers) == every for answers in held) else math.nan


def _words(name: str) -> str:
    return name.replace("_", " ")


def _range(times: Sequence[float | None], duration: float) -> str:
    """Times of departure of all draws, told together."""
    known = [t for t in times if t is not None]
    never = len(times) - len(known)
    if not known:
        return f"not in {duration:g} s"
    low, high = f"{min(known):.1f}", f"{max(known):.1f}"
    span = f"{low} s" if low == high else f"{low} to {high} s"
    return span + (f", {never} of {len(times)} not in {duration:g} s" if never else "")


def _cell(answers: Sequence[Answer]) -> str:
    """What all draws of one kind gave; another kind by its name."""
    said: list[str] = []
    for answer in answers:
        word = answer.outcome
        if word in ("another", "in a class"):
            others = [effect for effect in answer.found if effect in KINDS]
            word += ": " + (" + ".join(map(_words, others)) or "viscous damping alone")
        said.append(word)
    if not said:
        return "not asked"
    return "; ".join(f"{count} {word}" if count > 1 else word for word, count in Counter(said).items())


def _needed(by_duration: Mapping[float, Sequence[Answer]]) -> str:
    """The length from which on the kind is found alone in every draw."""
    by_duration = {d: answers for d, answers in by_duration.items() if answers}
    good = [d for d in sorted(by_duration) if all(a.outcome in ("named", "likeliest") for a in by_duration[d])]
    needed = math.inf
    for duration in sorted(by_duration, reverse=True):
        if duration not in good:
            break
        needed = duration
    if not by_duration:
        return "not asked"
    return f"{needed:g} s" if math.isfinite(needed) else f"more than {max(by_duration):g} s"
