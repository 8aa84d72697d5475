"""Which number of a beam a difference comes of: faults made in closed forms, named by moving the native description."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.cases.beam_paths import CLAMPED_FREE, PAYLOAD, tip_mass_roots
from harness.cases.beams import PAPER_MASS, cantilever, closed_form, flexible_pendulum, strip
from harness.cases.bent_in_space import system as bent
from harness.cases.case import Bench
from harness.cases.checks.beam_blame import by_forces, by_frequencies, by_motion
from harness.cases.checks.textbook import Textbook
from harness.cases.discover import built_in
from harness.compare.numbers_of import with_moments
from harness.denoc import Denoc
from harness.engines.registry import engine
from harness.system import Link
from harness.system.flexible_link import flexible_link

NONE = np.zeros((3, 3))


def roots_of(payload: float) -> np.ndarray:
    link = strip(modes=5)
    return np.array([closed_form(z, link) for z in tip_mass_roots(payload / link.mass, 0.0, 3)])


def test_a_payload_is_named_with_its_factor():
    system = cantilever(strip(modes=5, payload=PAYLOAD))
    true, found = roots_of(PAYLOAD), roots_of(0.9 * PAYLOAD)
    said, place = by_frequencies(system, "other", true, dict(enumerate(found / true)), mode=2)
    assert place == {"mode": 3, "link": "rod", "value": "payload"}
    factor = float(said.split("payload of link 'rod' ")[1].split()[0])
    assert factor == pytest.approx(0.9, rel=1e-3)
    assert " or " not in said


def test_what_frequencies_alone_cannot_part_is_named_together():
    system = cantilever(strip(modes=3))
    true = np.array([closed_form(z, strip()) for z in CLAMPED_FREE])
    # All modes of a clamped beam go with √(EI / m).
    said, _ = by_frequencies(system, "other", true, dict.fromkeys(range(3), math.sqrt(1.02)))
    assert "bending stiffness of link 'rod' 1.02 times" in said
    assert "mass of link 'rod' 0.980392 times" in said


def test_one_mode_names_nothing_and_what_no_number_does_is_said_so():
    system = cantilever(strip(modes=3))
    true = np.array([closed_form(z, strip()) for z in CLAMPED_FREE])
    assert by_frequencies(system, "other", true, {0: 1.01})[0] == ""
    said, place = by_frequencies(system, "other", true, {0: 1.01, 1: 0.99, 2: 1.02}, mode=0)
    assert "no one number" in said
    assert place == {"mode": 1, "term": "shapes", "link": "rod"}


def test_a_motion_that_dies_away_too_fast_is_named_for_its_damping():
    beam = strip(modes=1).beam
    assert beam is not None
    system = cantilever(flexible_link("rod", replace(beam, modal_damping=(0.01,))))
    time = np.linspace(0.0, 0.3, 301)
    omega = 2.0 * np.pi * closed_form(CLAMPED_FREE[0], strip())

    def dying(zeta: float) -> np.ndarray:
        turn = omega * math.sqrt(1.0 - zeta**2)
        swing = np.cos(turn * time) + zeta / math.sqrt(1.0 - zeta**2) * np.sin(turn * time)
        return np.asarray(1e-5 * np.exp(-zeta * omega * time) * swing)

    said, place = by_motion(
        system, "other", lambda of: Denoc(of).simulate([1e-5], [0.0], time).position[:, 0], dying(0.02) - dying(0.01)
    )
    assert place == {"link": "rod", "value": "modal_damping"}
    factor = float(said.split("modal damping of link 'rod' ")[1].split()[0])
    assert factor == pytest.approx(2.0, rel=1e-3)


def test_what_of_the_foreshortening_is_counted_is_named_and_not_the_mass():
    # Southwell: the square of a hanging beam's frequency grows in proportion to its stiffening by weight.
    system = flexible_pendulum(strip(mass=PAPER_MASS, modes=3))
    beam = system.links[0].beam
    assert beam is not None
    bare = system.replace_link(flexible_link("rod", replace(beam, geometric_stiffening=False)))
    true, without = (Denoc(of).frequencies([0.0] * 4) for of in (system, bare))
    half = np.sqrt(0.5 * (true**2 + without**2))
    afloat = Denoc(replace(system, gravity=np.zeros(3))).frequencies([0.0] * 4)
    ratios = dict(enumerate(half / true))
    said, place = by_frequencies(system, "other", true, ratios, mode=1, weightless=dict.fromkeys(afloat[1:3], 1.0))
    assert place == {"mode": 2, "link": "rod", "value": "geometric_stiffening"}
    assert " or " not in said
    assert float(said.split("geometric stiffening of link 'rod' ")[1].split()[0]) == pytest.approx(0.5, rel=1e-3)


def of_payload(link: Link) -> np.ndarray:
    """Inertia about the joint of a payload of 0.05 kg at 0.5 m, with its own."""
    across = np.eye(3) - np.outer(link.beam.direction, link.beam.direction)
    return link.beam.payload_inertia + 0.05 * 0.5**2 * across


def of_beam(link: Link, **values: float) -> Link:
    return flexible_link(link.name, replace(link.beam, **values))


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (lambda link: with_moments(link, 0.0, 0.05 * 0.5 * link.beam.direction, NONE), "+1 times the payload's first moment"),
        (lambda link: with_moments(link, 0.0, NONE[0], of_payload(link)), "times the payload's inertia in the hub"),
        (lambda link: of_beam(link, payload=0.051), "payload of link 'upper' 1.02 times"),
        (lambda link: of_beam(link, bending_stiffness2=7.07), "bending stiffness2 of link 'upper' 1.01 times"),
        (lambda link: of_beam(link, material_damping=2e-3), "material damping of link 'upper' 2 times"),
        (lambda link: of_beam(link, geometric_stiffening=False), "no geometric stiffening of link 'upper'"),
    ],
)  # fmt: skip
def test_forces_name_the_number_of_the_beam(changed, said):
    system = bent()
    wrong = system.replace_link(changed(system.link("upper")))
    models = {"denoc": engine("denoc").build(system), "textbook": Textbook(system.coordinate_names, wrong)}
    rng = np.random.default_rng(4)
    q, qd = 0.02 * rng.standard_normal((3, system.nv)), 0.1 * rng.standard_normal((3, system.nv))
    found, place = by_forces(Bench(built_in()["bent_in_space"], system, models), "textbook", q, qd)
    assert said in found.split(" or ")[0]
    assert place["link"] == "upper"
