"""An answer of efforts in plain words."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from harness.diagnose.answer.explain import (
    Foretold,
    estimate,
    finding_words,
    holding_up,
    left_in_words,
    listed,
    times,
    untold,
)
from harness.diagnose.answer.left_out import LeftOut
from harness.diagnose.answer.taken_away import none_left
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.inverse.pushes import Push
from harness.recording.recording import Recording
from harness.recording.units import written

ONCE = "acts once"  # in the name of a test that tells a push from outside


@dataclass(frozen=True, eq=False)
class InWords:
    """A finding to be told. others: titles of what it cannot be told from."""

    title: str
    site: str
    values: dict[str, Estimate]
    units: dict[str, str]
    others: Sequence[str] = ()


def gathered(found: Sequence[InWords]) -> list[str]:
    """Findings in words; those of one number that are found at several joints are told together, with the number's name once."""
    out = []
    for title, alike in _by(found, lambda f: f.title).items():
        names = {name for f in alike for name in f.values}
        units = {written(unit) for f in alike for unit in f.units.values()}
        if len(alike) == 1 or len(names) != 1 or len(units) != 1:
            out += [finding_words(f.title, f.site, f.values, f.units) for f in alike]
            continue
        (unit,) = units
        each = [
            f"{f.site} ({none_left(title, *read, unit) or estimate(*read, unit)})"
            for f in alike
            for e in f.values.values()
            for read in [(e.value, e.std, (e.low, e.high))]
        ]
        out.append(f"{title} at {listed(each)}")
    return out


def untold_together(found: Sequence[InWords]) -> list[str]:
    """What findings cannot be told from, in a sentence for all of a kind that have the same."""
    unsure = [f for f in found if f.others]
    return [
        untold(title, listed([f.site for f in alike]), others)
        for (title, others), alike in _by(unsure, lambda f: (f.title, tuple(f.others))).items()
    ]


def _by(found: Sequence[InWords], key: Callable[[InWords], Hashable]) -> dict[Any, list[InWords]]:
    out: dict[Any, list[InWords]] = {}
    for one in found:
        out.setdefault(key(one), []).append(one)
    return out


def summary(
    verdict: str, severity: float, cutoff: float, firm: Sequence[str], rivals: Sequence[str], foretold: Foretold,
    explained: float | None, left: LeftOut | None, *, hurried: bool = False, beside: bool = False,
) -> str:  # fmt: skip
    """The sentences about what was found and what is left.

    severity: of the nominal model [standard deviations of noise]; cutoff: of the low-pass [Hz]; firm: findings in words that are
    more than possible; explained: share of the mismatch on data held out that all of them remove; hurried: whether the time was
    up before all was tried; beside: whether the table has what is only possible beside the firm.
    """
    size = f"by {times(severity)} times the noise"
    off = f"The effort that the nominal model needs for the recorded motion leaves the recorded one {size}"
    band = f"below {cutoff:.2g} Hz, where accelerations can be read off the recorded angle"
    if verdict == "consistent":
        return f"The effort that the model needs for the recorded motion agrees with the recorded one ({band})."
    if verdict == "explained" and not firm:
        text = f"{off} ({band}); what is told as possible in the table leaves the noise alone, also on data held out."
    elif verdict == "explained":
        text = f"{off} ({band}); with {' and '.join(firm)} the residual is at the noise, also on data held out."
    elif firm and verdict != "unexplained":
        text = f"{off} ({band}); {holding_up(firm, explained, beside=beside)}."
    else:
        sure = "" if verdict == "unexplained" else " for certain"
        nothing = f"nothing in the catalogue earns its place{sure}"
        text = f"{off} ({band}), and {'nothing has earned its place so far' if hurried else nothing}."
    sentences = [text]
    if left is not None and verdict != "explained":
        sentences += left_in_words(left, foretold, "the noise")
    return " ".join([*sentences, *rivals])


def may_be_one_force(titles: Sequence[str]) -> str:
    """What a force over the position does for as well, in a sentence; none where that is nothing."""
    if not titles:
        return ""
    *others, last = (title[0].lower() + title[1:] if k else title for k, title in enumerate(titles))
    told = f"{', '.join(others)} and {last} may be" if others else f"{last} may be"
    return f"{told[0].upper()}{told[1:]} one force over the position that nobody has named, as of a balancing spring or a cable."


def pushed(pushes: Sequence[Push], recordings: Sequence[Recording], unit: str) -> str:
    """What something outside did, in a sentence; none without it. unit: of the joint that is pushed most."""
    if not pushes:
        return ""
    worst = max(pushes, key=lambda p: abs(p.peak))
    stretches = "stretches" if len(pushes) > 1 else "stretch"
    return (
        f"Something outside pushes in {len(pushes)} {stretches}, most in {recordings[worst.run].name} at {worst.first:.1f} s "
        f"with {-worst.peak:+.2g} {unit}; that is left out of every fit."
    )


def shown_as(tests: Sequence[Mapping[str, Any]]) -> str:
    """What is left shows as, in a sentence; none where it is pushes alone."""
    others = [t for t in tests if ONCE not in t["what"]]
    if not others:
        return ""
    # The joint is told by where it is.
    first, places = others[0]["what"], list(filter(None, others[0]["where"]))
    for place in places:
        first = first.removesuffix(f" at {place}")
    return f"What is left shows as {first}" + (f" ({', '.join(places)})." if places else ".")
