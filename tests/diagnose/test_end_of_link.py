"""A link ends where the nominal model says, however its inertia is bent: what sits there moves smoothly with every quantity."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import harness
from harness.diagnose.problem.hypothesis import nominal_quantities, scaled
from harness.effects.attach import apply
from harness.effects.scale import tip_of
from harness.system import Attachment, Joint, JointType, Link, System
from harness.system.description import constant
from harness.system.write import write

MASS, LENGTH, LOAD = 0.3, 0.4, 0.2
SMALL = 1e-6


@pytest.fixture
def rod() -> System:
    """A uniform rod on a joint: its inertia is that of no other rod with a bob, so that its end is a root's end."""
    joint = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0.0, 1.0, 0.0]))
    across = MASS * LENGTH**2 / 12.0
    link = Link("rod", MASS, constant([0.0, 0.0, -LENGTH / 2.0]), constant(np.diag([across, across, 1e-9])))
    return System("rod", (joint,), (link,))


@pytest.mark.parametrize("kind", ["mass", "length", "inertia"])
def test_a_load_at_the_end_moves_as_smoothly_as_what_is_bent(rod: System, kind: str) -> None:
    quantities = nominal_quantities(rod)
    assert kind in {q.kind for q in quantities}
    places = []
    for change in (-SMALL, 0.0, SMALL):
        bent = scaled(rod, quantities, [1.0 + change * (q.kind == kind) for q in quantities])
        loaded = apply(bent, Attachment("payload_mass", "rod", {"mass": LOAD}))
        places.append(float(loaded.link("rod").com[2]))
    # Rod and point mass by hand: the centre of both.
    assert places[1] == pytest.approx(-(MASS * LENGTH / 2.0 + LOAD * LENGTH) / (MASS + LOAD), rel=1e-12)
    assert abs(places[2] - places[0]) < 5.0 * SMALL * LENGTH


def test_only_the_length_moves_the_end(rod: System) -> None:
    quantities = nominal_quantities(rod)
    for k, quantity in enumerate(quantities):
        bent = scaled(rod, quantities, [1.1 if j == k else 1.0 for j in range(len(quantities))])
        expected = 1.1 * LENGTH if quantity.kind == "length" else LENGTH
        assert float(np.linalg.norm(tip_of(bent.link("rod"), bent))) == pytest.approx(expected, rel=1e-12)


def test_a_model_may_state_the_end(rod: System, tmp_path: Path) -> None:
    text = """
[[joint]]
name = "pivot"
type = "revolute"
parent = "base"
child = "rod"
axis = [0, 1, 0]
[[link]]
name = "rod"
mass = 0.3
com = [0, 0, -0.1]
inertia = [1e-3, 1e-3, 1e-6]
end = [0, 0, -0.5]
"""
    (tmp_path / "rod.toml").write_text(text, encoding="utf-8")
    system = harness.load(tmp_path / "rod.toml")
    assert tip_of(system.link("rod"), system) == pytest.approx([0.0, 0.0, -0.5])
    loaded = apply(system, Attachment("payload_mass", "rod", {"mass": 0.1}))
    assert float(loaded.link("rod").com[2]) == pytest.approx(-(0.3 * 0.1 + 0.1 * 0.5) / 0.4)
    write(loaded, tmp_path / "again.toml")
    again = harness.load(tmp_path / "again.toml")
    assert tip_of(again.link("rod"), again) == pytest.approx([0.0, 0.0, -0.5])
