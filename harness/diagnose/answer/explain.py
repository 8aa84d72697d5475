"""A diagnosis in plain words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from harness.diagnose.answer.against_nominal import beyond_nominal, worse_than_nominal
from harness.diagnose.answer.constants import (
    NEARLY_ALL_SHARE,
    PLAINLY_BETTER_ERROR,
    POSSIBLY_EXPLAINED_SHARE,
    TELLING_GAIN_SHARE,
    WITHIN_TOLERANCES_SHARE,
)
from harness.diagnose.answer.left_out import LeftOut
from harness.diagnose.answer.significant_digits import estimate
from harness.diagnose.answer.taken_away import none_left
from harness.diagnose.claims.conclude import Conclusion
from harness.diagnose.claims.cut_short import UNCRITICISED, UNJUDGED, UNSEARCHED
from harness.diagnose.criticism.check import Test
from harness.diagnose.criticism.constants import COMPLETE_RESIDUAL_RATIO, TEST_CHANCE
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.problem.deadline import NotTried
from harness.recording.units import written

VERDICTS = {
    "consistent": "The model and the recordings agree: what is left is at the level of the noise, and no effect of the catalogue "
    "earns a place.",
    "explained": "The nominal model {leaves}; with {names} the residual is at the noise floor, {held}.",
    "partly_explained": "The nominal model {leaves}; {names} {hold} up on data held out, but {rest}.",
    "unexplained": "The nominal model {leaves}, and nothing in the catalogue earns its place.",
}
NONE_FOR_CERTAIN = "The nominal model {leaves}, and nothing in the catalogue earns its place for certain."
NONE_SO_FAR = "The nominal model {leaves}, and nothing has earned its place so far."
POSSIBLY = "Possibly it is {names}: that would remove {share} of the mismatch on data held out, but {doubt}."
UNNAMED_COULD = "a force over position and speed that nobody has named could do the same"
UNWEIGHED = "what else could do the same has not been gone through"
BESIDE = "what is told as possible in the table"  # of findings that are told, others that are not
UNSURE = "that it is this, and not something that does nearly the same, is not sure"

# The same where the time was up before that could be said.
CUT_SHORT = {
    UNSEARCHED: "Nothing significant has been found missing so far, but not all was tried: that does not prove the model right.",
    UNJUDGED: "The nominal model {leaves}. {best}; {judged}, so nothing is claimed.",
}


NO_FINDING = "nothing of what was found"  # that what was not tried may change


def finding_words(
    title: str,
    site: str,
    values: dict[str, Estimate],
    units: dict[str, str],
    further: Sequence[str] = (),
    plainer: Sequence[str] = (),
) -> str:
    """One finding with its parameters and further numbers in words; plainer: titles of plainer laws that it may be as well.

    That nothing is left of what the model states is said instead of a negative number at its bound.
    """
    parts = list(further)
    for name, e in values.items():
        unit = written(units[name])
        number = f"{name.replace('_', ' ')} {estimate(e.value, e.std, (e.low, e.high), unit)}"
        parts.append(none_left(title, e.value, e.std, (e.low, e.high), unit) or number)
    said = ", ".join(parts)
    if plainer:
        fits = f"the {'latter' if len(plainer) == 1 else 'last'} fits best"
        return f"{', '.join(plainer)} or {title} at {site} ({': '.join(filter(None, [fits, said]))})"
    return f"{title} at {site} ({said})" if said else f"{title} at {site}"


class Foretold(NamedTuple):
    """The channel of the data held out that is predicted worst: how many times its noise is left, and that in its unit."""

    times: float = 0.0
    error: float = 0.0
    channel: str = ""
    unit: str = ""

    @classmethod
    def worst(cls, rows: Sequence[Mapping[str, Any]]) -> Foretold:
        """Of errors of every channel, as in an answer's ``fit``."""
        each = [(r["augmented"]["heldout_rmse"], r) for r in rows]
        found = [cls(error / r["noise_floor"], error, r["channel"], r["unit"]) for error, r in each]
        return max(found, key=lambda f: f.times, default=cls())


def summary(
    conclusion: Conclusion, severity: float, findings: Sequence[str], rivals: Sequence[str], foretold: Foretold,
    explained: float | None = None, left: LeftOut | None = None, possible: Sequence[str] = (), *, beside: bool = False,
    within: float | None = None, astray: bool = False,
) -> str:  # fmt: skip
    """The paragraph.

    severity: greatest error of the nominal model over all channels [standard deviations of noise]; foretold: on data held out.
    explained: share of the mismatch there that all in the table removes. left: the force that it leaves out. possible: plain laws
    that may be told where nothing is found for certain. beside: whether the table has what is only possible beside the findings.
    within: ``severity`` once the nominal model's quantities are fitted within their tolerances. astray: whether it leaves the
    recordings by more than they vary.
    """
    noise = "the noise" if left is None else "the sensors' noise"
    leaves = _leaves(severity, noise, None if findings else within, astray=astray)
    if left is not None:
        return " ".join(
            [*_beside_a_force(conclusion, leaves, findings, foretold, explained, left, possible, beside), *rivals]
        )
    if severity <= 1.05 and not astray:
        leaves = "leaves the recordings by less than the noise, but significantly"
    rest = "a significant remainder stays"
    if not conclusion.remains.significant and not conclusion.doubted:
        rest = f"these are not yet predicted down to the noise ({times(conclusion.level, 2)} times it)"
    hold = "hold" if len(findings) > 1 else "holds"
    held = "also on data held out"
    if conclusion.only_held:
        held = "with the data held out fitted too"
    elif conclusion.loosely:
        alone = f"their likeliest values alone predict those to {times(foretold.times, 2)} times the noise"
        held = f"also on data held out, as far as the training recordings fix the numbers; {alone}"
    elif foretold.times > COMPLETE_RESIDUAL_RATIO:
        without = f"they are predicted to {times(foretold.times, 2)} times the noise"
        held = f"on data held out if fitted to them too; without that, {without}"
    if conclusion.cut_short == UNCRITICISED:
        rest = "what is left has not been examined to the end"
    names = " and ".join(findings)
    if beside and conclusion.verdict == "explained":
        names += f", and {BESIDE},"
    text = CUT_SHORT.get(conclusion.cut_short, VERDICTS[conclusion.verdict])
    if not findings and "{names}" in text:
        text = _nothing_for_certain(conclusion, possible, explained, UNWEIGHED if conclusion.hurried else UNSURE)
    elif conclusion.hurried and text == VERDICTS["unexplained"]:
        text = NONE_SO_FAR
    text = text.format(**_so_far(conclusion, explained), leaves=leaves, names=names, hold=hold, rest=rest, held=held)
    if rivals:
        text += " " + " ".join(rivals)
    if conclusion.only_held:
        text += (
            f" The data held out alone show {', '.join(conclusion.only_held)}: it is told because every second stretch of them "
            "predicts the stretches between, and errors there are those of a fit to all recordings."
        )
    if conclusion.unproven:
        text += (
            f" No data that it was not fitted to bear out {', '.join(conclusion.unproven)}, or less than a thousandth of what "
            "another effect does is left to it, so that is not claimed."
        )
    if conclusion.imitated:
        text += f" The remainder could have imitated {', '.join(conclusion.imitated)}, so that is not claimed."
    if conclusion.remains.significant and conclusion.remains.tests:
        test = plainest(conclusion)
        where = ", ".join(w for w in test.where if w)
        text += f" What is left shows as {test.name.split(' at ')[0]}" + (f" ({where})." if where else ".")
    return text


def _beside_a_force(
    conclusion: Conclusion, leaves: str, findings: Sequence[str], foretold: Foretold, explained: float | None, left: LeftOut,
    possible: Sequence[str], beside: bool,
) -> list[str]:  # fmt: skip
    """Sentences where the model leaves a force out that is more than noise: what is explained, what is left, where that lies."""
    if findings:
        text = f"The nominal model {leaves}; {holding_up(findings, explained, beside=beside)}."
    elif conclusion.cut_short == UNJUDGED:
        text = CUT_SHORT[UNJUDGED].format(**_so_far(conclusion, explained, beside=True), leaves=leaves)
    else:
        doubt = UNWEIGHED if conclusion.cut_short else UNNAMED_COULD
        text = _nothing_for_certain(conclusion, possible, explained, doubt).format(leaves=leaves)
    sentences = [text, *left_in_words(left, foretold, "the sensors' noise")]
    differing = [f"{one.between:.2g} {written(one.unit)} at {one.joint}" for one in left.joints if one.between > 0.0]
    if differing:
        sentences.append(
            f"Friction differs from recording to recording, by {' and '.join(differing)} (standard deviation)."
        )
    gains = [f"{percent(one.gain)} at {one.joint}" for one in left.joints if one.gain > 0.0]
    if gains:
        sentences.append(
            f"What efforts do differs from recording to recording, by {' and '.join(gains)} (standard deviation), as of a drive "
            "that warms up or a supply that sags."
        )
    if conclusion.doubted:
        sentences.append(f"What it could have imitated is not claimed: {', '.join(conclusion.doubted)}.")
    return sentences


def _so_far(conclusion: Conclusion, explained: float | None, *, beside: bool = False) -> dict[str, str]:
    """The best set of a search whose sets were not judged, and how far it is known to go.

    beside: a force that is left out, which is told with what it leaves of the worst channel: all channels at once are another
    measure.
    """
    keys = " + ".join(conclusion.best.hypothesis.keys) or "nothing"
    judged = "it has not been judged on data held out"
    if explained is not None and explained > 0.0:
        share = percent(explained)
        judged = f"it removes {share} of the mismatch on data held out, but which of its effects stand there was not examined"
    return {
        "best": f"The best set so far is {keys}"
        + ("" if beside else f", and leaves {times(conclusion.level)} times the noise"),
        "judged": judged,
    }


def _nothing_for_certain(conclusion: Conclusion, possible: Sequence[str], explained: float | None, doubt: str) -> str:
    """Sentences where nothing is firm, wherever the time ended: what the table has of laws that remove most is told as possible.

    Where the catalogue was not gone through, it is not said to hold nothing: what was not tried has failed at nothing.
    """
    return (NONE_SO_FAR if conclusion.hurried else NONE_FOR_CERTAIN) + _possibly(possible, explained, doubt)


def _possibly(possible: Sequence[str], explained: float | None, doubt: str) -> str:
    """Laws that are no more than possible, as a further sentence where they remove most of the mismatch; else nothing."""
    if not possible or explained is None or explained <= POSSIBLY_EXPLAINED_SHARE:
        return ""
    return " " + POSSIBLY.format(names=" and ".join(possible), share=percent(explained), doubt=doubt)


def _leaves(severity: float, noise: str, within: float | None, *, astray: bool) -> str:
    """By how much the nominal model leaves recordings; ``severity`` is nan where time was up before errors were worked out.

    Of one that goes astray, a number would only tell how far it has got. What its tolerances allow is told where they allow most.
    """
    text = "leaves the recordings to an extent that has not been worked out"
    if astray:
        text = "does not follow the recordings, which it leaves by more than they vary"
    elif severity >= 0.0:
        text = f"leaves the recordings by {times(severity)} times {noise}"
    if within is not None and within < WITHIN_TOLERANCES_SHARE * severity:
        text += f" (within its tolerances it leaves {times(within, 2)} times {noise})"
    return text


def holding_up(findings: Sequence[str], explained: float | None, *, beside: bool = False) -> str:
    """Findings, and what share of the mismatch on data held out they remove, as half a sentence.

    beside: whether they do so together with what is only possible.
    """
    several = len(findings) > 1
    share = ""
    if explained is not None and explained > 0.0:
        removes = "remove" if several else "removes"
        share = f" and{f', with {BESIDE},' if beside else ''} {removes} {percent(explained)} of the mismatch there"
    return f"{' and '.join(findings)} {'hold' if several else 'holds'} up on data held out{share}"


def left_in_words(left: LeftOut, foretold: Foretold, noise: str) -> list[str]:
    """What is left of the data held out: in the channel's unit, against noise of this name, and as a force; and where it lies.

    The force is told where it is largest against what else acts there, which may be at another joint than what is read worst:
    each then has a sentence of its own.
    """
    force = left.largest
    size = f"a force of {force.size:.2g} {written(force.unit)}"
    natural = "the largest that gravity or inertia make there"
    share = f"{percent(force.share)} of {natural}" if force.share <= 1.0 else f"{times(force.share, 2)} times {natural}"
    kept = f"which keeps for {'no longer than' if force.fleeting else 'about'} {force.memory:.2g} s"
    error = _error(foretold, noise)
    here = f"{foretold.channel}.".startswith(f"{force.joint}.")
    if not foretold.channel or not error or here:
        colon = f"{error}: " if error else ""
        sentences = [f"What is left of the data held out is {colon}{size} at {force.joint}, {share}, {kept}."]
    else:
        sentences = [
            f"What is left of the data held out is {error}.",
            f"Against what else acts at a joint, most is left at {force.joint}: {size}, {share}, {kept}.",
        ]
    if left.place is not None:
        share = percent(left.place.share)
        sentences.append(
            f"{share[:1].upper()}{share[1:]} of it lies at {left.place.joint} {left.place.where}, in "
            f"{percent(left.place.of_time)} of the time."
        )
    return sentences


def _error(foretold: Foretold, noise: str) -> str:
    """What is left, in the channel's unit and against its noise; nothing where that was not worked out."""
    if not foretold.times > 0.0:
        return ""
    against = f"{times(foretold.times, 2)} times {noise}"
    if not foretold.channel:
        return against
    return f"{foretold.error:.2g} {written(foretold.unit)} at {foretold.channel}, {against}"


def times(value: float, count: int = 3) -> str:
    """How many times, with so many digits and no exponent."""
    return f"{float(f'{value:.{count}g}'):,.12g}"


def foretelling(keys: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> str:
    """The set that predicts best by the training recordings, in a sentence, where data held out say what it is worth; or nothing.

    They may say that it predicts plainly better than what is claimed, or that it is plainly worse than the nominal model.
    rows: errors of every channel, of the nominal model, of what is claimed and, where it foretells the channel, of that set.
    """
    # Second encoders are explained beside the motion, which that set says nothing of.
    rows = [row for row in rows if "predictive" in row]
    row = worse_than_nominal(rows, "predictive", PLAINLY_BETTER_ERROR)
    if row is not None:
        what = " + ".join(keys) or "the nominal model with its quantities fitted"
        return (
            f"What predicts best by the training recordings, {what} (predictive.toml), {beyond_nominal(row, 'predictive')}: what "
            "those recordings teach does not carry over to these data."
        )
    better = [
        r for r in rows if r["predictive"]["heldout_rmse"] < PLAINLY_BETTER_ERROR * r["augmented"]["heldout_rmse"]
    ]
    if not better or not keys:
        return ""
    row = better[0]
    errors = [f"{row[name]['heldout_rmse']:.2g}" for name in ("predictive", "augmented")]
    return (
        f"Best predicts, by the training recordings, {' + '.join(keys)} (predictive.toml): of the data held out it leaves "
        f"{errors[0]} {written(row['unit'])} at {row['channel']}, what is claimed {errors[1]}."
    )


def untold(title: str, site: str, others: Sequence[str]) -> str:
    """What a finding cannot be told from, in a sentence."""
    return f"{title[:1].upper()}{title[1:]} at {site} cannot be told here from {', '.join(others)}."


def listed(words: Sequence[str]) -> str:
    """Words in a row: a, b and c."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def percent(share: float) -> str:
    """A share in per cent; what is more than all of it is told as such, and all never where something is left."""
    if NEARLY_ALL_SHARE < share < 1.0:
        return "more than 99.9 %"
    return f"{100.0 * share:.1f} %" if 0.995 <= share < 1.0 else f"{float(f'{100.0 * share:.2g}'):,.12g} %"


def untried(not_tried: Sequence[NotTried]) -> str:
    """What was not tried for lack of time and may change what was found, in a sentence; none if that is nothing."""
    if not not_tried:
        return ""
    telling = [f"{note.what} ({note.may_change})" for note in not_tried if note.may_change != NO_FINDING]
    return "The time was up before all was tried." + (f" Left were {'; '.join(telling)}." if telling else "")


def plainest(conclusion: Conclusion) -> Test:
    """The test that says most of what is left."""
    tests = [t for t in conclusion.remains.tests if t.chance < TEST_CHANCE] or conclusion.remains.tests
    found = min(tests, key=lambda t: (t.chance, -t.gain))
    if found.places >= 0:
        # What happens once in every recording is weighed with all its times, as it is where it stands against a finding.
        samples = sum(len(r) for r in conclusion.best.linear.residuals)
        found = max((t for t in tests if t.places >= 0), key=lambda t: t.worth(samples))
    # Others see a creep too, but its own test says where it comes from.
    return next((t for t in tests if t.cause and t.gain > TELLING_GAIN_SHARE * found.gain), found)
