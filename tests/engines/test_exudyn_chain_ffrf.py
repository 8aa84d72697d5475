"""Chains of meshed bars in floating frames and rigid links: against rigid engines, closed forms, ANCF and the native modes."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("exudyn")

from harness.cases.beams import LENGTH, STEEL, THICKNESS, WIDTH, closed_form, strip
from harness.cases.pendulums import GRAVITY, bar, hinge
from harness.engines import registry
from harness.engines.exudyn_ancf import Ancf
from harness.engines.exudyn_ffrf import Ffrf, FfrfModel
from harness.engines.exudyn_joint import held_torques
from harness.engines.exudyn_run import exudyn_package, quiet, settings, solve_dynamic
from harness.engines.planar import planar_chain
from harness.system import Joint, JointType, System
from harness.system.description import constant

MASS = STEEL * LENGTH * WIDTH * THICKNESS


def chain(kinds, *, thickness=THICKNESS, gravity=GRAVITY, modes=3, shapes="auto", stiffening=False, **joint):
    """Bars (R) and strips (F) hinged end to end, hanging; joint: facts of every hinge."""
    links, joints = [], []
    for k, kind in enumerate(kinds):
        name, parent = f"link{k + 1}", f"link{k}" if k else "base"
        made = strip(name, thickness=thickness, modes=modes, stiffening=stiffening)
        links.append(
            bar(name, LENGTH, STEEL * LENGTH * WIDTH * thickness)
            if kind == "R"
            else replace(made, beam=replace(made.beam, shapes=shapes))
        )
        joints.append(hinge(f"joint{k + 1}", parent, name, drop=LENGTH if k else 0.0, **joint))
    return System(kinds, tuple(joints), tuple(links), gravity=constant([0.0, 0.0, -gravity]))


def frames_of(system):
    """The adapter's model of a system without elastic links, which the engine leaves to engines for them."""
    return FfrfModel(system.coordinate_names, system, planar_chain(system))


def state(system, **joints):
    q = np.zeros(len(system.coordinate_names))
    for name, value in joints.items():
        q[system.coordinate_names.index(name)] = value
    return q


def torques(system, time, *amplitudes):
    tau = np.zeros((len(time), len(system.coordinate_names)))
    for name, amplitude in zip(system.joint_names, amplitudes, strict=True):
        tau[:, system.coordinate_names.index(name)] = amplitude * np.sin(15.0 * time)
    return tau


def test_two_rigid_links_move_as_in_pinocchio_second_order_in_the_step():
    pytest.importorskip("pinocchio")
    system = chain("RR", armature=3e-5, damping=2e-3)
    time = np.linspace(0.0, 0.2, 21)
    q, qd = np.array([-1.0, -0.5]), np.array([1.0, -2.0])
    tau = torques(system, time, 0.05, -0.02)
    truth = registry.engine("pinocchio").build(system).simulate(q, qd, time, tau=tau, step=1e-4)
    off = []
    for step in (1e-3, 5e-4):
        run = frames_of(system).simulate(q, qd, time, tau=tau, step=step)
        off.append(np.abs(run.position - truth.position).max())
        assert np.abs(run.channels["joint2.position"] - truth.position[:, 1]).max() <= off[-1]
    # Torques held from sample to sample jump at ends of steps: taken at one side of the jump the error is of first order.
    assert off[0] < 2e-5
    assert off[1] < 0.3 * off[0]


def test_a_torque_at_a_sample_is_the_mean_of_both_sides_and_held_between():
    system = chain("RR")
    torque = held_torques(
        planar_chain(system), np.array([0.0, 0.1, 0.2]), np.array([[1.0, 0.0], [3.0, 0.0], [5.0, 0.0]])
    )
    assert list(torque) == [0]
    assert [torque[0](t) for t in (0.0, 0.05, 0.1, 0.1 + 1e-12, 0.15, 0.2)] == [1.0, 1.0, 2.0, 2.0, 3.0, 4.0]


def test_thick_bars_move_as_rigid_ones():
    """Two steel bars of 20 mm bend by less than 1e-4 rad under these torques: τ l / EI, and their weight's."""
    thickness = 0.02
    system, rigid = chain("FF", thickness=thickness, modes=1), chain("RR", thickness=thickness)
    # What a slender bar lacks: m h²/12 of its depth, about its own centre.
    depth = np.diag([0.0, 1.0, 0.0]) * rigid.links[0].mass * thickness**2 / 12.0
    for link in rigid.links:
        rigid = rigid.replace_link(replace(link, inertia=link.inertia + depth))
    time = np.linspace(0.0, 0.1, 21)
    tau = torques(rigid, time, 2.0, 1.0)
    truth = registry.engine("denoc").build(rigid).simulate(np.array([-1.0, -0.5]), np.array([2.0, 5.0]), time, tau=tau)
    tau = torques(system, time, 2.0, 1.0)
    q, qd = state(system, joint1=-1.0, joint2=-0.5), state(system, joint1=2.0, joint2=5.0)
    run = Ffrf(elements=12, modes=2).build(system).simulate(q, qd, time, tau=tau, step=1e-4)
    for name in rigid.joint_names:
        ours = run.position[:, system.coordinate_names.index(name)]
        assert np.ptp(ours) > 0.15
        np.testing.assert_allclose(ours, truth.position[:, rigid.coordinate_names.index(name)], atol=3e-4)


@pytest.mark.parametrize("kinds", ["FF", "FR", "RFR"])
def test_frequencies_of_bent_arms_are_those_of_ancf_elements(kinds):
    """Without gravity and at rest nothing stiffens: two formulations of the same bars."""
    system = chain(kinds, gravity=0.0)
    q = state(system, joint2=np.radians(50.0))
    peers = Ffrf().build(system), Ancf().build(chain(kinds, gravity=0.0, stiffening=True))
    ours, theirs = ([f for f in peer.frequencies(q) if f > 1.0][:3] for peer in peers)
    # Bricks: 5e-6 to 1e-4 in these modes, which 192 of them halve.
    np.testing.assert_allclose(ours, theirs, rtol=2e-4)


def test_frequencies_do_not_depend_on_where_the_search_for_modes_began():
    """Its first vector is drawn at random; an unsymmetric reduced stiffness made of that 2e-4 in the first frequency."""
    system = chain("FR", gravity=0.0)
    q = state(system, joint2=np.radians(50.0))
    found = [[f for f in Ffrf().build(system).frequencies(q) if f > 1.0][:3] for _ in range(4)]
    np.testing.assert_allclose(found, np.broadcast_to(found[0], (4, 3)), rtol=2e-7)


def test_a_square_bar_has_all_its_frequencies():
    """Both planes' modes are alike and would mix: f = (β l)² √(EI/ρ) / 2π l², β l of a bar pinned and free."""
    link = strip("link1", thickness=THICKNESS, stiffening=False)
    link = replace(link, beam=replace(link.beam, width=THICKNESS))
    system = replace(chain("F", gravity=0.0), links=(link,))
    model = Ffrf(modes=8).build(system)
    found = [f for f in model.frequencies(np.zeros(len(system.coordinate_names))) if f > 1.0][:3]
    exact = [closed_form(beta, link) for beta in (3.926602, 7.068583, 10.210176)]
    np.testing.assert_allclose(found, exact, rtol=5e-4)


def test_a_bar_that_hangs_from_a_cantilever_bends_it_by_its_weight():
    """W l³ / 3EI of the hung bar and ρ g l⁴ / 8EI of its own, about which the tip swings."""
    link = strip("link1", thickness=0.003, stiffening=False)
    link = replace(
        link, beam=replace(link.beam, direction=constant([1.0, 0.0, 0.0]), bending=constant([0.0, 0.0, 1.0]))
    )
    hung = bar("link2", LENGTH, MASS)
    clamp = Joint("clamp", JointType.FIXED, "base", "link1")
    pivot = replace(hinge("pivot", "link1", "link2"), xyz=constant([LENGTH, 0.0, 0.0]))
    system = System("hung", (clamp, pivot), (link, hung), gravity=constant([0.0, 0.0, -GRAVITY]))
    beam = link.beam
    static = -GRAVITY * LENGTH**3 / beam.bending_stiffness * (hung.mass / 3.0 + beam.mass / 8.0)
    time = np.linspace(0.0, 0.4, 801)
    q = np.zeros(len(system.coordinate_names))
    run = Ffrf(elements=24, modes=2).build(system).simulate(q, np.zeros_like(q), time, step=2e-4)
    assert np.mean(run.channels["link1.tip_deflection"]) == pytest.approx(static, rel=0.02)
    assert np.abs(run.position[:, system.coordinate_names.index("pivot")]).max() < 0.05


@pytest.mark.parametrize(
    ("kinds", "driven", "shapes"), [("RF", True, "clamped_free"), ("FR", False, "auto"), ("FF", True, "clamped_free")]
)
def test_native_modes_without_stiffening_converge_to_it(kinds, driven, shapes):
    """The DeNOC's assumed modes, derived otherwise, of the same arms with dampers and rotors, driven at both joints."""
    facts = {"armature": 2e-5, "damping": 1e-3, "shapes": shapes}
    time = np.linspace(0.0, 0.05, 101)
    system = chain(kinds, **facts)
    joints = {"joint1": -1.0, "joint2": -0.5}
    tau = torques(system, time, 0.05, -0.02) if driven else None
    truth = Ffrf().build(system).simulate(state(system, **joints), 0.0 * state(system), time, tau=tau, step=1e-4)
    errors = []
    for modes in (1, 3, 5):
        own = chain(kinds, modes=modes, **facts)
        tau = torques(own, time, 0.05, -0.02) if driven else None
        run = registry.engine("denoc").build(own).simulate(state(own, **joints), 0.0 * state(own), time, tau=tau)
        label = "link1.tip_deflection" if kinds[0] == "F" else "link2.tip_deflection"
        signal = truth.channels[label]
        errors.append(np.sqrt(np.mean((run.channels[label] - signal) ** 2)) / np.abs(signal).max())
        for name in own.joint_names if modes == 5 else ():
            ours = run.position[:, own.coordinate_names.index(name)]
            np.testing.assert_allclose(ours, truth.position[:, system.coordinate_names.index(name)], atol=1e-3)
    assert errors[0] > 3.0 * errors[1] > 3.0 * errors[2]
    # A link at the tip loads it with a shear that clamped-free shapes have not: they converge slowly there.
    assert errors[2] < (0.01 if shapes == "clamped_free" and kinds == "FF" else 0.005)


def test_energy_and_momentum_are_kept_in_exudyns_own_matrices():
    """Let go, kinetic, elastic and weight's energy stay; driven between its links without weight, so does the momentum."""
    exudyn = exudyn_package()
    time = np.linspace(0.0, 0.05, 51)
    for gravity, torque in ((GRAVITY, 0.0), (0.0, 0.03)):
        system = chain("FF", gravity=gravity)
        model = Ffrf(elements=16, modes=3).build(system)
        q, qd = state(system, joint1=-1.0, joint2=-0.5), state(system, joint1=3.0, joint2=-6.0)
        forces = torques(system, time, 0.0, torque)
        with quiet(exudyn):
            built = model._build(exudyn, q, qd, held_torques(model.chain, time, forces))
            before = _kept(exudyn, built, model)
            made = settings(exudyn, float(time[-1]), 500, 1e-3, relative=1e-8, absolute=1e-10)
            solve_dynamic(exudyn, built.mbs, made)
            data = built.mbs.systemData
            data.SetODE2Coordinates(data.GetODE2Coordinates(), configuration=exudyn.ConfigurationType.Initial)
            data.SetODE2Coordinates_t(data.GetODE2Coordinates_t(), configuration=exudyn.ConfigurationType.Initial)
            after = _kept(exudyn, built, model)
        if torque:
            assert after[1] == pytest.approx(before[1], rel=1e-5)
            assert abs(after[0] - before[0]) > 0.01 * before[0]
        else:
            assert after[0] == pytest.approx(before[0], rel=1e-4)
            assert abs(after[2] - before[2]) > 0.05 * before[0]


def _kept(exudyn, built, model):
    """Energy [J], angular momentum about the base's hinge [kg·m²/s] and potential energy of weight [J] at the initial state."""
    data, initial = built.mbs.systemData, exudyn.ConfigurationType.Initial
    mass, *_ = built.mbs.ComputeLinearizedSystem()
    q = np.asarray(data.GetODE2Coordinates(initial)) + np.asarray(
        data.GetODE2Coordinates(exudyn.ConfigurationType.Reference)
    )
    rates = np.asarray(data.GetODE2Coordinates_t(initial))
    turning, weight, elastic, place = np.zeros_like(q), 0.0, 0.0, 0
    for reduced in model.bars:
        modal = slice(place + 7, place + 7 + reduced.basis.shape[1])
        e, z = q[place + 3 : place + 7], q[modal]
        # A turn of everything about z: velocity z × r, Euler parameters ½ Eᵀ z, no bending.
        turning[place : place + 2] = -q[place + 1], q[place]
        turning[place + 3 : place + 7] = 0.5 * np.array([-e[3], -e[2], e[1], e[0]])
        nodes = reduced.mesh.nodes + (reduced.basis @ z).reshape(-1, 3)
        share = np.asarray(reduced.mesh.mass.sum(axis=1)).reshape(-1, 3)[:, 0]
        angle = 2.0 * np.arctan2(e[3], e[0])
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        weight -= model.chain.gravity @ (share.sum() * q[place : place + 2] + turn @ (share @ nodes[:, :2]))
        elastic += 0.5 * z @ (reduced.basis.T @ (reduced.mesh.stiffness @ (reduced.basis @ z)))
        place = modal.stop
    return 0.5 * rates @ mass @ rates + elastic + weight, turning @ mass @ rates, weight


@pytest.mark.parametrize(
    ("system", "word"),
    [
        (chain("RF", stiffening=True), "link2' is meant to"),
        (
            replace(chain("FR"), joints=tuple(replace(joint, stiffness=0.1) for joint in chain("FR").joints)),
            "spring at joint 'joint1'",
        ),
        (
            replace(
                chain("FR"), joints=(hinge("joint1", "base", "link1"), hinge("joint2", "link1", "link2", drop=0.2))
            ),
            "does not sit at the tip",
        ),
    ],
)
def test_what_a_chain_cannot_express_is_refused_in_one_line(system, word):
    assert word in Ffrf().refuses(system)
