"""A centre of mass beside the axis that it is drawn on: where it may be, along what, and what it does to a rotor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness import effects
from harness.denoc import Denoc
from harness.effects.catalogue import effect, sites
from harness.effects.imbalance import across
from harness.system import Attachment, Joint, JointType, Link, System
from harness.system.description import constant


def wheel(
    axis: tuple[float, float, float] = (0.0, 1.0, 0.0), com: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> System:
    joint = Joint("shaft", JointType.REVOLUTE, "base", "disc", axis=constant(np.array(axis)))
    link = Link("disc", 1.5, constant(np.array(com)), constant(np.diag([0.002, 0.004, 0.002])))
    return System("wheel", (joint,), (link,))


@pytest.mark.parametrize(
    "axis", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0), (0.6, 0.0, 0.8), (0.3, -0.5, 0.2)]
)
def test_the_directions_are_square_to_the_axis_and_right_handed(axis) -> None:
    u, v = across(np.array(axis))
    along = np.array(axis) / np.linalg.norm(axis)
    assert np.allclose(np.column_stack([u, v, along]).T @ np.column_stack([u, v, along]), np.eye(3), atol=1e-15)
    assert np.linalg.det(np.column_stack([u, v, along])) == pytest.approx(1.0)


def test_a_drawing_in_line_with_the_bodys_axes_has_shifts_along_these() -> None:
    x, y, z = np.eye(3)
    for axis, first, second in ((x, y, z), (y, z, x), (z, x, y)):
        u, v = across(axis)
        assert np.array_equal(u, first)
        assert np.array_equal(v, second)


def test_gravity_pulls_at_it_once_a_turn() -> None:
    shifted = effects.apply(wheel(), Attachment("imbalance", "disc", {"u": -0.00035, "v": 0.0002}))
    assert np.allclose(shifted.link("disc").com, [0.0002, 0.0, -0.00035], rtol=0, atol=1e-18)
    angles = np.linspace(0.0, 2.0 * np.pi, 9)
    torque = [Denoc(shifted).gravity(np.array([q]))[0] for q in angles]
    # About y a turn by q takes (x, z) to x cos q + z sin q from the axis; its weight turns it further down.
    assert torque == pytest.approx(-1.5 * 9.81 * (0.0002 * np.cos(angles) - 0.00035 * np.sin(angles)), abs=1e-12)


def test_it_is_of_links_on_their_axis_alone() -> None:
    law = effect("imbalance")
    assert sites(law, wheel()) == ("disc",)
    assert sites(law, wheel(com=(0.0, 0.03, 0.0))) == ("disc",)
    assert sites(law, wheel(com=(1e-6, 0.0, 0.0))) == ()
    # Nothing pulls a weight aside about an axis that stands plumb, unless that axis moves.
    assert sites(law, wheel(axis=(0.0, 0.0, 1.0))) == ()
    (joint,), (disc,) = wheel(axis=(0.0, 0.0, 1.0)).joints, wheel().links
    slide = Joint("rail", JointType.PRISMATIC, "base", "cart", axis=constant(np.array([1.0, 0.0, 0.0])))
    cart = Link("cart", 1.0, constant(np.zeros(3)), constant(np.diag([0.01] * 3)))
    carried = System("carried", (slide, replace(joint, parent="cart")), (cart, disc))
    assert sites(law, carried) == ("disc",)
