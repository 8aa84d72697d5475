"""A link made to bend, against the closed forms of a uniform beam."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from harness import effects
from harness.denoc.beam.integrals import beam_data
from harness.denoc.lanes.exponential import linearization
from harness.denoc.lanes.model import LaneModel
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.beginnings.foretold import foretold as foretold_start
from harness.effects.bending import add_mode, mounted_frequency, next_mode
from harness.effects.scale import references
from harness.system import Attachment, Beam, Joint, JointType, Link, System
from harness.system.description import constant
from harness.system.flexible_link import flexible_link

MASS, LENGTH = 0.2, 0.3
FREQUENCY = 20.0


@pytest.fixture
def bent() -> System:
    """A uniform rod on a free hinge, bending at 20 Hz."""
    inertia = np.diag([MASS * LENGTH**2 / 12.0] * 2 + [0.0])
    joint = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0.0, 1.0, 0.0]))
    rod = Link("rod", MASS, constant([0, 0, -LENGTH / 2]), constant(inertia))
    stiff = System("pendulum", (joint,), (rod,))
    parameters = {"frequency": FREQUENCY, "damping_ratio": 0.01}
    return effects.apply(stiff, Attachment("link_flexibility", "rod", parameters))


def test_its_stiffness_is_that_of_a_beam_with_that_first_frequency(bent: System) -> None:
    # Pinned-free beam: ω = β² sqrt(EI / ρ) / l², tan β = tanh β, β = 3.926602 (Blevins, Formulas for natural frequency, 1979,
    # table 8-1). Two shapes are a little stiffer than all: the frequency may be a hundredth too high.
    root = 3.926602312
    exact = (2.0 * np.pi * FREQUENCY) ** 2 * (MASS / LENGTH) * LENGTH**4 / root**4
    stiffness = bent.link("rod").beam.bending_stiffness
    assert 0.98 * exact < stiffness < exact


@pytest.mark.parametrize(("power", "tip"), [(0, 1.0 / 8.0), (1, 11.0 / 120.0)], ids=["even load", "rising load"])
def test_it_gives_what_a_clamped_beam_gives_under_slow_loads(bent: System, power: int, tip: float) -> None:
    """Under a load p (x/l)^power the tip of a clamped beam sinks by p l⁴ / EI times 1/8 or 11/120 (Gere and Goodno, table G-1)."""
    data = beam_data(bent, "rod")
    nodes, weights = np.polynomial.legendre.leggauss(12)
    stations, weights = 0.5 * LENGTH * (nodes + 1.0), 0.5 * LENGTH * weights
    shapes = np.array([data.at(x).s for x in stations])
    load = shapes.T @ (weights * (stations / LENGTH) ** power)
    sunk = data.tip.s @ np.linalg.solve(data.K, load)
    stiffness = bent.link("rod").beam.bending_stiffness
    assert sunk == pytest.approx(tip * LENGTH**4 / stiffness, rel=1e-9)


@pytest.mark.parametrize("share", [0.02, 0.2, 1.0, 5.0])
def test_beside_a_motor_its_frequency_is_a_beams_within_what_is_stated(bent: System, share: float) -> None:
    # A beam on a hub of inertia J, free to turn: w = A (cos βx − cosh βx) + B sin βx + C sinh βx with EI w''(0) = −J ω² w'(0), no
    # moment and no force at the end (Meirovitch, Fundamentals of Vibrations, 2001, ch. 8).
    motor = share * MASS * LENGTH**2 / 3.0

    def conditions(x: float, hub: float) -> float:
        held = hub * x**3 / (MASS * LENGTH**2)
        c, s, ch, sh = np.cos(x), np.sin(x), np.cosh(x), np.sinh(x)
        rows = [[-2.0, held, held], [-c - ch, -s, sh], [s - sh, -c, ch]]
        return float(np.linalg.det(np.array(rows)))

    # Between that of a clamped beam and that of a pinned one.
    free = brentq(conditions, 3.5, 4.2, args=(0.0,))
    with_motor = brentq(conditions, 1.8752, free + 1e-3, args=(motor,))
    exact = FREQUENCY * (with_motor / free) ** 2
    hub = bent.joints[0]
    model = LaneModel(replace(bent.replace_joint(replace(hub, armature=motor)), gravity=constant([0.0, 0.0, 0.0])))
    # What moves slowest turns as a whole.
    own = np.abs(np.linalg.eigvals(linearization(model, model.row()[None], np.zeros((1, 2 * model.n)))[0]))
    ringing = float(np.sort(own)[2]) / (2.0 * np.pi)
    stated = effects.effect("link_flexibility").parameters[0].inexact
    assert 0.0 < stated <= 0.01
    assert ringing == pytest.approx(exact, rel=stated)


def test_the_next_mode_is_where_beam_theory_has_it() -> None:
    # A pinned-free beam's modes are as β² with β = 3.9266, 7.0686, 10.210 (Blevins, table 8-1).
    beam = Beam(
        length=LENGTH, mass=MASS, bending_stiffness=1.0, modes=1,
        direction=constant([0.0, 0.0, -1.0]), bending=constant([1.0, 0.0, 0.0]),
    )  # fmt: skip
    joint = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0.0, 1.0, 0.0]))
    system = System("strip", (joint,), (flexible_link("rod", beam),))
    foretold = next_mode(system, "rod")["frequency"]
    assert foretold / mounted_frequency(system, "rod") == pytest.approx((7.068583 / 3.926602) ** 2, rel=1e-4)
    # The effect with what theory foretells is the beam with one mode more; a search begins there.
    added = add_mode(system, "rod", {"frequency": foretold, "damping_ratio": 0.0}).link("rod").beam
    assert added is not None and added.mode_stiffness == pytest.approx((1.0, 1.0))
    mode = effects.effect("higher_mode")
    start = foretold_start(Candidate(mode, "rod", references(system, "rod")), system, np.array([3.0, 0.02]))
    assert start == pytest.approx([foretold, 0.02])
