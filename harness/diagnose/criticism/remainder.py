"""What is left when the best hypothesis has been fitted: is it more than noise, and what does it look like as a force?

A force that nobody has a law for still shows: the response of the channels to small generalized forces that depend on
position and velocity (the same in every recording), or that act for a short time only (different in each), is linear. Such
responses are projected off everything the hypothesis may adjust and held against the residual.

Asked are a smooth force over position and velocity, a force at certain places, one of a few simple terms (charged for having been
chosen among many), one that relaxes, one that acts once, sets in or grows, a jump or a slow course of a reading, a leak of another
channel, a stretch louder than others, a spectrum too loud around the swing, each at a chance of 1e-5. A loud stretch counts only if
its samples follow one another, and only beyond what rounding could make: noise of real sensors has tails, grows with speed, and a
motor is switched on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from math import comb

import numpy as np
from numpy.typing import NDArray
from scipy.signal import correlate
from scipy.stats import chi2

from harness.diagnose.criticism.crosstalk import leaking
from harness.diagnose.criticism.probe import Probe, Test, probe
from harness.diagnose.criticism.relaxation import relaxing
from harness.diagnose.criticism.residual_correlation import louder_stretch
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.score_tests import Nuisance, Projected, nuisance
from harness.parallel import meanwhile

Array = NDArray[np.float64]

BUMPS = 10  # places over the range of a joint at which a force of its own is allowed
PULSE = 0.5  # of a swing's period: how long a force that acts once is taken to last
WIDTHS = (0.25, 0.1, 0.04)  # of the range of motion: how far a force at one place may reach
SIDES = 9  # angles at which a force may begin that acts on one side only, beside zero


def state_shapes(q: Array, qd: Array, low: float, high: float, fast: float) -> tuple[list[str], Array]:
    """Forces over one joint's position and velocity: smooth polynomials, then bumps in position, going and coming.

    low, high: range of position that the bumps divide; fast: velocity scale. Returns names and values (k, G).
    """
    u = np.clip((q - 0.5 * (low + high)) / (0.5 * (high - low)), -1.5, 1.5)
    w = np.clip(qd / fast, -1.5, 1.5)
    names, values = [], []
    for a in range(4):
        for b in range(4):
            if a + b <= 4:
                names.append(f"u^{a} w^{b}")
                values.append(u**a * w**b)
    for label, sign in (("sign(w)", np.tanh(20.0 * w)), ("u sign(w)", u * np.tanh(20.0 * w))):
        names.append(label)
        values.append(sign)
    centres = np.linspace(-1.0, 1.0, BUMPS)
    width = centres[1] - centres[0]
    for c in centres:
        bump = np.exp(-(((u - c) / width) ** 2))
        names += [f"bump({c:.2f})", f"bump({c:.2f}) sign(w)"]
        values += [bump, bump * np.tanh(20.0 * w)]
    return names, np.array(values)


TERMS: tuple[tuple[str, Callable[[Array, Array], Array]], ...] = (
    ("1", lambda q, v: np.ones_like(q)),
    ("q", lambda q, v: q),
    ("q^2", lambda q, v: q**2),
    ("q^3", lambda q, v: q**3),
    ("sin(q)", lambda q, v: np.sin(q)),
    ("cos(q)", lambda q, v: np.cos(q)),
    ("sin(2 q)", lambda q, v: np.sin(2 * q)),
    ("cos(2 q)", lambda q, v: np.cos(2 * q)),
    ("v", lambda q, v: v),
    ("v |v|", lambda q, v: v * np.abs(v)),
    ("v^2", lambda q, v: v**2),
    ("v^3", lambda q, v: v**3),
    ("sign(v)", lambda q, v: np.sign(v)),
    ("q v", lambda q, v: q * v),
    ("q^2 v", lambda q, v: q**2 * v),
    ("|q| v", lambda q, v: np.abs(q) * v),
    ("q sign(v)", lambda q, v: q * np.sign(v)),
    ("q^2 sign(v)", lambda q, v: q**2 * np.sign(v)),
    ("max(q, 0)", lambda q, v: np.maximum(q, 0.0)),
    ("min(q, 0)", lambda q, v: np.minimum(q, 0.0)),
    ("max(v, 0)", lambda q, v: np.maximum(v, 0.0)),
)
"""Library of the sparsest form: forces over position q and velocity v of a joint."""

MOST_TERMS = 3
DEPENDENT = 1e-8  # ratio of eigenvalues of the columns' correlations


@dataclass(frozen=True, eq=False)
class Form:
    """The sparsest symbolic form of the residual force at a joint: torque = Σ coefficient · term [N·m]."""

    joint: str
    terms: tuple[str, ...]
    coefficients: tuple[float, ...]
    gain: float

    def __str__(self) -> str:
        return " ".join(f"{c:+.3g}·{t}" for c, t in zip(self.coefficients, self.terms, strict=True))


@dataclass(frozen=True, eq=False)
class Map:
    """Residual force at a joint over its position and velocity [N·m], nan where the motion has not been."""

    joint: str
    position: Array
    velocity: Array
    force: Array


@dataclass(frozen=True, eq=False)
class Remains:
    """Answer of the tests: significant or not, the tests, the cost still to be had, form and map of the force."""

    significant: bool
    tests: tuple[Test, ...]
    excess: float
    form: Form | None = None
    force_map: Map | None = None


def solve_gain(seen: Projected, index: Sequence[int], strength: float = 1e-6) -> tuple[float, Array, float]:
    """Gain in cost, coefficients and effective number of directions of a least-squares combination of some columns."""
    assert seen.gram is not None
    coefficients = np.zeros(len(index))
    norms = np.sqrt(np.maximum(seen.squares[list(index)], 0.0))
    keep = norms > 1e-6 * max(float(norms.max(initial=0.0)), 1e-300)
    if not np.any(keep):
        return 0.0, coefficients, 0.0
    chosen = np.array(index)[keep]
    scaled = seen.gram[np.ix_(chosen, chosen)] / np.outer(norms[keep], norms[keep])
    values, vectors = np.linalg.eigh(scaled)
    # Eigenvalues are squares of singular values; rounding leaves them good to a few times 1e-13.
    strong = values > max(strength**2, 1e-12) * values[-1]
    along = vectors[:, strong].T @ (seen.along[chosen] / norms[keep])
    coefficients[keep] = -(vectors[:, strong] @ (along / values[strong])) / norms[keep]
    return float(np.sum(along**2 / values[strong])), coefficients, float(strong.sum())


def examine(
    predictor: Predictor,
    likelihood: Likelihood,
    fitted: Fit,
    joints: Sequence[str],
    torque_scales: Sequence[float],
    period: float,
    level: float = 1e-4,
) -> Remains:
    """Tests of what a fit leaves.

    joints, torque_scales: where forces may act and their natural size [N·m]. period: of the slowest swing [s]. level: chance at
    which a test counts.
    """
    space = nuisance(fitted, predictor)
    noise = _loudness(fitted)
    tests: list[Test] = []
    excess, chosen, best_chance = 0.0, "", 1.0
    smooth_maps: dict[str, tuple[Probe, Array, float, float, float]] = {}
    forms: dict[str, Form] = {}
    for joint, torque in zip(joints, torque_scales, strict=True):
        own = probe(predictor, likelihood, fitted, torque)
        k = own.names.index(joint)
        pooled = np.concatenate([m.q[:, k] for m in own.motions.values()])
        speeds = np.abs(np.concatenate([m.qd[:, k] for m in own.motions.values()]))
        low, high = (float(x) for x in np.quantile(pooled, [0.005, 0.995]))
        fast = max(float(np.quantile(speeds, 0.98)), 1e-9)
        if high - low < 1e-9:
            continue
        # A third of the time, most of it in compiled code: on another thread, if there is one.
        of_local = meanwhile(predictor.threads, _local, own, space, joint, (low, high, fast), noise)
        names, _ = state_shapes(pooled[:2], pooled[:2] * 0.0, low, high, fast)
        shapes = partial(_shape_values, low=low, high=high, fast=fast)
        seen = space.measure(own.changes(joint, shapes))
        smooth = [i for i, name in enumerate(names) if not name.startswith("bump")]
        for label, index in (
            ("a smooth force over the state", smooth),
            ("a force at certain places", list(range(len(names)))),
        ):
            gain, found, size = solve_gain(seen, index, 1e-3)
            chance = float(chi2.sf(gain / noise, max(size, 1.0)))
            tests.append(Test(f"{label} at {joint}", gain, int(size), chance, (joint,)))
            if _counts(tests[-1], level):
                excess = max(excess, gain - size)
                if chance <= best_chance:
                    best_chance, chosen = chance, joint
                full = np.zeros(len(names))
                full[index] = found * torque
                smooth_maps[joint] = (own, full, low, high, fast)
        forms[joint] = sparsest(own, space, joint, torque)
        # Made before the other thread's is waited for.
        beside = [
            _pulses(own, space, joint, period, noise),
            relaxing(own, space, joint, period, noise),
            *_setting_in(own, space, joint, fast, noise),
        ]
        further = [_few_terms(forms[joint], noise), of_local(), *beside]
        tests += further
        excess = max([excess, *(test.gain for test in further if _counts(test, level))])
    gain, chance = louder_stretch(likelihood, fitted)
    tests.append(Test("a louder stretch", gain, 1, chance, places=-1))
    others = [
        _spectrum(own_period=period, predictor=predictor, fitted=fitted),
        jump(predictor, likelihood, fitted, space),
        *wandering(predictor, likelihood, fitted, period, space),
        *leaking(predictor, likelihood, fitted, space, noise),
    ]
    tests += others
    excess = max([excess, *(test.gain for test in others if _counts(test, level))])
    significant = any(_counts(t, level) for t in tests)
    form = force_map = None
    if chosen:
        form, force_map = forms[chosen], _map(chosen, smooth_maps[chosen])
    return Remains(significant, tuple(tests), excess, form, force_map)


def _counts(test: Test, level: float) -> bool:
    """Whether a test speaks against noise alone."""
    return test.chance < level


def _shape_values(q: Array, qd: Array, low: float, high: float, fast: float) -> Array:
    return state_shapes(q, qd, low, high, fast)[1]


def sparsest(own: Probe, space: Nuisance, joint: str, torque: float) -> Form:
    """The best of all combinations of few terms of the library, as many terms as the Bayesian criterion pays for.

    All are compared, for two terms may each explain nothing and together everything, as drive and brake of a limit cycle do.
    """
    seen = space.measure(own.changes(joint, lambda q, v: np.array([term(q, v) for _, term in TERMS])))
    price = float(np.log(len(space.residual))) + 2.0 * float(np.log(len(TERMS)))
    best: tuple[int, ...] = ()
    for size in range(1, MOST_TERMS + 1):
        gain, chosen = _best_subset(seen, size)
        if gain > solve_gain(seen, best, 1e-4)[0] + price * (size - len(best)):
            best = chosen
    total, coefficients, _ = solve_gain(seen, best, 1e-4)
    names = tuple(TERMS[j][0] for j in best)
    return Form(joint, names, tuple(float(c) * torque for c in coefficients), total)


def _best_subset(seen: Projected, size: int) -> tuple[float, tuple[int, ...]]:
    """The greatest gain of so many columns together, those that are nearly dependent left out, and which they are."""
    assert seen.gram is not None
    norms = np.sqrt(np.maximum(seen.squares, 0.0))
    visible = norms > 1e-6 * max(float(norms.max(initial=0.0)), 1e-300)
    usable = np.flatnonzero(visible)
    if len(usable) < size:
        return 0.0, ()
    subsets = usable[np.array(list(combinations(range(len(usable)), size)))]
    units = np.where(visible, norms, np.inf)
    scaled = seen.gram / np.outer(units, units)
    right = (seen.along / units)[subsets]
    values, vectors = np.linalg.eigh(scaled[subsets[:, :, None], subsets[:, None, :]])
    along = np.einsum("kij,ki->kj", vectors, right)
    independent = values[:, 0] > DEPENDENT * values[:, -1]
    gains = np.where(independent, np.sum(along**2 / np.maximum(values, 1e-300), axis=1), 0.0)
    best = int(np.argmax(gains))
    return float(gains[best]), tuple(int(k) for k in subsets[best])


def _few_terms(form: Form, noise: float) -> Test:
    """The gain by the sparsest form, all forms of as many terms counted in its chance."""
    size = len(form.terms)
    choices = float(comb(len(TERMS), size))
    chance = min(1.0, choices * float(chi2.sf(form.gain / noise, size))) if size else 1.0
    return Test(
        f"a force of few terms at {form.joint}", form.gain, size, chance, (form.joint, str(form)), choices=choices
    )


def _map(
    joint: str,
    found: tuple[Probe, Array, float, float, float],
) -> Map:
    """The fitted force on a grid over position and velocity, where the motion has been."""
    own, coefficients, low, high, fast = found
    position, velocity = np.linspace(low, high, 21), np.linspace(-fast, fast, 21)
    q, v = np.meshgrid(position, velocity, indexing="ij")
    force = (coefficients @ _shape_values(q.ravel(), v.ravel(), low, high, fast)).reshape(q.shape)
    k = own.names.index(joint)
    seen = np.zeros_like(force, dtype=bool)
    for m in own.motions.values():
        i = np.clip(np.round((m.q[:, k] - low) / (high - low) * 20).astype(int), 0, 20)
        j = np.clip(np.round((m.qd[:, k] + fast) / (2 * fast) * 20).astype(int), 0, 20)
        seen[i, j] = True
    return Map(joint, position, velocity, np.where(seen, force, np.nan))


def heldout_gain(before: Array, after: Array) -> float:
    """Gain in cost on data not fitted to, in standard deviations of what the noise would do to it.

    With δ the change of the residual, the gain is Σ(r₀² − r₁²); its spread 2 (Σ_b (Σ_{t∈b} r₁ δ)²)^½ is taken over blocks b,
    so that correlated residuals count as such, and is at least that of white noise, 2|δ| (Vuong, Econometrica 57 (1989) 307).
    """
    delta = after - before
    gain = float(before @ before - after @ after)
    blocks = np.array_split(after * delta, max(8, min(40, len(delta) // 50)))
    spread = 2.0 * max(float(np.sqrt(sum(float(np.sum(b)) ** 2 for b in blocks))), float(np.linalg.norm(delta)))
    return gain / spread if spread > 0.0 else 0.0


def _loudness(fitted: Fit) -> float:
    """Variance of what a fit leaves in most places, in units of the noise's; one at least."""
    return max(1.0, float(np.median(_block_variance(fitted))))


def _block_variance(fitted: Fit) -> Array:
    out = []
    for r in fitted.linear.residuals:
        out += [float(np.mean(b[b != 0.0] ** 2)) if np.any(b != 0.0) else 1.0 for b in np.array_split(r, 20)]
    return np.array(out)


def _local_shapes(q: Array, qd: Array, low: float, high: float, fast: float) -> Array:
    """Forces that nobody has a law for, one amplitude each: at one place of the range (attraction, push, drag, friction
    there), or on one side of it only; shape (k, G)."""
    w = np.clip(qd / fast, -1.5, 1.5)
    sense = np.tanh(20.0 * w)
    values = []
    for share in WIDTHS:
        width = share * (high - low)
        for centre in np.arange(low, high + 0.5 * width, 0.5 * width):
            x = (q - centre) / width
            bump = np.exp(-(x**2))
            values += [bump, x * bump, bump * w, bump * sense]
    for centre in [*np.linspace(low, high, SIDES + 2)[1:-1], *([0.0] if low < 0.0 < high else [])]:
        beyond = (q > centre).astype(np.float64)
        values += [beyond * (q - centre), (1.0 - beyond) * (q - centre), beyond * w, beyond * sense]
    return np.array(values)


def _local(own: Probe, space: Nuisance, joint: str, extent: tuple[float, float, float], noise: float) -> Test:
    """Largest gain by one force at one place or on one side, all of them counted in its chance."""
    low, high, fast = extent
    shapes = partial(_local_shapes, low=low, high=high, fast=fast)
    gains = space.measure(own.changes(joint, shapes)).gains()
    gain = float(gains.max(initial=0.0))
    chance = min(1.0, int(np.count_nonzero(gains)) * float(chi2.sf(gain / noise, 1)))
    return Test(f"a force at one place or one side at {joint}", gain, 1, chance, (joint,), 2)


def _jointly(space: Nuisance, chosen: Sequence[Array]) -> float:
    """Gain in cost by one column of every window, (M_w,) each, with an amplitude of its own in each."""
    columns = []
    for k, column in enumerate(chosen):
        rows = np.zeros((len(chosen), len(column)))
        rows[k] = column
        columns.append(rows)
    seen = space.measure(columns)
    if seen.gram is None:
        return 0.0
    size = np.sqrt(np.maximum(np.diag(seen.gram), 1e-300))
    amplitudes = np.linalg.lstsq(seen.gram / np.outer(size, size), seen.along / size, rcond=1e-9)[0]
    return float(amplitudes @ (seen.along / size))


def _pulses(own: Probe, space: Nuisance, joint: str, period: float, noise: float) -> Test:
    """Largest gain by one pulse of force anywhere, all places counted in its chance."""
    best, count, where = 0.0, 0, ""
    chosen = [np.zeros(len(q)) for q in space.states]
    width = PULSE * period
    for window, found in own.motions.items():
        centres = np.arange(0.5 * width, found.time[-1], 0.5 * width)
        if len(centres) == 0:
            continue
        histories = np.exp(-(((found.time[None, :] - centres[:, None]) / (0.4 * width)) ** 2))
        place = own.fitted.windows.index(window)
        pulses = own.pulses(joint, window, histories)
        gains = space.measure([pulses], only=place).gains()
        count += len(centres)
        top = int(np.argmax(gains))
        chosen[place] = pulses[top]
        if gains[top] > best:
            best = float(gains[top])
            run = own.predictor.runs[window.run]
            where = f"{run.name} at {centres[top] + run.time[window.first]:.2f} s"
    chance = min(1.0, count * float(chi2.sf(best / noise, 1)))
    every = (_jointly(space, chosen), len(chosen))
    return Test(f"a force that acts once at {joint}", best, 1, chance, (joint, where), 1, every)


SETS_IN = "a force that sets in"
JUMP = "a jump of the reading"
WANDERS = "a reading that wanders"
JUMPS = 160  # places of a recording at which a lasting jump of a reading is tried, evenly spread and again where it is likely
MOMENTS = 12  # in a recording at which a force is tried to set in


def _setting_in(own: Probe, space: Nuisance, joint: str, fast: float, noise: float) -> tuple[Test, Test]:
    """Largest gains by a push, friction, drag or spring that sets in or grows all along: in one recording, in all alike."""
    k = own.names.index(joint)
    longest = max(run.date(-1) for run in own.predictor.runs)
    moments = np.linspace(0.0, longest, MOMENTS + 2)[1:-1]
    best, count, where = 0.0, 0, ""
    chosen, columns = [], []
    for place, window in enumerate(own.fitted.windows):
        found = own.motions[window]
        run = own.predictor.runs[window.run]
        time = found.time + run.date(window.first)
        speed = np.clip(found.qd[:, k] / fast, -1.5, 1.5)
        shapes = np.array([np.ones_like(speed), np.tanh(20.0 * speed), speed, np.sin(found.q[:, k])])
        later = (time[None, :] >= moments[:, None]).astype(np.float64)
        histories = np.vstack([(shapes[:, None, :] * later[None]).reshape(-1, len(speed)), shapes * time / longest])
        columns.append(own.pulses(joint, window, histories))
        gains = space.measure([columns[-1]], only=place).gains()
        count += len(gains)
        top = int(np.argmax(gains))
        chosen.append(columns[-1][top])
        if gains[top] > best:
            best = float(gains[top])
            where = f"{run.name} {_since(moments, shapes, top)}"
    chance = min(1.0, count * float(chi2.sf(best / noise, 1)))
    once = Test(f"{SETS_IN} at {joint}", best, 1, chance, (joint, where), 2, (_jointly(space, chosen), len(chosen)))
    gains = space.measure(columns).gains()
    top = int(np.argmax(gains))
    chance = min(1.0, len(gains) * float(chi2.sf(gains[top] / noise, 1)))
    where = f"{_since(moments, shapes, top)} in every recording"
    return once, Test(f"{SETS_IN} every time at {joint}", float(gains[top]), 1, chance, (joint, where), 2)


def _since(moments: Array, shapes: Array, column: int) -> str:
    """When the force of a column of ``_setting_in`` acts."""
    return (
        f"from {moments[column % len(moments)]:.2f} s on"
        if column < len(shapes) * len(moments)
        else "growing all along"
    )


MOTION = (0.3, 4.0)  # times the swing's frequency: where a misfit of the motion shows first
LOUDER = 1.5  # times the noise's power, beyond what an error of the noise's colour can make


def _spectrum(own_period: float, predictor: Predictor, fitted: Fit) -> Test:
    """Whether the whitened residual is louder around the swing's frequency than it should be."""
    total, count = 0.0, 0
    beyond, others = 0.0, 0
    channels = len(predictor.problem.channels)
    for window, r in zip(fitted.windows, fitted.linear.residuals, strict=True):
        interval = predictor.runs[window.run].interval
        for x in r.reshape(channels, window.size):
            if np.count_nonzero(x) < 0.5 * len(x):
                continue
            power = np.abs(np.fft.rfft(x)) ** 2 / max(np.count_nonzero(x), 1)
            frequency = np.fft.rfftfreq(len(x), interval)
            inside = (frequency > MOTION[0] / own_period) & (frequency < MOTION[1] / own_period)
            total += float(power[inside].sum())
            count += int(inside.sum())
            above = frequency >= MOTION[1] / own_period
            beyond += float(power[above].sum())
            others += int(above.sum())
    # Noise that is louder for a while is so at all frequencies.
    total /= max(1.0, beyond / others) if others > count else 1.0
    if count < 10:
        return Test("the spectrum around the swing", 0.0, 1, 1.0)
    # Powers of white noise are exponential: twice their sum is chi-squared with two degrees of freedom each.
    chance = float(chi2.sf(2.0 * total, 2 * count)) if total > LOUDER * count else 1.0
    return Test("the spectrum around the swing", 2.0 * (total - count), count, chance, places=-1)


def jump(predictor: Predictor, likelihood: Likelihood, fitted: Fit, space: Nuisance | None = None) -> Test:
    """Largest gain by one lasting jump of a channel's reading, all channels and times counted in its chance.

    space: what the hypothesis may adjust, if known already.
    """
    space = space or nuisance(fitted, predictor)
    noise = _loudness(fitted)
    best, count, where = 0.0, 0, ("", "")
    chosen = []
    for place, window in enumerate(fitted.windows):
        loudest = -1.0
        run = predictor.runs[window.run]
        edge = _edge(window.size)
        evenly = np.linspace(edge, window.size - edge, min(JUMPS, window.size // 8)).astype(int)
        residual = fitted.linear.residuals[place].reshape(-1, window.size)
        for c, channel in enumerate(predictor.problem.channels):
            likely = _likeliest_jumps(likelihood.colours[c], residual[c], likelihood.weights(window)[c])
            places = np.union1d(evenly, likely)
            signal = np.zeros((len(places), len(predictor.problem.channels), window.size))
            signal[:, c] = likelihood.colours[c].std * (np.arange(window.size)[None, :] >= places[:, None])
            own = likelihood.whiten_signal(window, signal)
            gains = space.measure([own], only=place).gains()
            count += window.size
            top = int(np.argmax(gains))
            if gains[top] > loudest:
                loudest, column = float(gains[top]), own[top]
            if gains[top] > best:
                best = float(gains[top])
                where = (channel.name, f"{run.name} at {run.time[window.first + places[top]]:.2f} s")
        chosen.append(column)
    chance = min(1.0, count * float(chi2.sf(best / noise, 1)))
    every = (_jointly(space, chosen), len(chosen))
    return Test(JUMP, best, 1, chance, where, 1, every, exact=True)


BENDS = 12  # half waves of a reading that wanders over a window, at most


def wandering(
    predictor: Predictor, likelihood: Likelihood, fitted: Fit, period: float, space: Nuisance | None = None
) -> list[Test]:
    """For every channel the gain by a course of its reading that is slower than the motion, in every window another.

    As half waves over the window, two periods of the swing long or longer (those of a discrete cosine transform), all of which are
    taken to begin at zero: a zero that is wrong from the start is another thing.
    period: of the slowest swing [s]. space: what the hypothesis may adjust, if known already.
    """
    space = space or nuisance(fitted, predictor)
    noise = _loudness(fitted)
    channels = predictor.problem.channels
    found = []
    courses = [_courses(predictor, window, period) for window in fitted.windows]
    edges = np.cumsum([0, *(len(own) for own in courses)])
    if not edges[-1]:
        return []
    for c, channel in enumerate(channels):
        columns = []
        for window, own, first in zip(fitted.windows, courses, edges, strict=False):
            signal = np.zeros((edges[-1], len(channels), window.size))
            signal[first : first + len(own), c] = likelihood.colours[c].std * own
            columns.append(likelihood.whiten_signal(window, signal))
        gain, amplitudes, size = solve_gain(space.measure(columns), range(edges[-1]))
        chance = float(chi2.sf(gain / noise, max(size, 1.0))) if gain > LOUDER * size else 1.0
        extents = [float(np.ptp(amplitudes[a:b] @ own)) for own, a, b in zip(courses, edges, edges[1:], strict=False)]
        widest = int(np.argmax(extents))
        by = f"by {likelihood.colours[c].std * extents[widest]:.2g} {channel.unit}"
        where = (channel.name, f"{by} in {predictor.runs[fitted.windows[widest].run].name}")
        found.append(Test(WANDERS, gain, int(size), chance, where, exact=True))
    return found


def _courses(predictor: Predictor, window: Window, period: float) -> Array:
    """Half waves over a window (k, T), from zero on; none if no half wave is slow enough."""
    time = predictor.runs[window.run].time[window.first : window.last]
    count = min(int((time[-1] - time[0]) / period), BENDS)
    turns = np.arange(1, count + 1)[:, None] * (time - time[0]) / (time[-1] - time[0])
    return np.asarray(np.cos(np.pi * turns) - 1.0)


def _likeliest_jumps(colour: Colour, residual: Array, weights: Array) -> NDArray[np.intp]:
    """Samples at which a jump would take most from a whitened residual (T,) by itself, whatever else might adjust.

    Between the samples of a grid a jump would be lost: noise that remembers makes of it a single sharp sample.
    """
    step = np.ones(len(residual) + 1)
    step[0] = 0.0  # the first sample of a window is whitened in a way of its own
    shape = colour.whiten(step)[1:]
    along = correlate(residual * weights, shape)[len(residual) - 1 :]
    squares = correlate(weights**2, shape**2)[len(residual) - 1 :]
    edge = _edge(len(residual))
    inside = slice(edge, max(len(residual) - edge, edge))
    gains = along[inside] ** 2 / np.maximum(squares[inside], 1e-12)
    return np.asarray(edge + np.argsort(gains)[-JUMPS:], dtype=np.intp)


def _edge(samples: int) -> int:
    """Samples at either end of a window among which a jump could not be told from a single reading that is far off."""
    return max(5, min(20, samples // 8))
