"""The meshed bar in a floating frame against closed forms; the mesh against the bar it stands for."""

import functools
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("exudyn")

import steel_strip
from steel_strip import HUB

from harness.denoc.beam.shapes import frequencies, mount_ratios
from harness.engines.exudyn_ffrf import Ffrf
from harness.engines.protocol import Engine
from harness.engines.solid_mesh import _NATURAL, _shape, bar
from harness.errors import EngineUnavailableError, UnsupportedError
from harness.system import JointType
from harness.system.description import constant

pendulum = functools.partial(steel_strip.pendulum, geometric_stiffening=False)


def test_shape_functions_are_one_at_their_node_and_reproduce_linear_fields():
    for j, node in enumerate(_NATURAL):
        np.testing.assert_allclose(_shape(node)[0], np.eye(20)[j], atol=1e-15)
    at = np.array([0.3, -0.2, 0.7])
    value, gradient = _shape(at)
    np.testing.assert_allclose(value @ _NATURAL, at, atol=1e-14)
    np.testing.assert_allclose(gradient.T @ _NATURAL, np.eye(3), atol=1e-14)
    assert value.sum() == pytest.approx(1.0, abs=1e-14)


def test_the_mesh_has_the_mass_and_inertia_of_the_bar_and_six_rigid_motions():
    length, depth, width, density = 0.3, 0.02, 0.025, 7850.0
    meshed = bar(length, depth, width, density, 2e11, 5)
    mass = density * length * depth * width
    one = np.tile(np.eye(3), (len(meshed.nodes), 1))
    turn = np.vstack([np.array([-y, x, 0.0]) for x, y, _ in meshed.nodes]).ravel()
    np.testing.assert_allclose(one.T @ (meshed.mass @ one), mass * np.eye(3), atol=1e-12)
    # A turn about z through the root: m (l²/3 + depth²/12).
    assert turn @ (meshed.mass @ turn) == pytest.approx(mass * (length**2 / 3.0 + depth**2 / 12.0), rel=1e-12)
    assert np.max(np.abs(meshed.stiffness @ turn)) < 1e-9 * abs(meshed.stiffness).max()
    values = np.linalg.eigvalsh(meshed.stiffness.toarray())
    assert np.sum(values < 1e-10 * values[-1]) == 6


def test_a_bar_in_tension_and_in_pure_bending():
    # Quadratic bricks hold both fields exactly: u = x, and the parabola of constant curvature with its strain -y κ.
    length, depth, width, modulus = 0.3, 0.02, 0.025, 2e11
    meshed = bar(length, depth, width, 1.0, modulus, 3)
    x, y, _ = meshed.nodes.T
    stretch = np.column_stack([x, 0.0 * x, 0.0 * x]).ravel()
    assert stretch @ (meshed.stiffness @ stretch) == pytest.approx(modulus * depth * width * length, rel=1e-10)
    bend = np.column_stack([-x * y, 0.5 * x**2, 0.0 * x]).ravel()
    bending_stiffness = modulus * width * depth**3 / 12.0
    assert bend @ (meshed.stiffness @ bend) == pytest.approx(bending_stiffness * length, rel=1e-9)


def test_frequencies_are_the_closed_forms():
    for joint, free, hub in ((JointType.REVOLUTE, True, HUB), (JointType.FIXED, False, 0.0)):
        system = pendulum(gravity=0.0, joint=joint, armature=hub)
        beam = system.link("rod").beam
        exact = frequencies(beam, mount_ratios(beam, free_hub=free, hub_inertia=hub), 3)
        found = Ffrf().build(system).frequencies(np.zeros(len(system.coordinate_names)))
        # A thin brick's shear makes it 5e-5 too stiff in the first mode, 3e-4 in the third.
        assert np.all(np.abs(found[:3] / exact - 1.0) < [1e-4, 3e-4, 5e-4])


def test_payload_is_carried_by_the_tip():
    system = pendulum(gravity=0.0, payload=0.03)
    beam = system.link("rod").beam
    exact = frequencies(beam, mount_ratios(beam, free_hub=True, hub_inertia=HUB, tip_mass=0.03), 2)
    found = Ffrf().build(system).frequencies(np.zeros(2))
    np.testing.assert_allclose(found[:2], exact, rtol=1e-3)


def test_a_thick_bar_swings_as_a_rigid_one():
    # Small swing of a rod about its end, slender line and hub: θ = θ0 cos ω t.
    system = pendulum(thickness=0.01)
    inertia = system.link("rod").mass * (0.3**2 / 3.0 + 0.01**2 / 12.0) + HUB
    omega = np.sqrt(system.link("rod").mass * 9.81 * 0.15 / inertia)
    time = np.linspace(0.0, 1.0, 201)
    run = Ffrf(elements=12, modes=2).build(system).simulate(np.array([0.02, 0.0]), np.zeros(2), time, step=5e-4)
    np.testing.assert_allclose(run.position[:, 0], 0.02 * np.cos(omega * time), atol=2e-5)


def test_a_released_cantilever_swings_about_its_static_deflection():
    # ρ g l⁴ / (8 EI) at the tip, and twice that on release (the first mode carries 97 % of it).
    system, static = steel_strip.cantilever(geometric_stiffening=False)
    time = np.linspace(0.0, 0.5, 1001)
    deflection = (
        Ffrf(elements=32, modes=3).build(system).simulate(np.zeros(1), np.zeros(1), time, step=2.5e-4).channels
    )["rod.tip_deflection"]
    assert np.mean(deflection) == pytest.approx(static, rel=0.02)
    assert np.min(deflection) == pytest.approx(2.0 * static, rel=0.05)


def test_nothing_is_printed_or_written(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    model = Ffrf(elements=8, modes=2).build(pendulum())
    model.simulate(np.array([1.0, 0.0]), np.zeros(2), np.linspace(0.0, 0.01, 11))
    assert capfd.readouterr() == ("", "")
    assert list(Path.cwd().iterdir()) == []


@pytest.mark.parametrize(
    ("system", "word"),
    [
        (pendulum().rigid(), "no elastic link"),
        (pendulum(geometric_stiffening=True), "does not stiffen"),
        (pendulum(width=float("nan")), "width and thickness"),
        (pendulum(modal_damping=(0.01,)), "modal damping"),
        (pendulum(payload=0.1, payload_inertia=constant(np.eye(3))), "point mass"),
    ],
)
def test_what_it_cannot_express_is_refused_in_one_line(system, word):
    assert isinstance(Ffrf(), Engine)
    assert word in Ffrf().refuses(system)
    with pytest.raises(UnsupportedError, match=word):
        Ffrf().build(system)


def test_without_exudyn_it_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "exudyn", None)
    with pytest.raises(EngineUnavailableError, match=r"denoc-harness\[engines\]"):
        Ffrf().build(pendulum())
