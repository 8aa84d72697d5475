"""A flexible link's integrals against closed forms, and what it is mounted on against frequencies from elsewhere."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from harness.denoc.beam.integrals import BENDING, BENDING2, TORSION, beam_data
from harness.denoc.beam.shapes import Mount, characteristic_roots
from harness.errors import InputError
from harness.system import Beam, Joint, JointType, Link, System
from harness.system.description import constant
from harness.system.flexible_link import flexible_link

LENGTH, HUB = 0.3, 2e-5
RHO = 7850.0 * 0.025 * 0.001
EI = 2.0e11 * 0.025 * 0.001**3 / 12.0


def beam(**changes):
    facts = {
        "length": LENGTH,
        "direction": constant([0.0, 0.0, -1.0]),
        "bending": constant([1.0, 0.0, 0.0]),
        "mass": RHO * LENGTH,
        "bending_stiffness": EI,
    }
    return Beam(**(facts | changes))


def pendulum(*, joint=JointType.REVOLUTE, armature=HUB, axis=(0.0, -1.0, 0.0), **changes):
    """The flexible pendulum; its axis is the plane's normal, d × e = (0, -1, 0)."""
    pivot = Joint("pivot", joint, "base", "rod", axis=constant(axis), armature=armature)
    return System("pendulum", (pivot,), (flexible_link("rod", beam(**changes)),))


def body(name, mass, com, inertia):
    return Link(name, mass, constant(com), constant(np.diag(inertia)))


def own_frequencies(system, *, hub, payload=0.0):
    """Frequencies [Hz] of the link alone from its integrals: the joint's coordinate first, then the modes."""
    data = beam_data(system, "rod")
    m = data.coordinates
    mass, stiffness = np.zeros((m + 1, m + 1)), np.zeros((m + 1, m + 1))
    mass[0, 0] = data.rho * LENGTH**3 / 3.0 + hub + payload * LENGTH**2
    mass[0, 1:] = mass[1:, 0] = data.rho * data.S2 + payload * LENGTH * data.S3
    mass[1:, 1:] = data.rho * data.S1 + payload * np.outer(data.S3, data.S3)
    stiffness[1:, 1:] = data.K
    return np.sqrt(np.maximum(scipy.linalg.eigvalsh(stiffness, mass), 0.0))[1:] / (2.0 * np.pi)


@pytest.mark.parametrize("modes", [1, 5, 20])
def test_integrals_of_a_cantilever_have_their_closed_forms(modes):
    # Clamped-free modes one at the tip: ∫ s² = l/4, ∫ s s = 0, ∫ s''² = z⁴/(4 l³); with σ = (sinh - sin)/(cosh + cos),
    # |∫ s dx| = σ l / z and |∫ x s dx| = l² / z² (from EI s'''' = ω² ρ s integrated once and twice).
    data = beam_data(pendulum(modes=modes, joint=JointType.FIXED, armature=0.0), "rod")
    z = characteristic_roots(Mount(), modes)
    sigma = (np.tanh(z) - np.sin(z) / np.cosh(z)) / (1.0 + np.cos(z) / np.cosh(z))
    np.testing.assert_allclose(data.S1, np.eye(modes) * LENGTH / 4.0, atol=1e-12 * LENGTH)
    np.testing.assert_allclose(np.abs(data.S0), sigma * LENGTH / z, rtol=1e-11)
    np.testing.assert_allclose(np.abs(data.S2), LENGTH**2 / z**2, rtol=1e-10)
    np.testing.assert_allclose(data.S3, 1.0, rtol=1e-10)
    diagonal = EI * z**4 / (4.0 * LENGTH**3)
    np.testing.assert_allclose(np.diag(data.K), diagonal, rtol=1e-11)
    np.testing.assert_allclose(data.K - np.diag(np.diag(data.K)), 0.0, atol=1e-11 * diagonal[-1])


def test_first_cantilever_mode_has_the_known_integrals():
    # R. D. Blevins and any handbook: ∫ s = 0.3915 l, ∫ x s = 0.2844 l² for the mode that is one at the tip;
    # static foreshortening coefficient of the first mode, ∫ s'² = 1.1619 / l (Rayleigh quotient of a heavy column).
    data = beam_data(pendulum(joint=JointType.FIXED, armature=0.0), "rod")
    assert data.S0[0] / LENGTH == pytest.approx(0.3915, abs=5e-5)
    assert data.S2[0] / LENGTH**2 == pytest.approx(0.2844, abs=5e-5)
    assert data.tip.H[0, 0] * LENGTH == pytest.approx(1.1619, abs=5e-5)


def test_foreshortening_is_the_integral_of_slopes():
    # For s = (x / l)² the slopes give H(x) = 4 x³ / (3 l⁴) exactly.
    station = np.linspace(0.0, 1.0, 9)
    system = pendulum(shapes="samples", shape_samples=np.column_stack([station, station**2]))
    data = beam_data(system, "rod")
    np.testing.assert_allclose(data.H[:, 0, 0], 4.0 * data.x**3 / (3.0 * LENGTH**4), rtol=1e-9)
    at = data.at(0.1)
    assert at.H[0, 0] == pytest.approx(4.0 * 0.1**3 / (3.0 * LENGTH**4), rel=1e-9)
    assert at.s[0] == pytest.approx(1.0 / 9.0, rel=1e-12)
    assert data.K[0, 0] == pytest.approx(4.0 * EI / LENGTH**3, rel=1e-10)
    assert data.S1[0, 0] == pytest.approx(LENGTH / 5.0, rel=1e-10)
    assert data.weights @ data.H[:, 0, 0] == pytest.approx(1.0 / 3.0, rel=1e-10)


@pytest.mark.parametrize("modes", [1, 6])
def test_quadrature_is_exact_to_rounding(modes):
    # The same integrals on a composite rule of 400 panels.
    data = beam_data(pendulum(modes=modes, payload=0.03), "rod")
    edges = np.linspace(0.0, LENGTH, 401)
    node, weight = np.polynomial.legendre.leggauss(4)
    x = (0.5 * (edges[1:] + edges[:-1])[:, None] + 0.5 * np.diff(edges)[:, None] * node).ravel()
    w = (0.5 * np.diff(edges)[:, None] * weight).ravel()
    s, slope = data.shapes[0].value(x), data.shapes[0].slope(x)
    np.testing.assert_allclose(data.S1, s.T @ (w[:, None] * s), rtol=1e-11)
    np.testing.assert_allclose(data.tip.H, slope.T @ (w[:, None] * slope), rtol=1e-10)
    # H at the nodes: the same rule on the part of the beam before each.
    for k in (0, len(data.x) // 2, len(data.x) - 1):
        inside = data.shapes[0].slope(x * data.x[k] / LENGTH)
        np.testing.assert_allclose(
            data.H[k], data.x[k] / LENGTH * inside.T @ (w[:, None] * inside), rtol=1e-10, atol=1e-14
        )


@pytest.mark.parametrize(
    ("modes", "expected"), [(1, [37.540]), (3, [37.540, 103.08, 186.29])], ids=["one mode", "three modes"]
)
def test_hub_modes_alone_vibrate_at_the_true_frequency(modes, expected):
    # Closed form of the pinned strip with hub inertia.
    np.testing.assert_allclose(own_frequencies(pendulum(modes=modes), hub=HUB), expected, rtol=5e-5)


def test_one_clamped_mode_is_a_fifth_too_high():
    # What the hub-consistent default is for.
    found = own_frequencies(pendulum(shapes="clamped_free"), hub=HUB)[0]
    assert 1.15 * 37.540 < found < 1.25 * 37.540


def test_shapes_know_the_payload():
    payload = 0.02
    found = own_frequencies(pendulum(modes=3, payload=payload), hub=HUB, payload=payload)
    mount = Mount(free_hub=True, hub=HUB / (RHO * LENGTH**3), mass=payload / (RHO * LENGTH))
    closed = characteristic_roots(mount, 3) ** 2 * np.sqrt(EI / RHO) / LENGTH**2 / (2.0 * np.pi)
    np.testing.assert_allclose(found, closed, rtol=1e-10)


def test_axis_in_the_bending_plane_holds_the_root():
    assert beam_data(pendulum(axis=(1.0, 0.0, 0.0)), "rod").shape == "clamped_free"
    assert beam_data(pendulum(axis=(0.0, 0.0, 1.0)), "rod").shape == "clamped_free"
    assert beam_data(pendulum(axis=(0.0, 1.0, 0.0)), "rod").shape == "hub"


def test_a_rigid_hub_body_counts_as_hub_inertia():
    # A disc of 1e-5 on the joint, the beam welded to it: the same as an armature of 1e-5 more.
    pivot = Joint("pivot", JointType.REVOLUTE, "base", "hub", axis=constant([0.0, -1.0, 0.0]), armature=1e-5)
    weld = Joint("weld", JointType.FIXED, "hub", "rod")
    rod = flexible_link("rod", beam(modes=2))
    system = System("disc", (pivot, weld), (body("hub", 0.1, [0, 0, 0], [1e-5] * 3), rod))
    welded, whole = beam_data(system, "rod"), beam_data(pendulum(modes=2), "rod")
    np.testing.assert_allclose(welded.S1, whole.S1, rtol=1e-12)
    # On a hub of radius l the hinge lies a length behind the root: the shape is another, and still hub-consistent.
    far = replace(weld, xyz=constant([0.0, 0.0, -LENGTH]))
    offset = beam_data(System("radius", (pivot, far), system.links), "rod")
    assert offset.shape == "hub"
    mount = Mount(free_hub=True, hub=HUB / (RHO * LENGTH**3), radius=1.0)
    np.testing.assert_allclose(offset.shapes[0].roots, characteristic_roots(mount, 2), rtol=1e-12)


def test_a_welded_tip_body_counts_as_payload():
    mass, own = 0.03, 4e-6
    payload = pendulum(modes=2, payload=mass, payload_inertia=constant(own * np.eye(3)))
    rod = pendulum(modes=2)
    weld = Joint("weld", JointType.FIXED, "rod", "tool", xyz=constant([0.0, 0.0, -LENGTH]))
    carried = System("tool", (*rod.joints, weld), (*rod.links, body("tool", mass, [0, 0, 0], [own] * 3)))
    np.testing.assert_allclose(
        beam_data(carried, "rod").shapes[0].roots, beam_data(payload, "rod").shapes[0].roots, rtol=1e-12
    )


def test_a_hinged_rod_at_the_tip_weighs_a_quarter_of_itself():
    # A uniform rod hinged at one end and hit there: its hinge moves as a mass of m - (m l/2)² / (m l²/3) = m/4.
    rod = pendulum(modes=1)
    mass, long = 0.08, 0.2
    elbow = Joint(
        "elbow", JointType.REVOLUTE, "rod", "arm", xyz=constant([0.0, 0.0, -LENGTH]), axis=constant([0.0, 1.0, 0.0])
    )
    arm = body("arm", mass, [0.0, 0.0, -long / 2.0], [mass * long**2 / 12.0, mass * long**2 / 12.0, 0.0])
    chain = System("chain", (*rod.joints, elbow), (*rod.links, arm))
    quarter = pendulum(modes=1, payload=mass / 4.0)
    np.testing.assert_allclose(
        beam_data(chain, "rod").shapes[0].roots, beam_data(quarter, "rod").shapes[0].roots, rtol=1e-10
    )


def test_modal_ratios_come_out_of_the_damped_link():
    # Eigenvalues of the link as mounted, joint coordinate included: Re λ = -ζ ω for light damping of a mode that
    # the damping matrix does not couple to others.
    ratios = (0.01, 0.03)
    data = beam_data(pendulum(modes=4, modal_damping=ratios, payload=0.01), "rod")
    m, payload = 4, 0.01
    mass, stiffness, damping = np.zeros((5, 5)), np.zeros((5, 5)), np.zeros((5, 5))
    mass[0, 0] = data.rho * LENGTH**3 / 3.0 + HUB + payload * LENGTH**2
    mass[0, 1:] = mass[1:, 0] = data.rho * data.S2 + payload * LENGTH * data.S3
    mass[1:, 1:] = data.rho * data.S1 + payload * np.outer(data.S3, data.S3)
    stiffness[1:, 1:], damping[1:, 1:] = data.K, data.C
    inverse = np.linalg.inv(mass)
    state = np.block([[np.zeros((m + 1, m + 1)), np.eye(m + 1)], [-inverse @ stiffness, -inverse @ damping]])
    values = np.linalg.eigvals(state)
    values = values[values.imag > 1.0]
    values = values[np.argsort(values.imag)]
    np.testing.assert_allclose(-values.real / np.abs(values), [*ratios, 0.0, 0.0], atol=1e-9)


def test_material_damping_is_proportional_to_stiffness():
    data = beam_data(pendulum(modes=3, material_damping=1e-4), "rod")
    np.testing.assert_allclose(data.C, 1e-4 * data.K, rtol=1e-14)


def test_two_planes_and_twist_do_not_mix():
    data = beam_data(
        pendulum(
            modes=2,
            bending2=True,
            bending_stiffness2=3.0 * EI,
            torsion_modes=1,
            torsional_stiffness=2.0,
            polar_inertia=1e-5,
        ),
        "rod",
    )
    assert list(data.plane) == [BENDING, BENDING, BENDING2, BENDING2, TORSION]
    for matrix in (data.S1, data.K, data.tip.H):
        assert np.all(matrix[:2, 2:] == 0.0)
        assert np.all(matrix[2:4, 4:] == 0.0)
    assert np.all(data.H[:, 4, 4] == 0.0)
    # Clamped-free twist sin(π x / 2 l): GJ ∫ s'² = GJ π² / (8 l).
    assert data.K[4, 4] == pytest.approx(2.0 * np.pi**2 / (8.0 * LENGTH), rel=1e-12)
    np.testing.assert_allclose(data.normal, [0.0, -1.0, 0.0])
    # The joint turns the first plane only.
    assert data.shapes[0].name == "hub"
    assert data.shapes[1].name == "clamped_free"


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"bending_stiffness": 0.0}, "bending stiffness of 0"),
        ({"bending_stiffness": -1.0}, "bending stiffness of -1"),
        ({"bending_stiffness": float("nan")}, "bending stiffness of nan"),
        ({"bending2": True}, "second plane"),
        ({"torsion_modes": 1}, "torsional stiffness"),
        ({"modes": 21}, "21 modes"),
        ({"modal_damping": (0.1, 0.1)}, "modal damping"),
        ({"payload": -0.1}, "payload"),
        ({"bending": constant([0.0, 0.0, 1.0])}, "along the link"),
        ({"bending": constant([0.0, 0.0, 0.0])}, "no unit vector"),
    ],
)
def test_unsound_beams_are_refused_by_name(changes, word):
    with pytest.raises(InputError, match=word) as caught:
        beam_data(pendulum(**changes), "rod")
    assert "'rod'" in str(caught.value)


def test_a_rigid_link_has_no_beam_data():
    system = pendulum().rigid()
    with pytest.raises(InputError, match="rigid"):
        beam_data(system, "rod")
