"""What an engine's equation of motion lacks, asked of a recording: along the measured motion its forces do not balance.

Every term of the equation that differs from the native engine's of the same system is a candidate: what the two differ by is what
would mend it. Which of them the recording asks for is decided by the evidence of every subset: a term that is really wrong has its
mend with a factor of about one, one that is right has none.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.interpolate import make_splrep
from scipy.linalg import solve_toeplitz
from scipy.signal import lfilter

from harness.compare.spectrum import lines, parted
from harness.denoc.beam.integrals import beam_data
from harness.engines.protocol import Array, EngineModel
from harness.errors import InputError
from harness.recording.recording import Recording
from harness.system import System

# A mend that is needed has a factor of 1 within this (1σ): the recording has to say so clearly to be told otherwise.
FACTOR_STD = 0.25
# Log Bayes factor from which on a term is named: strong evidence on the scale of R. E. Kass and A. E. Raftery, J. Am. Stat. Assoc.
# 90 (1995) 773.
STRONG = 3.0
# A term that differs by less than this of the forces of its equation cannot be asked for.
NOTHING = 1e-6
# Terms are told as one a multiple of the other where that holds within this.
ALIKE = 0.02
# Subsets of more candidates than this are too many; those that would mend most are kept.
MOST = 12
# Derivatives are taken of what is below so many times the fastest line of the spectrum.
ABOVE_LINES = 3.3

# Autoregression of what the mended equation leaves, and what is added to its power: the cut-off leaves nothing above it.
ORDER, RIDGE = 24, 1e-6

_WORDS = {
    "coriolis": "the Coriolis and centrifugal force",
    "gravity": "gravity",
    "damping": "the damping",
    "stiffness": "the joint stiffness",
}


@dataclass(frozen=True)
class Mend:
    """A term that a recording asks for.

    row: coordinate of the equation. name: of the term. words: what is wrong with it. factor: of the mend, 1 where the native
    engine's term is what the recording needs, with its standard uncertainty. evidence: log Bayes factor for it.
    """

    row: str
    name: str
    words: str
    factor: float
    std: float
    evidence: float

    @property
    def ci95(self) -> tuple[float, float]:
        """Interval of 95 % of the factor."""
        return self.factor - 1.96 * self.std, self.factor + 1.96 * self.std


@dataclass(frozen=True, eq=False)
class Balance:
    """Forces of every row of an engine's equation along a recording.

    time [s] (T,); names: of the rows, units: of their forces; lacking: what it needs to balance, explained: what the mends give
    of it, both (T, n). mends: strongest evidence first. tried: names of all candidates by row.
    """

    time: Array
    names: tuple[str, ...]
    units: tuple[str, ...]
    lacking: Array
    explained: Array
    mends: tuple[Mend, ...]
    tried: Mapping[str, tuple[str, ...]]

    @property
    def share(self) -> Array:
        """Share of each row's mean square that the mends explain, (n,); nan where nothing is lacking."""
        whole, left = (np.sum(x**2, axis=0) for x in (self.lacking, self.lacking - self.explained))
        return np.asarray(1.0 - np.divide(left, whole, out=np.full_like(whole, np.nan), where=whole > 0.0))


def balance(recording: Recording, system: System, engine: EngineModel, reference: EngineModel) -> Balance:
    """Which terms of an engine's equation a recording asks to be mended.

    recording: with every joint's position and, of every link that bends, its tip deflection. engine, reference: built of the
    system; the candidates are where the first differs from the second. Raises InputError for what the recording does not tell.
    """
    time, measured, tau = coordinates(recording, system)
    cutoff = _cutoff(time, measured)
    q, qd, qdd = (
        np.column_stack(part) for part in zip(*(derivatives(time, x, cutoff) for x in measured.T), strict=True)
    )
    # Ends, where the filter does not know what comes, are left out, and no more samples kept than the cut-off asks for.
    stride = max(1, int(0.4 / cutoff / float(np.median(np.diff(time)))))
    inner = slice(len(time) // 20, len(time) - len(time) // 20, stride)
    time, q, qd, qdd, tau = (part[inner] for part in (time, q, qd, qdd, tau))
    theirs, ours = (parts(model, q, qd, qdd) for model in (engine, reference))
    lacking = tau - sum(theirs.values(), np.zeros_like(q))
    own = tau - sum(ours.values(), np.zeros_like(q))
    size = np.sqrt(np.mean(sum((x**2 for x in (*theirs.values(), *ours.values())), np.zeros_like(q)), axis=0))
    explained, found, tried = np.zeros_like(lacking), [], {}
    for row, name in enumerate(engine.names):
        columns = {}
        for key in ours:
            apart = ours[key][:, row] - theirs[key][:, row]
            if float(np.abs(apart).max()) > NOTHING * size[row]:
                columns[key] = apart
        kept = sorted(columns, key=lambda key: -float(np.abs(columns[key]).max()))[:MOST]
        tried[name] = tuple(kept)
        for key, (factor, std, evidence) in asked(
            {key: columns[key] for key in kept}, lacking[:, row], own[:, row]
        ).items():
            explained[:, row] += factor * columns[key]
            words = _told(key, name, ours[key][:, row], theirs[key][:, row])
            found.append(Mend(name, key, words, factor, std, evidence))
    found.sort(key=lambda mend: -mend.evidence)
    turning = {joint.name for joint in system.joints if not joint.prismatic}
    units = tuple("N·m" if name in turning else "N" for name in engine.names)
    return Balance(time, engine.names, units, lacking, explained, tuple(found), tried)


def coordinates(recording: Recording, system: System) -> tuple[Array, Array, Array]:
    """Time (T,), coordinates (T, n) and known efforts (T, n) of a recording, rows with gaps left out; SI.

    Raises InputError where a coordinate is not measured.
    """
    values = {channel.name: channel.values for channel in (*recording.channels, *recording.efforts)}
    beams = {link.name: link.beam for link in system.links if link.beam is not None}
    columns: list[Array] = []
    for name in system.coordinate_names:
        link = name.partition(".")[0]
        if name in system.joint_names:
            columns.append(_column(values, f"{name}.position", recording))
            continue
        data = beam_data(system, link)
        if beams[link].coordinates != 1:
            raise InputError(
                f"{link} bends in {beams[link].coordinates} coordinates, and one deflection cannot tell them apart",
                source=system.source,
                mend="modes = 1",
            )
        columns.append(_column(values, f"{link}.tip_deflection", recording) / float(data.S3.ravel()[0]))
    measured = np.column_stack(columns)
    tau = np.zeros_like(measured)
    for place, name in enumerate(system.coordinate_names):
        if f"{name}.effort" in values:
            tau[:, place] = values[f"{name}.effort"]
    good = np.isfinite(measured).all(axis=1) & np.isfinite(tau).all(axis=1)
    return recording.time[good], measured[good], tau[good]


def _column(values: Mapping[str, Array], name: str, recording: Recording) -> Array:
    if name not in values:
        raise InputError(
            f"has no {name}, without which the equation of motion cannot be put to it",
            source=recording.source,
            mend=f"record {name}, or map a column to it with --map",
        )
    return values[name]


def _cutoff(time: Array, measured: Array) -> float:
    """Where the derivatives end [Hz]: above the fastest line of any coordinate, below Nyquist."""
    nyquist = 0.5 / float(np.median(np.diff(time)))
    found = [line.frequency for x in measured.T for line in lines(time, x, most=4)]
    return min(0.8 * nyquist, ABOVE_LINES * max(found, default=nyquist))


def derivatives(time: Array, signal: Array, cutoff: float) -> tuple[Array, Array, Array]:
    """The signal without what is above ``cutoff`` [Hz], and its first two derivatives, each (T,)."""
    slow, _ = parted(time, signal, cutoff)
    even = np.linspace(float(time[0]), float(time[-1]), len(slow))
    spline = make_splrep(even, slow, k=5, s=0)
    return np.asarray(spline(time)), np.asarray(spline(time, 1)), np.asarray(spline(time, 2))


def parts(model: EngineModel, q: Array, qd: Array, qdd: Array) -> dict[str, Array]:
    """Terms of a model's equation along T states, left-hand side, each (T, n), by name: what the acceleration of each coordinate
    meets (``inertia by …``), and the Coriolis force, gravity, damping and stiffness."""
    names, still = model.names, np.zeros(q.shape[1])
    found: dict[str, list[Array]] = {}
    for at, rate, acceleration in zip(q, qd, qdd, strict=True):
        held = model.inverse_dynamics(at, still, still)
        gravity, bias = model.gravity(at), model.bias(at, rate)
        coriolis = bias - gravity
        each = {
            "coriolis": coriolis,
            "gravity": gravity,
            "stiffness": held - gravity,
            "damping": model.inverse_dynamics(at, rate, still) - held - coriolis,
        }
        for k, name in enumerate(names):
            alone = np.where(np.arange(len(names)) == k, acceleration, 0.0)
            each[f"inertia by {name}"] = model.inverse_dynamics(at, still, alone) - held
        for key, value in each.items():
            found.setdefault(key, []).append(value)
    return {key: np.array(values) for key, values in found.items()}


def asked(columns: Mapping[str, Array], lacking: Array, own: Array) -> dict[str, tuple[float, float, float]]:
    """The mends that a force asks for: factor, its standard uncertainty and the log Bayes factor for it, by name.

    columns: mends by name; lacking: the force; own: what is left where all are mended, each (T,). Of all subsets the one with the
    largest evidence, the factors of its members 1 ± ``FACTOR_STD`` before the recording is looked at. What even the mended equation
    leaves is no news about a term: the variance is at least that of ``own``, and what of it looks like a term widens its factor.
    """
    names = tuple(columns)
    if not names:
        return {}
    white = whitening(own)
    basis = white(np.column_stack([columns[name] for name in names]))
    lacking, own = white(lacking), white(own)
    scale = np.abs(basis).max(axis=0)
    left = lacking - basis / scale @ np.linalg.lstsq(basis / scale, lacking, rcond=None)[0]
    variance = max(float(np.mean(left**2)), float(np.mean(own**2)), 1e-24 * float(np.mean(lacking**2)))
    gram, cross, whole = basis.T @ basis / variance, basis.T @ lacking / variance, float(lacking @ lacking) / variance

    def posterior(subset: Sequence[int]) -> tuple[float, Array, Array]:
        """Log evidence up to a constant, factors and their covariance."""
        chosen = list(subset)
        prior = np.full(len(chosen), FACTOR_STD**-2)
        precision = gram[np.ix_(chosen, chosen)] + np.diag(prior)
        covariance = np.linalg.inv(precision)
        factors = covariance @ (cross[chosen] + prior)
        _, volume = np.linalg.slogdet(precision)
        quadratic = whole + float(prior.sum()) - float(factors @ precision @ factors)
        return 0.5 * (float(np.sum(np.log(prior))) - float(volume) - quadratic), factors, np.asarray(covariance)

    every = [subset for size in range(len(names) + 1) for subset in combinations(range(len(names)), size)]
    scores = {subset: posterior(subset)[0] for subset in every}
    best = max(every, key=lambda subset: scores[subset])
    gain = {k: scores[best] - max(score for subset, score in scores.items() if k not in subset) for k in best}
    told = tuple(k for k in best if gain[k] > STRONG)
    _, factors, covariance = posterior(told)
    likeness = covariance @ (basis[:, list(told)].T @ own / variance)
    std = np.hypot(np.sqrt(np.diagonal(covariance)), likeness)
    return {names[k]: (float(factors[i]), float(std[i]), gain[k]) for i, k in enumerate(told)}


def whitening(noise: Array) -> Callable[[Array], Array]:
    """A filter over the first axis that makes white noise of a signal like ``noise`` (T,): an autoregression's, by Yule-Walker.

    Derivatives have most of their noise at high frequencies; unweighted, that would drown what the low ones say.
    """
    centred = noise - noise.mean()
    order = min(ORDER, len(noise) // 10)
    power = float(centred @ centred)
    if power == 0.0 or order < 1:
        return lambda signal: signal
    correlation = np.array([float(centred[: len(centred) - k] @ centred[k:]) for k in range(order + 1)]) / power
    correlation[0] += RIDGE
    taps = np.append(1.0, -solve_toeplitz(correlation[:-1], correlation[1:]))
    return lambda signal: np.asarray(lfilter(taps, 1.0, signal, axis=0)[order:])


def _told(key: str, row: str, ours: Array, theirs: Array) -> str:
    """What is wrong with a term of a row, in words."""
    link, elastic, _ = row.partition(".")
    place = f"in the equation of {link}'s bending" if elastic else f"in the equation of {row}"
    what = f"the inertia that the acceleration of {key.removeprefix('inertia by ')} meets"
    if key in _WORDS:
        what = "the elastic stiffness" if key == "stiffness" and elastic else _WORDS[key]
    largest, theirs_largest = float(np.abs(ours).max()), float(np.abs(theirs).max())
    if theirs_largest <= 1e-9 * largest:
        return f"{what} is missing {place}"
    if largest <= 1e-9 * theirs_largest:
        return f"{what} stands {place}, where there is none"
    factor = float(ours @ theirs) / float(ours @ ours)
    if float(np.abs(theirs - factor * ours).max()) <= ALIKE * theirs_largest:
        return f"{what} is {factor:.3g} times what it should be {place}"
    return f"{what} is another one {place}"
