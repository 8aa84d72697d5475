"""Which number of a beam a difference comes of: faults made in closed forms, named by moving the native description."""

from __future__ import annotations

import math

import numpy as np
import pytest

from harness.cases.beam_paths import CLAMPED_FREE, PAYLOAD, tip_mass_roots
from harness.cases.beams import cantilever, closed_form, strip
from harness.cases.checks.beam_blame import by_frequencies, by_motion
from harness.denoc import Denoc


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
    assert place == {"mode": 1}


def test_a_motion_that_dies_away_too_fast_is_named_for_its_damping():
    from dataclasses import replace

    from harness.system.flexible_link import flexible_link

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
