"""Exact beam shapes against closed forms, published roots and an independent Rayleigh-Ritz solution."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial import legendre

from harness.denoc.beam.shapes import (
    MODE_LIMIT,
    Mount,
    characteristic_roots,
    exact_shapes,
    frequencies,
    mode_shapes,
    mount_ratios,
    torsion_shapes,
)
from harness.errors import InputError
from harness.system import Beam
from harness.system.description import constant

LENGTH, WIDTH, THICKNESS, YOUNG, DENSITY, HUB = 0.3, 0.025, 0.001, 2.0e11, 7850.0, 2e-5


def strip(**changes):
    """The steel strip of the flexible pendulum."""
    facts = {
        "length": LENGTH,
        "direction": constant([0.0, 0.0, -1.0]),
        "bending": constant([1.0, 0.0, 0.0]),
        "mass": DENSITY * WIDTH * THICKNESS * LENGTH,
        "bending_stiffness": YOUNG * WIDTH * THICKNESS**3 / 12.0,
    }
    return Beam(**(facts | changes))


def ritz_roots(mount: Mount, count: int, terms: int = 34) -> np.ndarray:
    """β l by Rayleigh-Ritz on Legendre polynomials: knows nothing of trigonometric functions or boundary conditions
    of force. Deflection w = w'(0) (x + r) + ∫∫ curvature, curvature = Σ c_k P_k(2x - 1)."""
    node, weight = legendre.leggauss(2 * terms)
    x, w = 0.5 * (node + 1.0), 0.5 * weight
    columns = []
    for k in range(terms):
        curvature = np.zeros(k + 1)
        curvature[k] = 1.0
        slope = legendre.legint(curvature, scl=0.5, lbnd=-1.0)
        deflection = legendre.legint(slope, scl=0.5, lbnd=-1.0)
        columns.append((deflection, slope, curvature))

    def at(series, points):
        return np.stack([legendre.legval(2.0 * points - 1.0, c) for c in series], axis=-1)

    one = np.array([1.0])
    u, k2 = at([c[0] for c in columns], x), at([c[2] for c in columns], x)
    tip, tip_slope = at([c[0] for c in columns], one)[0], at([c[1] for c in columns], one)[0]
    root_slope = np.zeros(terms)
    if mount.free_hub:
        u = np.column_stack([x + mount.radius, u])
        k2 = np.column_stack([np.zeros_like(x), k2])
        tip, tip_slope = np.append(1.0 + mount.radius, tip), np.append(1.0, tip_slope)
        root_slope = np.append(1.0, root_slope)
    mass = u.T @ (w[:, None] * u) + mount.mass * np.outer(tip, tip) + mount.inertia * np.outer(tip_slope, tip_slope)
    mass += mount.moment * (np.outer(tip, tip_slope) + np.outer(tip_slope, tip))
    mass += mount.hub * np.outer(root_slope, root_slope)
    stiffness = k2.T @ (w[:, None] * k2)
    squares = scipy.linalg.eigvalsh(stiffness, mass)[int(mount.free_hub) :]
    return squares[:count] ** 0.25


@pytest.mark.parametrize(
    ("mount", "roots"),
    [
        # R. D. Blevins, Formulas for Natural Frequency and Mode Shape (1979), table 8-1.
        (Mount(), [1.87510407, 4.69409113, 7.85475744, 10.99554073, 14.13716839]),
        (Mount(free_hub=True), [3.92660231, 7.06858275, 10.21017612, 13.35176878, 16.49336143]),
    ],
)
def test_roots_of_plain_beams_are_the_tabulated_ones(mount, roots):
    np.testing.assert_allclose(characteristic_roots(mount, 5), roots, rtol=3e-9)


def test_roots_with_a_tip_mass_equal_to_the_beam():
    # 1 + cosh z cos z + z (cos z sinh z - sin z cosh z) = 0; the squares are those of the literature.
    roots = characteristic_roots(Mount(mass=1.0), 5)
    np.testing.assert_allclose(roots**2, [1.557298, 16.25009, 50.89584, 105.1983, 179.2320], rtol=1e-6)
    residual = 1.0 + np.cosh(roots) * np.cos(roots)
    residual += roots * (np.cos(roots) * np.sinh(roots) - np.sin(roots) * np.cosh(roots))
    np.testing.assert_allclose(residual / np.cosh(roots), 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("free_hub", "hub", "expected"),
    [
        (False, 0.0, [9.0598, 56.777, 158.98]),
        (True, 0.0, [39.728, 128.75]),
        (True, HUB, [37.540, 103.08, 186.29]),
    ],
)
def test_frequencies_of_the_flexible_pendulum(free_hub, hub, expected):
    # Closed forms of the steel strip, given to five digits; the roots behind them are held to 1e-9 elsewhere.
    beam = strip()
    found = frequencies(beam, mount_ratios(beam, free_hub=free_hub, hub_inertia=hub), len(expected))
    np.testing.assert_allclose(found, expected, rtol=5e-5)


def test_roots_of_a_pinned_beam_with_hub_solve_the_textbook_equation():
    # Pinned at x = 0 with inertia h, free at 1: cos z sinh z - sin z cosh z = h z³ (1 + cos z cosh z).
    h = 0.7
    z = characteristic_roots(Mount(free_hub=True, hub=h), 6)
    residual = np.cos(z) * np.tanh(z) - np.sin(z) - h * z**3 * (1.0 / np.cosh(z) + np.cos(z))
    np.testing.assert_allclose(residual / (1.0 + h * z**3), 0.0, atol=1e-12)


ratio = st.one_of(st.just(0.0), st.floats(1e-3, 30.0))


@settings(max_examples=60, deadline=None, derandomize=True)
@given(free=st.booleans(), hub=ratio, radius=st.floats(0.0, 1.0), mass=ratio, beyond=st.floats(0.0, 1.0), own=ratio)
def test_no_root_is_missed_or_invented(free, hub, radius, mass, beyond, own):
    mount = Mount(free, hub * free, radius * free, mass, mass * beyond, mass * beyond**2 + own)
    # The Ritz side loses digits to its highest eigenvalue: 1e-16 of 1e9 is 1e-7 of a squared root near one.
    np.testing.assert_allclose(characteristic_roots(mount, 8), ritz_roots(mount, 8), rtol=1e-6)


def test_lowest_root_of_a_heavy_tip_is_the_massless_cantilever():
    # A beam without mass of its own: ω² = 3 EI / (m l³), so z⁴ = 3 / μ; Rayleigh's correction is 33/140 of the beam.
    mu = 1e5
    z = characteristic_roots(Mount(mass=mu), 1)[0]
    assert z**4 == pytest.approx(3.0 / (mu + 33.0 / 140.0), rel=1e-9)


def test_high_modes_keep_their_shape():
    # Clamped-free modes are ±1 at the tip when ∫ s² = l/4, and z_k -> (k - 1/2) π; a cosh form has lost all
    # digits at k = 12.
    shapes = exact_shapes(Mount(), LENGTH, MODE_LIMIT, name="clamped_free", why="")
    np.testing.assert_allclose(shapes.value(LENGTH)[0], 1.0, rtol=1e-10)
    np.testing.assert_allclose(shapes.value(0.0)[0], 0.0, atol=1e-13)
    np.testing.assert_allclose(shapes.slope(0.0)[0] * LENGTH / shapes.roots, 0.0, atol=1e-13)
    np.testing.assert_allclose(shapes.curvature(LENGTH)[0] * (LENGTH / shapes.roots) ** 2, 0.0, atol=1e-12)
    np.testing.assert_allclose(shapes.roots[5:] / np.pi, np.arange(5, MODE_LIMIT) + 0.5, rtol=1e-8)


def test_shape_of_a_cantilever_is_the_textbook_one():
    shapes = exact_shapes(Mount(), 1.0, 3, name="clamped_free", why="")
    x = np.linspace(0.0, 1.0, 11)[:, None]
    z = shapes.roots
    sigma = (np.sinh(z) - np.sin(z)) / (np.cosh(z) + np.cos(z))
    classic = np.cosh(z * x) - np.cos(z * x) - sigma * (np.sinh(z * x) - np.sin(z * x))
    np.testing.assert_allclose(shapes.value(x[:, 0]), classic / classic[-1], atol=1e-11)


def test_slope_and_curvature_are_the_derivatives():
    x, h = np.linspace(0.02, 0.28, 27), 1e-5
    for free in (True, False):
        shapes = mode_shapes(strip(modes=4), free_hub=free, hub_inertia=HUB, tip_mass=0.01, tip_inertia=1e-5)
        slope = (shapes.value(x + h) - shapes.value(x - h)) / (2.0 * h)
        curvature = (shapes.slope(x + h) - shapes.slope(x - h)) / (2.0 * h)
        np.testing.assert_allclose(shapes.slope(x), slope, atol=1e-6 * np.max(np.abs(slope)))
        np.testing.assert_allclose(shapes.curvature(x), curvature, atol=1e-6 * np.max(np.abs(curvature)))


def test_hub_shapes_leave_the_root_along_its_tangent():
    shapes = mode_shapes(strip(modes=6), free_hub=True, hub_inertia=HUB)
    np.testing.assert_allclose(shapes.value(0.0), 0.0, atol=1e-13)
    np.testing.assert_allclose(shapes.slope(0.0), 0.0, atol=1e-11)
    assert np.all(shapes.value(LENGTH) > 0.0)


@pytest.mark.parametrize(
    ("kind", "free", "tip", "name"),
    [
        ("auto", True, 0.0, "hub"),
        ("auto", True, 0.05, "hub"),
        ("auto", False, 0.0, "clamped_free"),
        ("auto", False, 0.05, "tip_mass"),
        ("clamped_free", True, 0.05, "clamped_free"),
        ("tip_mass", True, 0.05, "tip_mass"),
        ("hub", True, 0.0, "hub"),
    ],
)
def test_shapes_are_picked_by_mount_or_by_name(kind, free, tip, name):
    shapes = mode_shapes(strip(shapes=kind), free_hub=free, hub_inertia=HUB, tip_mass=tip)
    assert shapes.name == name
    assert ("picked" in shapes.why and "because" in shapes.why) == (kind == "auto")
    assert ("asks for" in shapes.why) == (kind != "auto")


def test_samples_of_a_cantilever_come_back_as_its_shape():
    exact = exact_shapes(Mount(), LENGTH, 2, name="clamped_free", why="")
    station = np.linspace(0.0, 1.0, 41)
    table = np.column_stack([station, exact.value(LENGTH * station)])
    shapes = mode_shapes(strip(shapes="samples", shape_samples=table, modes=2), free_hub=True)
    x = np.linspace(0.0, LENGTH, 173)
    # A quintic spline's error is of the order (z h)^6 / 6! on the deflection, (z h)^4 on the curvature.
    np.testing.assert_allclose(shapes.value(x), exact.value(x), atol=1e-8)
    size = np.max(np.abs(exact.curvature(x)), axis=0)
    np.testing.assert_allclose(shapes.curvature(x) / size, exact.curvature(x) / size, atol=2e-5)
    np.testing.assert_allclose(shapes.slope(0.0), 0.0, atol=1e-12)


def test_three_samples_give_the_cubic_through_them():
    # w = x² is in the spline's space, so it comes back exactly.
    table = np.array([[0.0, 0.0], [0.5, 0.25], [1.0, 1.0]])
    shapes = mode_shapes(strip(shapes="samples", shape_samples=table), free_hub=False)
    np.testing.assert_allclose(shapes.curvature([0.0, 0.1, 0.3]) * LENGTH**2, 2.0, rtol=1e-10)


def test_twist_roots_are_the_tabulated_ones():
    # Clamped-free shaft (k - 1/2) π; free-free k π (measured from the root); disc at the tip z tan z = 1 / ratio.
    np.testing.assert_allclose(torsion_shapes(1.0, 3, free_hub=False).roots, np.array([0.5, 1.5, 2.5]) * np.pi)
    np.testing.assert_allclose(torsion_shapes(1.0, 3, free_hub=True).roots, np.arange(1, 4) * np.pi)
    roots = torsion_shapes(1.0, 3, free_hub=False, tip=2.0).roots
    np.testing.assert_allclose(roots * np.tan(roots), 0.5, rtol=1e-9)
    shapes = torsion_shapes(1.0, 3, free_hub=True, hub=0.5)
    np.testing.assert_allclose(shapes.value(0.0), 0.0, atol=1e-14)


@pytest.mark.parametrize(
    ("changes", "free", "word"),
    [
        ({"modes": 0}, True, "modes"),
        ({"modes": MODE_LIMIT + 1}, True, "modes"),
        ({"shapes": "hub"}, False, "hub modes"),
        ({"shapes": "bernoulli"}, True, "unknown shapes"),
        ({"shapes": "samples"}, True, "without samples"),
        ({"shapes": "samples", "shape_samples": np.zeros((7, 3))}, True, "shape samples"),
        (
            {"shapes": "samples", "shape_samples": np.ones((7, 2)) * np.linspace(0, 1, 7)[:, None] + [0, 1]},
            True,
            "zero",
        ),
        (
            {
                "shapes": "samples",
                "modes": 2,
                "shape_samples": np.linspace(0, 1, 9)[:, None] ** [[1, 2, 2]],
            },
            True,
            "depend on each other",
        ),
        ({"mass": 0.0}, True, "positive"),
    ],
)
def test_what_is_no_shape_is_refused_in_one_line(changes, free, word):
    with pytest.raises(InputError, match=word) as caught:
        mode_shapes(strip(**changes), free_hub=free)
    assert "\n" not in str(caught.value)
