"""Which undone slips would make a parameter table agree, ranked by misfit and by the price of the slips."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from harness.system.audit_evidence import CONTRADICTION, evaluate, own_frequencies
from harness.system.audit_findings import Change, Correction
from harness.system.audit_tables import LENGTHS
from harness.system.slips import Slip, slips

# A hundred thousand times less likely than the best [nats] is not worth a look.
LOST = 12.0
SHOWN = 8
TIED = 1e-6  # in the score, within which corrections are one as good as the other
# What a quantity of the audit is called in a model file.
IN_FILES = {"hub_inertia": "armature"}

_Changes = tuple[tuple[str, Slip], ...]


@dataclass(frozen=True)
class _Trial:
    """A set of undone slips: their cost, and the score without and with frequencies (inf where not worth computing)."""

    changes: _Changes
    cost: float
    plain: float
    score: float


def correct(name: str, table: Mapping[str, float], heard: Sequence[float]) -> list[Correction]:
    """The best sets of one or two undone slips, of three where two do not suffice; ranked, the table as it stands too."""
    trials = [_try(table, heard, (), 0.0, math.inf)]

    def extend(bases: Sequence[_Trial]) -> None:
        best = min(trial.score for trial in trials)
        for base in bases:
            touched = {key for key, _ in base.changes}
            for changes, cost in singles:
                if base.cost + cost > best + LOST or touched & {key for key, _ in changes}:
                    continue
                key = _key(base.changes + changes)
                if key not in seen:
                    seen.add(key)
                    trial = _try(table, heard, base.changes + changes, base.cost + cost, best)
                    best = min(best, trial.score)
                    trials.append(trial)

    singles = _singles(table)
    seen = {_key(())}
    extend(trials[:1])
    pairs_from = len(trials)
    extend(trials[1:pairs_from])
    first = min(trials, key=lambda t: t.score)
    if not _correction(name, table, heard, first, 1.0).agrees:
        # Two do not suffice. A third is tried on the best pairs only: best at all, and best before frequencies, which
        # a third may mend.
        pairs = trials[pairs_from:]
        chosen = sorted(pairs, key=lambda t: t.score)[:100] + sorted(pairs, key=lambda t: t.plain)[:200]
        extend(list(dict.fromkeys(chosen)))
    ranked = sorted(trials, key=lambda t: t.score)
    total = sum(math.exp(ranked[0].score - trial.score) for trial in ranked)
    shown = [trial for trial in ranked if math.isfinite(trial.score)]
    if len(shown) > SHOWN:
        # Those that are as good as the last one shown are shown as well.
        shown = [trial for trial in shown if trial.score <= shown[SHOWN - 1].score + TIED]
    ranks = [1 + sum(other.score < trial.score - TIED for other in shown) for trial in shown]
    return [
        _correction(name, table, heard, trial, math.exp(ranked[0].score - trial.score) / total, rank)
        for trial, rank in zip(shown, ranks, strict=True)
    ]


def _singles(table: Mapping[str, float]) -> list[tuple[_Changes, float]]:
    singles: list[tuple[_Changes, float]] = []
    for key, value in table.items():
        singles += [(((key, slip),), slip.cost) for slip in slips(value, length=key in LENGTHS)]
    # One slip for all lengths at once: the whole drawing in millimetres or centimetres.
    for factor, unit in ((1e-3, "mm"), (1e-2, "cm")):
        together = tuple((key, Slip(table[key] * factor, f"lengths in {unit}", 0.0)) for key in LENGTHS)
        singles.append((together, math.log(100.0 * 2.0)))
    return singles


def _key(changes: _Changes) -> frozenset[tuple[str, float]]:
    return frozenset((quantity, round(math.log(slip.value), 9)) for quantity, slip in changes)


def _corrected(table: Mapping[str, float], changes: _Changes) -> dict[str, float]:
    return dict(table) | {key: slip.value for key, slip in changes}


def _try(table: Mapping[str, float], heard: Sequence[float], changes: _Changes, cost: float, best: float) -> _Trial:
    """Score a set of slips; without frequencies if it is lost before them."""
    terms, _ = evaluate(_corrected(table, changes), heard, worst=2.0 * (best + LOST - cost))
    plain = cost + 0.5 * sum(value for key, value in terms.items() if not key.startswith("frequency"))
    score = cost + 0.5 * sum(terms.values())
    if any(not math.isnan(f) for f in heard) and plain > best + LOST:
        score = math.inf
    return _Trial(changes, cost, plain, score)


def _correction(
    name: str, table: Mapping[str, float], heard: Sequence[float], trial: _Trial, probability: float, rank: int = 1
) -> Correction:
    corrected = _corrected(table, trial.changes)
    terms, facts = evaluate(corrected, heard)
    return Correction(
        site=name,
        rank=rank,
        changes=tuple(Change(IN_FILES.get(key, key), table[key], slip.value, slip.what) for key, slip in trial.changes),
        score=trial.score,
        probability=probability,
        agrees=all(term <= CONTRADICTION for key, term in terms.items() if key != "rarity"),
        density=facts.density,
        material=facts.material,
        frequencies=own_frequencies(corrected, facts.mass, max(len(heard), 1)),
    )
