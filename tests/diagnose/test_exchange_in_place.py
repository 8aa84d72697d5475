"""Members exchanged: what does the same work is found in their place, and needs no others there."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import GRAVITY, MASS, Rig, nominal, recording, releases, swing

from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.beam_search import Effort, grow
from harness.diagnose.selection.rewrite import Room
from harness.diagnose.selection.rewrites import shared_members
from harness.diagnose.selection.rewrites.relatives import relatives
from harness.diagnose.selection.study import Study

NOISE, RATE, EXTRA = 2e-3, 200.0, 1.4
WAVE, PERIODS, PHASE = 0.004, 18.0, -1.1
DRY = 0.0004


@pytest.fixture
def bench() -> Study:
    """Two free swings of a pendulum a fifth slower than its model, over a small wave."""
    rng = np.random.default_rng(31)
    time = np.arange(0.0, 8.0, 1.0 / RATE)
    rig = Rig(torque=lambda t, q, v: WAVE * np.sin(PERIODS * q + PHASE))
    slow = Rig(inertia=EXTRA * rig.about_joint - rig.mass * rig.com**2, torque=rig.torque)
    runs = [
        recording(f"run{k}", time, {"pivot.position": swing(slow, a, time) + NOISE * rng.standard_normal(len(time))})
        for k, a in enumerate((1.4, -1.0))
    ]
    system = nominal(tolerance=0.005)
    posed = pose(system, runs)
    known = tuple(candidates(system, runs, only=["com_offset", "added_inertia", "payload_mass", "cogging_torque"]))
    return Study(posed, Predictor(posed), Likelihood(posed, crude_colours(posed)), known, whole(posed.runs, range(2)))


def test_inertia_takes_the_place_of_a_shifted_centre_of_mass(bench: Study) -> None:
    by_name = {c.effect.name: c for c in bench.candidates}
    wave, centre = by_name["cogging_torque"], by_name["com_offset"]
    # The period of a pendulum goes as √(I/(m g c)): a centre at c' is as slow as EXTRA times the inertia where
    # (I + m c'²)/c' = EXTRA (I + m c²)/c.
    rig = Rig()
    inertia, target = rig.inertia / rig.mass, EXTRA * rig.about_joint / (rig.mass * rig.com)
    places = np.roots([1.0, -target, inertia])
    offset = min((float(p) - rig.com for p in places), key=abs)
    start = np.concatenate([
        np.zeros(len(bench.predictor.nominal)), to_internal(wave, np.array([WAVE, PERIODS, PHASE])),
        to_internal(centre, np.array([offset])),
    ])  # fmt: skip
    best = bench.fit(Hypothesis((wave, centre)), [start], None, most_steps=40)
    assert best.score < 1.1 * bench.samples
    found = {f.hypothesis.identity: f for f in relatives(bench, best, 1, 60)}
    other = found[frozenset({wave.key, by_name["added_inertia"].key})]
    assert other.score < best.score + 2.0


def test_what_stands_in_a_members_place_is_tried_without_the_others() -> None:
    system, runs = nominal(), releases(Rig(dry=DRY), (1.3, 0.9), 2e-2, seed=5)
    posed = pose(system, runs)
    names = ["viscous_damping", "coulomb_friction", "load_dependent_friction"]
    known = tuple(candidates(system, runs, only=names))
    bench = Study(posed, Predictor(posed), Likelihood(posed, crude_colours(posed)), known, whole(posed.runs, range(2)))
    viscous, dry, loaded = (next(c for c in known if c.effect.name == name) for name in names)
    nothing = np.zeros(len(bench.predictor.nominal))
    for friction, size in ((dry, DRY), (loaded, DRY / (MASS * GRAVITY))):
        start = np.concatenate(
            [nothing, to_internal(viscous, np.array([1e-6])), to_internal(friction, np.array([size]))]
        )
        bench.fit(Hypothesis((viscous, friction)), [start], None, most_steps=40)
    best = min(bench.fits.values(), key=bench.criterion)
    (other,) = {dry.key, loaded.key} - best.hypothesis.identity
    swap = bench.fits[frozenset({viscous.key, other})]
    found = {f.hypothesis.identity: f for f in shared_members.REWRITE.fits(bench, best, Room())}
    assert bench.criterion(found[frozenset({other})]) < bench.criterion(swap)


def test_nothing_is_exchanged_beside_a_member_that_is_not_needed() -> None:
    system, runs = nominal(), releases(Rig(viscous=2e-4), (1.3, 0.9), 2e-3, seed=8)
    posed = pose(system, runs)
    names = ["viscous_damping", "coulomb_friction", "load_dependent_friction"]
    known = tuple(candidates(system, runs, only=names))
    bench = Study(posed, Predictor(posed), Likelihood(posed, crude_colours(posed)), known, whole(posed.runs, range(2)))
    viscous, dry, loaded = (next(c for c in known if c.effect.name == name) for name in names)
    start = [np.zeros(len(bench.predictor.nominal)), to_internal(viscous, np.array([2e-4]))]
    both = bench.fit(
        Hypothesis((viscous, dry)), [np.concatenate([*start, to_internal(dry, np.array([1e-5]))])], None, most_steps=40
    )
    best = grow(bench, [both], Effort(), lambda _: None)[0]
    assert best.hypothesis.keys == (viscous.key,)
    # That friction would be fitted without the damping only where it is a member of a set that is exchanged.
    assert frozenset({loaded.key}) not in bench.fits
