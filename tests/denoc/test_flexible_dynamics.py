"""Flexible links: Lagrange's equations from an independent kinetic energy, closed forms of beams, what sensors read."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from twisting import with_twist

from harness.denoc import Denoc
from harness.denoc.matrices import denoc_matrices
from harness.system import Beam, Joint, JointType, Link, System, random_chain, random_tree
from harness.system.flexible_link import flexible_link

LENGTH, WIDTH, THICKNESS, MODULUS, DENSITY = 0.3, 0.025, 0.001, 2.0e11, 7850.0
STIFFNESS = MODULUS * WIDTH * THICKNESS**3 / 12.0
LINE = DENSITY * WIDTH * THICKNESS


def strip(**changes: object) -> Beam:
    """The steel strip of the paper's flexible pendulum, hanging along -z and bending along x."""
    beam = Beam(
        length=LENGTH,
        direction=np.array([0.0, 0.0, -1.0]),
        bending=np.array([1.0, 0.0, 0.0]),
        mass=LINE * LENGTH,
        bending_stiffness=STIFFNESS,
        half_depth=THICKNESS / 2.0,
    )
    return replace(beam, **changes)


def pendulum(
    beam: Beam, joint: JointType = JointType.REVOLUTE, gravity: float = 9.81, axis: tuple = (0, 1, 0)
) -> System:
    hinge = Joint("pivot", joint, "base", "rod", axis=np.array(axis, dtype=float), armature=2e-5)
    return System("pendulum", (hinge,), (flexible_link("rod", beam),), gravity=np.array([0.0, 0.0, -gravity]))


CHAINS = [
    random_chain(1, 1, flexible=1.0, modes=2, bending2=True),
    random_chain(3, 2, flexible=0.6, bending2=True),
    random_tree(6, 3, flexible=0.5, fixed=0.2, armature=True),
    with_twist(random_chain(2, 6, flexible=1.0, modes=1, bending2=True)),
]


def random_state(model: Denoc, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    elastic = np.array(["mode" in name for name in model.names])
    q = np.where(elastic, 0.01 * rng.normal(size=model.n), rng.uniform(-3.0, 3.0, model.n))
    return q, rng.normal(size=model.n)


def central(function, step: float):
    """Derivative at zero by the central difference of order 6."""
    weights = (45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0)
    return sum(w * (function((k + 1) * step) - function(-(k + 1) * step)) for k, w in enumerate(weights)) / step


@pytest.mark.slow
@pytest.mark.parametrize("system", CHAINS, ids=lambda s: s.name)
def test_bias_is_lagranges_from_a_kinetic_energy_by_quadrature(system: System) -> None:
    """d/dt ∂T/∂q̇ - ∂T/∂q with T from the textbook matrices, which integrate the beams node by node."""
    model = Denoc(system)
    q, qd = random_state(model, 0)

    def mass(at: np.ndarray) -> np.ndarray:
        return denoc_matrices(system, at).inertia

    rate = central(lambda s: mass(q + s * qd), 2e-3)
    gradient = np.array([central(lambda s, e=e: 0.5 * qd @ mass(q + s * e) @ qd, 2e-3) for e in np.eye(model.n)])
    lagrange = rate @ qd - gradient
    found = model.bias(q, qd) - model.gravity(q)
    assert np.abs(found - lagrange).max() < 1e-8 * np.abs(lagrange).max()
    coriolis = model.coriolis_matrix(q, qd)
    assert np.abs(coriolis @ qd - found).max() < 1e-9 * np.abs(found).max()
    assert np.abs((rate - 2.0 * coriolis) + (rate - 2.0 * coriolis).T).max() < 1e-8 * np.abs(rate).max()


@pytest.mark.parametrize("system", CHAINS, ids=lambda s: s.name)
def test_gravity_and_elastic_forces_are_the_gradient_of_the_potential(system: System) -> None:
    model = Denoc(system)
    q, _ = random_state(model, 1)
    rest = np.zeros(model.n)
    gradient = np.array([central(lambda s, e=e: model.energy(q + s * e, rest)[1], 1e-3) for e in np.eye(model.n)])
    found = model.gravity(q) - model.passive(q, rest)
    assert np.abs(found - gradient).max() < 1e-9 * np.abs(gradient).max()


@pytest.mark.parametrize("system", CHAINS, ids=lambda s: s.name)
def test_forward_inverse_and_mass_matrix_agree(system: System) -> None:
    model = Denoc(system)
    q, qd = random_state(model, 2)
    tau = np.random.default_rng(3).normal(size=model.n)
    qdd = model.forward_dynamics(q, qd, tau)
    right = tau - model.bias(q, qd) + model.passive(q, qd)
    mass = model.mass_matrix(q)
    # Stiff modes of light beams accelerate a million times as much as the joints: what is summed tells the rounding.
    rounding = 1e-13 * (np.abs(mass) @ np.abs(qdd)).max()
    assert np.abs(mass @ qdd - right).max() < rounding
    assert np.abs(model.inverse_dynamics(q, qd, qdd) - tau).max() < rounding
    assert model.energy(q, qd)[0] == pytest.approx(0.5 * qd @ model.mass_matrix(q) @ qd, rel=1e-13)


@pytest.mark.parametrize("system", CHAINS, ids=lambda s: s.name)
def test_linear_momentum_is_the_pull_of_gravity_turned_around(system: System) -> None:
    """With unit gravity against an axis, the potential grows at the rate of the momentum along that axis."""
    q, qd = random_state(Denoc(system), 4)
    for axis in np.eye(3):
        model = Denoc(replace(system, gravity=-axis))
        assert qd @ model.gravity(q) == pytest.approx(axis @ model.momentum(q, qd)[3:], rel=1e-10, abs=1e-13)


def test_frozen_beam_is_the_rigid_link() -> None:
    """Joint rows of the flexible equations at b = 0 are those of the link that System.rigid() makes."""
    flexible = pendulum(strip(modes=2, payload=0.02, payload_inertia=np.diag([1e-5, 2e-5, 3e-5])))
    soft, stiff = Denoc(flexible), Denoc(flexible.rigid())
    for theta in (0.0, 0.8, -2.0):
        full = soft.mass_matrix([theta, 0.0, 0.0])
        assert full[0, 0] == pytest.approx(stiff.mass_matrix([theta])[0, 0], rel=1e-13)
        assert soft.gravity([theta, 0.0, 0.0])[0] == pytest.approx(stiff.gravity([theta])[0], rel=1e-12, abs=1e-15)


def test_cantilever_sags_as_euler_bernoulli_says() -> None:
    """Uniform load w: tip w l⁴ / 8 EI, root curvature w l² / 2 EI (Timoshenko); ten modes leave 1e-6 and 1 % of them."""
    weight = 0.01
    # A beam along x that sags along z: positive deflection downwards.
    beam = strip(
        direction=np.array([1.0, 0.0, 0.0]), bending=np.array([0.0, 0.0, -1.0]), modes=10, geometric_stiffening=False
    )
    model = Denoc(pendulum(beam, JointType.FIXED, gravity=weight))
    stiffness, _ = model.linear_passive()
    b = np.linalg.solve(stiffness, -model.gravity(np.zeros(model.n)))
    motion = model.simulate(b, np.zeros(model.n), [0.0])
    load = LINE * weight
    assert motion.channels["rod.tip_deflection"][0] == pytest.approx(load * LENGTH**4 / (8 * STIFFNESS), rel=1e-5)
    strain = THICKNESS / 2 * load * LENGTH**2 / (2 * STIFFNESS)
    assert motion.channels["rod.root_strain"][0] == pytest.approx(strain, rel=0.05)
    # At rest an accelerometer along the bending direction (down) reads -g, here turned by the tip's slope of 1e-5.
    assert motion.channels["rod.tip_acceleration"][0] == pytest.approx(-weight, rel=1e-6)


def test_tip_accelerometer_reads_the_motion_of_the_tip() -> None:
    """Second difference of the place of a massless mark at the tip, less gravity, along the tip's own bending axis."""
    mark = Joint("mark", JointType.FIXED, "rod", "tip", xyz=np.array([0.0, 0.0, -LENGTH]))
    bent = with_twist(pendulum(strip(modes=3, bending2=True, bending_stiffness2=2 * STIFFNESS), axis=(0.6, 0.0, 0.8)))
    system = replace(bent, joints=(*bent.joints, mark), links=(*bent.links, Link("tip")))
    model = Denoc(system)
    rng = np.random.default_rng(5)
    start = np.concatenate([[0.4], 0.002 * rng.normal(size=model.n - 1)])
    h = 1e-5
    time = 0.05 + h * np.arange(-3, 4)
    motion = model.simulate(start, np.zeros(model.n), np.concatenate([[0.0], time]), rtol=1e-12, atol=1e-15)
    places = np.array([model.link_pose(q, "tip")[1] for q in motion.position[1:]])
    weights = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0
    acceleration = weights @ places / h**2
    turn, _ = model.link_pose(motion.position[4], "tip")
    expected = turn[:, 0] @ (acceleration - system.gravity)
    assert motion.channels["rod.tip_acceleration"][4] == pytest.approx(expected, rel=1e-5)


def test_what_hangs_on_a_beam_sits_on_its_bent_section() -> None:
    """Static check by geometry: place and slope of the tip from the shape functions at small deflection."""
    mark = Joint("mark", JointType.FIXED, "rod", "tip", xyz=np.array([0.0, 0.01, -LENGTH]))
    base = pendulum(strip(modes=2), JointType.FIXED)
    model = Denoc(replace(base, joints=(*base.joints, mark), links=(*base.links, Link("tip"))))
    data = model.beams[1]
    b = np.array([1e-4, -5e-5]) / np.abs(data.tip.s)
    turn, place = model.link_pose(b, "tip")
    deflection, slope = data.tip.s @ b, data.tip.slope @ b
    short = 0.5 * np.einsum("p,p->", data.weights, (data.slope @ b) ** 2)
    assert place == pytest.approx([deflection, 0.01, -LENGTH + short], abs=1e-12)
    # The beam points down and bends to +x: the section turns by -slope about y.
    expected = np.array([[np.cos(slope), 0, -np.sin(slope)], [0, 1, 0], [np.sin(slope), 0, np.cos(slope)]])
    assert np.abs(turn - expected).max() < 1e-12


def test_modal_and_material_damping_take_energy_as_they_should() -> None:
    """A cantilever's first mode: ratio ζ from the decay of its amplitude; Kelvin-Voigt gives ζ = damping ω / 2."""
    for changes, ratio in (({"modal_damping": (0.02,)}, 0.02), ({"material_damping": 1e-3}, None)):
        model = Denoc(pendulum(strip(modes=1, **changes), JointType.FIXED, gravity=0.0))
        omega = 2 * np.pi * model.frequencies()[0]
        expected = ratio if ratio is not None else 1e-3 * omega / 2
        period = 2 * np.pi / (omega * np.sqrt(1 - expected**2))
        motion = model.simulate([1e-6], [0.0], [0.0, 5 * period])
        decrement = np.log(1e-6 / motion.position[1, 0]) / 5
        assert decrement / np.sqrt(4 * np.pi**2 + decrement**2) == pytest.approx(expected, rel=1e-5)
