"""Scores what diagnosis said against the sealed answers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.stats import binomtest

from harness.diagnose.answer.diagnosis import one_by_one
from harness.proof.alike import as_well, believed
from harness.proof.apart import apart

SENSOR_EFFECTS = (
    "sensor_offset", "sensor_gain", "sensor_delay", "sensor_lowpass", "sensor_highpass", "sensor_nonlinearity",
    "sensor_drift", "sensor_saturation", "sensor_hum", "sensor_zero", "clock_skew",
)  # fmt: skip
INPUT_EFFECTS = (
    "actuator_gain",
    "servo_gain",
    "servo_torque",
    "actuator_delay",
    "actuator_deadzone",
    "actuator_saturation",
)
NOT_EXPLAINED = ("unexplained", "partly_explained")
AT_FLOOR = 1.2  # held-out residual over the noise floor that still counts as explained


def side_of(effect: str) -> str:
    """Where an effect acts: dynamics, sensor or input."""
    if effect in SENSOR_EFFECTS:
        return "sensor"
    return "input" if effect in INPUT_EFFECTS else "dynamics"


@dataclass(frozen=True)
class Share:
    """A count with its Wilson 95 % interval."""

    hits: int
    of: int

    @property
    def value(self) -> float:
        return self.hits / self.of if self.of else float("nan")

    @property
    def interval(self) -> tuple[float, float]:
        if not self.of:
            return (float("nan"), float("nan"))
        ci = binomtest(self.hits, self.of).proportion_ci(method="wilson")
        return (float(ci.low), float(ci.high))

    def __str__(self) -> str:
        if not self.of:
            return "none tried"
        low, high = self.interval
        return f"{self.hits} of {self.of} ({100 * self.value:.0f} %, {100 * low:.0f}–{100 * high:.0f} %)"


@dataclass(frozen=True)
class CaseScore:
    """How one case went.

    exact: the set of effects and sites is the planted one; in_class: it is, once every finding may be replaced by one that
    it was said to be indistinguishable from, as far as that is believed (``alike.believed``). missed, false: planted effects not
    found, findings not planted (neither themselves nor through their class). listed: of every finding, among how many it is told,
    itself included. parameters: (effect, name, true, value, std, low, high). floor: held-out over noise floor;
    held_fitted: whether that is no prediction, since a finding shows in the data held out alone and is fitted to them, too.
    outside: what was concealed if it is not of the catalogue; apart: how far what was told is from it, in noise, if it was told as
    explained.
    """

    name: str
    kind: str
    verdict: str
    planted: tuple[tuple[str, str], ...]
    found: tuple[tuple[str, str], ...]
    visibility: tuple[float, ...]
    exact: bool
    in_class: bool
    missed: tuple[tuple[str, str], ...]
    false: tuple[tuple[str, str], ...]
    side_right: bool | None
    site_right: bool | None
    parameters: tuple[tuple[str, str, float, float, float, float, float], ...] = ()
    floor: float = float("nan")
    seconds: float = float("nan")
    error: str = ""
    outside: str = ""
    apart: float = float("nan")
    held_fitted: bool = False
    listed: tuple[int, ...] = ()

    @property
    def worth(self) -> float:
        """Discounted accuracy: 1 over the number of sets of effects that what was said leaves open, 0 where none is the truth.

        Who lists what does not belong there loses as much as by guessing: see Zaffalon, Corani and Mauá, Int. J. Approx. Reason.
        53 (2012) 1282.
        """
        return float(1.0 / np.prod(self.listed)) if self.in_class else 0.0

    @property
    def right(self) -> bool:
        """Whether what was said is what should have been said: named in class, nothing where nothing is, or not explained."""
        if self.kind == "outside":
            return self.verdict in NOT_EXPLAINED
        if self.planted:
            return self.in_class
        return not self.found and self.verdict == "consistent"


def score_case(name: str, answer: Mapping[str, Any], found: Mapping[str, Any]) -> CaseScore:
    """Compare one diagnosis (``denoc.diagnosis/1`` as data, or {"error": …}) with its sealed answer."""
    outside = answer["kind"] == "outside"
    planted = () if outside else tuple((p["effect"], p["site"]) for p in answer["planted"])
    strange = str(answer["planted"][0]["effect"]) if outside and answer["planted"] else ""
    if "error" in found:
        return CaseScore(
            name, answer["kind"], "error", planted, (), tuple(answer["visibility"]), False, False, planted, (),
            None, None, error=str(found["error"]), outside=strange,
        )  # fmt: skip
    # What is only possible is no claim.
    findings = [f for f in one_by_one(found["findings"]) if f.get("grade") != "possible"]
    named = tuple((f["effect"], f["site"]) for f in findings)
    left = list(planted)
    others = []
    for f in findings:
        item = (f["effect"], f["site"])
        if item in left:
            left.remove(item)
        else:
            others.append(f)
    false = []
    for f in others:
        match = next((p for p in left if believed(f, *p)), None)
        if match is None:
            false.append((f["effect"], f["site"]))
        else:
            left.remove(match)
    exact = set(named) == set(planted) and len(named) == len(planted)
    in_class = not left and not false
    mismatch = found.get("mismatch", [])
    sides = {m.get("side") for m in mismatch} | {side_of(e) for e, _ in named}
    sites = {m.get("site") for m in mismatch} | {s for _, s in named}
    side_right = site_right = None
    if len(planted) == 1:
        side_right = side_of(planted[0][0]) in sides
        site_right = planted[0][1] in sites
    values = []
    truth = {(p["effect"], p["site"]): p["parameters"] for p in answer["planted"]}
    for f in findings:
        true = truth.get((f["effect"], f["site"]))
        if true is None:
            continue
        for parameter, estimate in f["parameters"].items():
            if parameter not in true or estimate.get("ci95") is None:
                continue
            low, high = estimate["ci95"]
            std = estimate.get("std")
            concealed, value = float(true[parameter]), float(estimate["value"])
            if parameter == "phase":
                # The same phase a whole turn on.
                concealed += 2.0 * np.pi * round((value - concealed) / (2.0 * np.pi))
            values.append(
                (
                    f["effect"], parameter, concealed, value,
                    float("nan") if std is None else float(std), float(low), float(high),
                )
            )  # fmt: skip
    ratios = [
        c["augmented"]["heldout_rmse"] / c["noise_floor"]
        for c in found.get("fit", [])
        if c.get("noise_floor") and c["augmented"].get("heldout_rmse") is not None
    ]
    return CaseScore(
        name, answer["kind"], found["verdict"], planted, named, tuple(answer["visibility"]), exact, in_class,
        tuple(left), tuple(false), side_right, site_right, tuple(values), max(ratios, default=float("nan")),
        float(found.get("seconds", float("nan"))), outside=strange, apart=apart(answer, found.get("predicted", ())),
        held_fitted=any(f.get("shows_only_in") for f in findings),
        listed=tuple(1 + sum(1 for _ in as_well(f)) for f in findings),
    )  # fmt: skip


@dataclass(frozen=True)
class Summary:
    """Shares over all cases; effects in pairs and triples count as visible above twice the detection limit each.

    at_floor: of what is called explained and says how well, without those cases whose data held out have been fitted to.
    clean_false: of clean cases that were answered. told_in_vain: of cases with nothing outside the catalogue, those told as not or
    not wholly explained; who says so everywhere has all of ``outside_told``.
    outside_apart_told: of what is outside the catalogue, without those cases in which a model told as explaining them is nearer to
    the truth than twice the limit: what nobody could have told from it.
    """

    named_single: Share
    named_single_exactly: Share
    named_pairs: Share
    named_triples: Share
    clean_false: Share
    outside_told: Share
    outside_apart_told: Share
    told_in_vain: Share
    coverage95: Share
    at_floor: Share
    side_right: Share
    site_right: Share
    false_anywhere: Share
    failed: Share
    confusion: dict[str, dict[str, int]] = field(default_factory=dict)
    confusion_right: dict[str, dict[str, int]] = field(default_factory=dict)
    parameter_error: dict[str, float] = field(default_factory=dict)
    detection: dict[str, list[tuple[float, bool]]] = field(default_factory=dict)


def summarise(scores: Sequence[CaseScore], limit: float) -> Summary:
    """Shares, confusion matrix, parameter errors and detection points.

    limit: the detection limit; singles, pairs and triples are judged where every visibility is above twice the limit.
    """

    def visible(s: CaseScore) -> bool:
        return bool(s.visibility) and min(s.visibility) >= 2.0 * limit

    def share(hits: Sequence[bool]) -> Share:
        return Share(sum(hits), len(hits))

    single = [s for s in scores if s.kind == "single" and visible(s)]
    pairs = [s for s in scores if s.kind == "pair" and visible(s)]
    triples = [s for s in scores if s.kind == "triple" and visible(s)]
    clean = [s for s in scores if s.kind == "clean" and s.verdict != "error"]
    outside = [s for s in scores if s.kind == "outside" and visible(s)]
    within = [s for s in scores if s.kind != "outside" and s.verdict != "error"]
    inside = [t[5] <= t[2] <= t[6] for s in scores if s.in_class and s.verdict == "explained" for t in s.parameters]
    explained = [s for s in scores if s.verdict == "explained" and s.kind != "outside"]
    confusion: dict[str, Counter[str]] = {}
    right: dict[str, Counter[str]] = {}
    for s in scores:
        row = "nothing" if s.kind == "clean" else "outside" if s.kind == "outside" else None
        if s.kind == "single":
            row = s.planted[0][0]
        if row is None:
            continue
        told = [e for e, _ in s.found] or [s.verdict]
        for name in told:
            confusion.setdefault(row, Counter())[name] += 1
            right.setdefault(row, Counter())[name] += s.right
    errors: dict[str, list[float]] = {}
    for s in scores:
        for effect, name, true, value, *_ in s.parameters:
            if true:
                errors.setdefault(f"{effect}.{name}", []).append(abs(value - true) / abs(true))
    detection: dict[str, list[tuple[float, bool]]] = {}
    for s in scores:
        if s.kind == "single":
            detection.setdefault(s.planted[0][0], []).append((s.visibility[0], s.in_class))
    return Summary(
        named_single=share([s.in_class for s in single]),
        named_single_exactly=share([s.exact for s in single]),
        named_pairs=share([s.in_class for s in pairs]),
        named_triples=share([s.in_class for s in triples]),
        clean_false=share([bool(s.found) or s.verdict != "consistent" for s in clean]),
        outside_told=share([s.right for s in outside]),
        outside_apart_told=share([s.right for s in outside if s.right or not s.apart < 2.0 * limit]),
        told_in_vain=share([s.verdict in NOT_EXPLAINED for s in within]),
        coverage95=share(inside),
        at_floor=share([s.floor <= AT_FLOOR for s in explained if not s.held_fitted and np.isfinite(s.floor)]),
        side_right=share([bool(s.side_right) for s in single if s.side_right is not None]),
        site_right=share([bool(s.site_right) for s in single if s.site_right is not None]),
        false_anywhere=share([bool(s.false) for s in scores if s.kind != "outside"]),
        failed=share([s.verdict == "error" for s in scores]),
        confusion={row: dict(counts) for row, counts in sorted(confusion.items())},
        confusion_right={row: dict(counts) for row, counts in sorted(right.items())},
        parameter_error={k: float(np.median(v)) for k, v in sorted(errors.items())},
        detection=detection,
    )
