"""Lanes of mechanisms with loops and of balls against closed forms and textbook equations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness.cases.four_bar import crank_rocker
from harness.compare.four_bars import hinge, pin, rod
from harness.denoc import Denoc
from harness.denoc.lanes.closing import GIVES
from harness.denoc.lanes.model import LaneModel
from harness.system import Coupling, Frame, Joint, JointType, Link, Loop, System
from harness.system.charted import Chart, charted
from harness.system.description import constant

LENGTH, COUPLER, MASS, G = 0.3, 0.5, 0.4, 9.81


def parallelogram(**joints: dict[str, float]) -> System:
    """Two equal cranks that hang down, and a coupler between them that never turns: a pendulum of one angle.

    joints: further fields by joint.
    """
    hinges = (
        hinge("left", "base", "first"),
        hinge("pin", "first", "coupler", (0.0, -LENGTH, 0.0)),
        hinge("right", "base", "second", (COUPLER, 0.0, 0.0)),
    )
    made = tuple(replace(joint, **joints.get(joint.name, {})) for joint in hinges)
    links = (
        rod("first", MASS, (0.0, -LENGTH, 0.0)),
        rod("coupler", MASS, (COUPLER, 0.0, 0.0)),
        rod("second", MASS, (0.0, -LENGTH, 0.0)),
    )
    loops = (pin("knee", ("coupler", (COUPLER, 0.0)), ("second", (0.0, -LENGTH))),)
    return System("parallelogram", made, links, gravity=constant([0.0, -G, 0.0]), loops=loops)


# Of the pendulum: two rods about their ends, and the coupler as a point at their lower ends; all three weights.
INERTIA = 2.0 * MASS * LENGTH**2 / 3.0 + MASS * LENGTH**2
MOMENT = 2.0 * MASS * G * LENGTH / 2.0 + MASS * G * LENGTH


def pendulum(time: np.ndarray, angle: float, viscous: float = 0.0, dry: float = 0.0) -> np.ndarray:
    """Angles (T,) of the textbook pendulum from rest; dry friction turns round where the motion does, and holds it in the end."""
    out, state, begun = np.empty(len(time)), np.array([angle, 0.0]), time[0]
    done = 0
    while done < len(time):
        way = -np.sign(MOMENT * np.sin(state[0]))
        if abs(MOMENT * np.sin(state[0])) <= dry:
            out[done:] = state[0]
            break

        def rates(t: float, y: np.ndarray, way: float = way) -> list[float]:
            return [y[1], (-MOMENT * np.sin(y[0]) - viscous * y[1] - dry * way) / INERTIA]

        def stops(t: float, y: np.ndarray, way: float = way, begun: float = begun) -> float:
            return way * y[1] if t > begun + 1e-3 else 1.0

        stops.terminal = True  # type: ignore[attr-defined]
        run = solve_ivp(
            rates, (begun, time[-1] + 1e-9), state, "DOP853", events=stops, rtol=1e-11, atol=1e-12, dense_output=True
        )
        count = int(np.searchsorted(time, run.t[-1] + 1e-12))
        out[done:count] = run.sol(time[done:count])[0]
        done, begun, state = max(count, done), run.t[-1], np.array([run.y[0, -1], 0.0])
        if not len(run.t_events[0]):
            break
    return out


def moved(system: System, angle: float, time: np.ndarray, leading: str = "left", **slots: float) -> np.ndarray:
    """Positions (T, n) of a mechanism let go with one joint at an angle; slots: of a row, as ``joint__slot``."""
    model = LaneModel(replace(system, leading=(leading,)))
    row = model.row()
    for name, value in slots.items():
        site, slot = name.split("__")
        row[model.slot(site, slot)] = value
    start = np.zeros(model.n)
    start[model.names.index(leading)] = angle
    return np.asarray(model.simulate(row, start, np.zeros(model.n), time)[0][0])


def test_a_parallelogram_is_a_pendulum() -> None:
    time = np.linspace(0.0, 6.0, 301)
    found = moved(parallelogram(), 1.2, time)
    truth = pendulum(time, 1.2)
    np.testing.assert_allclose(found, np.stack([truth, -truth, truth], axis=1), atol=2e-9)


def test_damping_of_every_joint_counts_by_how_far_it_turns() -> None:
    time = np.linspace(0.0, 6.0, 301)
    found = moved(parallelogram(), 1.0, time, left__damping=0.01, pin__damping=0.03, right__damping=0.005)
    np.testing.assert_allclose(found[:, 0], pendulum(time, 1.0, viscous=0.045), atol=2e-9)


@pytest.mark.parametrize("leading", ["left", "right", "pin"])
def test_dry_friction_of_several_joints_holds_the_mechanism_together(leading: str) -> None:
    time = np.linspace(0.0, 8.0, 401)
    sign = -1.0 if leading == "pin" else 1.0
    found = moved(
        parallelogram(),
        sign,
        time,
        leading,
        left__coulomb_torque=0.05,
        pin__coulomb_torque=0.1,
        right__coulomb_torque=0.03,
    )
    truth = pendulum(time, 1.0, dry=0.18)
    assert np.ptp(truth[-50:]) == 0.0  # it has come to rest where friction alone could hold it
    np.testing.assert_allclose(found[:, 0], truth, atol=1e-8)


def beside_itself(system: System) -> System:
    """The mechanism and the same once more, two degrees of freedom together."""

    def again(one: System) -> System:
        links = {link.name: f"other_{link.name}" for link in one.links} | {one.base: one.base}
        joints = tuple(
            replace(joint, name=f"other_{joint.name}", parent=links[joint.parent], child=links[joint.child])
            for joint in one.joints
        )
        loops = tuple(
            replace(
                loop,
                name=f"other_{loop.name}",
                first=replace(loop.first, link=links[loop.first.link]),
                second=replace(loop.second, link=links[loop.second.link]),
            )
            for loop in one.loops
        )
        return replace(one, joints=joints, links=tuple(replace(l, name=links[l.name]) for l in one.links), loops=loops)

    other = again(system)
    return replace(
        system,
        joints=system.joints + other.joints,
        links=system.links + other.links,
        loops=system.loops + other.loops,
    )


def test_joints_of_two_degrees_of_freedom_come_to_rest_each_in_its_time() -> None:
    """Three joints rub in each of two pendulums, which are one mechanism to the computer and know nothing of each other."""
    time = np.linspace(0.0, 8.0, 401)
    torques = {"left": 0.05, "pin": 0.1, "right": 0.03, "other_left": 0.02, "other_pin": 0.03, "other_right": 0.04}
    model = LaneModel(replace(beside_itself(parallelogram()), leading=("left", "other_left")))
    row = model.row()
    for joint, torque in torques.items():
        row[model.slot(joint, "coulomb_torque")] = torque
    start = np.zeros(model.n)
    places = [model.names.index(name) for name in ("left", "other_left")]
    start[places] = 1.0, 0.7
    # Beside lanes that go on swinging.
    rows = np.stack([row, model.row(), row])
    found = model.simulate(rows, start, np.zeros(model.n), time)
    first, second = pendulum(time, 1.0, dry=0.18), pendulum(time, 0.7, dry=0.09)
    assert np.ptp(first[-50:]) == np.ptp(second[-50:]) == 0.0
    for lane in (0, 2):
        np.testing.assert_allclose(found[0][lane][:, places], np.stack([first, second], axis=1), atol=1e-8)
    np.testing.assert_array_equal(found[1][0][-50:], 0.0)
    free = np.stack([pendulum(time, 1.0), pendulum(time, 0.7)], axis=1)
    np.testing.assert_allclose(found[0][1][:, places], free, atol=5e-9)


def test_friction_holds_from_the_beginning_what_it_can_hold() -> None:
    time = np.linspace(0.0, 1.0, 11)
    angle = 0.9 * np.arcsin(0.3 / MOMENT)
    found = moved(parallelogram(), angle, time, left__coulomb_torque=0.1, pin__coulomb_torque=0.2)
    np.testing.assert_array_equal(found[:, 0], angle)


def test_a_crank_that_goes_round_agrees_with_the_single_model() -> None:
    system, time = crank_rocker(), np.linspace(0.0, 3.0, 151)
    single = Denoc(system)
    q = single.assemble(np.array([0.3, *single.assemble()[1:]]), held=["crank"])
    qd = single.closed_velocity(q, np.array([5.0, 0.0, 0.0]))
    truth = single.simulate(q, qd, time)
    model = LaneModel(system)
    # Coordinates that follow are not asked for: they are what closes the loop.
    found = model.simulate(model.row(), [q[0], 9.0, -9.0], [qd[0], 0.0, 0.0], time)
    np.testing.assert_allclose(found[0][0], truth.position, atol=1e-7)
    assert max(np.abs(single.open_by(position)).max() for position in found[0][0]) < 1e-9


def test_a_state_that_cannot_be_closed_is_told_by_nan() -> None:
    system = parallelogram()
    # With a coupler much too long no angle closes.
    far = replace(system.loops[0], first=Frame("coupler", constant([5.0, 0.0, 0.0]), constant(np.eye(3))))
    model = LaneModel(system)
    row = model.row(replace(system, loops=(far,)))
    found = model.simulate(row, np.zeros(3), np.zeros(3), np.linspace(0.0, 1.0, 5))[0][0]
    assert np.isnan(found[:, 1:]).all() and np.isnan(found[1:]).all()


def test_a_gap_is_fallen_through_and_then_rested_on() -> None:
    gap, mass = 0.02, 2.0
    frames = [Frame(link, constant(np.zeros(3)), constant(np.eye(3))) for link in ("base", "weight")]
    joints = tuple(
        Joint(name, JointType.PRISMATIC, parent, child, axis=constant(axis))
        for name, parent, child, axis in (
            ("across", "base", "cart", [1.0, 0, 0]),
            ("down", "cart", "weight", [0, 0, 1.0]),
        )
    )
    links = (Link("cart", 1.0), Link("weight", mass))
    system = System("weight", joints, links, loops=(Loop("pin", frames[0], frames[1], ("x", "z")),))
    model = LaneModel(system)
    row = model.row()
    row[model.slot("pin", "gap")] = gap
    time = np.linspace(0.0, 3.0, 601)
    found = model.simulate(row, np.zeros(2), np.zeros(2), time)[0][0]
    falling = time < 0.99 * np.sqrt(2.0 * gap / G)
    np.testing.assert_allclose(found[falling, 1], -0.5 * G * time[falling] ** 2, atol=1e-10)
    # The contact gives by its stated share of the size, under the weight of all that there is.
    given = GIVES * 1.0 * mass / (mass + 1.0)
    np.testing.assert_allclose(found[-1], [0.0, -gap - given], atol=1e-6)


def test_within_a_clearance_a_gear_beside_it_is_closed_all_the_same() -> None:
    """What of a mechanism is apart stays as given; a motor at twice the crank's angle follows it there too."""
    joints = (*parallelogram().joints, hinge("motor", "base", "rotor", (-1.0, 0.0, 0.0)))
    links = (*parallelogram().links, rod("rotor", MASS, (0.0, -LENGTH, 0.0)))
    gear = Coupling("gear", "motor", "left", (0.0, 2.0, 0.0, 0.0, 0.0))
    system = replace(
        parallelogram(), joints=joints, links=links, loops=(*parallelogram().loops, gear), leading=("left",)
    )
    model = LaneModel(system)
    assert set(model.dependent) == {"pin", "right", "motor"}
    assert model.following({"knee"}) == ("motor",)
    row = model.row()
    row[model.slot("knee", "gap")] = 0.02
    # The rocker a hundredth of a radian ahead of the crank: 3 mm of 20 mm, and both velocities as they please.
    given = np.array([[0.3, -0.3, 0.31, 0.0, 1.0, -1.0, 1.2, 0.0]])
    (found,) = model.closed(row[None], given)
    np.testing.assert_allclose(found, [0.3, -0.3, 0.31, 0.6, 1.0, -1.0, 1.2, 2.0], atol=1e-12)
    (whole,) = model.closed(model.row()[None], given)
    np.testing.assert_allclose(whole, [0.3, -0.3, 0.3, 0.6, 1.0, -1.0, 1.0, 2.0], atol=1e-12)


@pytest.mark.parametrize("law", ["damping", "coulomb_torque", "quadratic_drag"])
def test_what_rubs_where_a_loop_is_cut_acts_against_how_its_frames_turn(law: str) -> None:
    """Without weight a parallelogram's cranks turn alike, its coupler not at all: closed forms of one inertia that slows down."""
    value, speed = 0.02, 1.2
    model = LaneModel(replace(parallelogram(), gravity=constant(np.zeros(3))))
    row = model.row()
    row[model.slot("knee", law)] = value
    time = np.linspace(0.0, 1.0, 51)
    found = model.simulate(row, np.array([0.1, -0.1, 0.1]), speed * np.array([1.0, -1.0, 1.0]), time)[1][0]
    rate = value / INERTIA
    truth = {
        "damping": speed * np.exp(-rate * time),
        "coulomb_torque": speed - rate * time,
        "quadratic_drag": speed / (1.0 + rate * speed * time),
    }[law]
    # Dry friction gives way below a thousandth of a radian a second, which is felt by its square.
    np.testing.assert_allclose(found[:, 0], truth, atol=1e-5 if law == "coulomb_torque" else 1e-9)


def ball(inertia: float = 0.02) -> System:
    """A ball joint with a body that is alike about every axis, without weight."""
    joint = Joint("ball", JointType.BALL, "base", "body")
    system = System(
        "ball", (joint,), (Link("body", 1.0, inertia=constant(inertia * np.eye(3))),), gravity=constant(np.zeros(3))
    )
    still = constant(np.eye(3))
    return charted(system, {"ball": Chart(still, still)})


def speed_of(found: tuple[np.ndarray, ...]) -> np.ndarray:
    """Angular speed (T,) of three turns about x, y and z."""
    (_, b, _), (x, y, z) = found[0][0].T, found[1][0].T
    # ω² of Rx(a) Ry(b) Rz(c): the first and the last axis are apart by a quarter of a turn less b.
    return np.sqrt(x**2 + y**2 + z**2 + 2.0 * x * z * np.sin(b))


@pytest.mark.parametrize("law", ["damping", "coulomb_torque", "quadratic_drag"])
def test_what_acts_on_a_ball_acts_against_its_angular_velocity(law: str) -> None:
    inertia, value = 0.02, 0.01
    model = LaneModel(ball(inertia))
    row = model.row()
    row[model.slot("ball", law)] = value
    time = np.linspace(0.0, 1.5, 76)
    found = model.simulate(row, [0.2, 0.4, -0.3], [1.0, 0.4, -0.8], time)
    speed = speed_of(found)
    rate = value / inertia
    truth = {
        "damping": speed[0] * np.exp(-rate * time),
        "coulomb_torque": speed[0] - rate * time,
        "quadratic_drag": speed[0] / (1.0 + rate * speed[0] * time),
    }[law]
    # Dry friction of a ball gives way below a thousandth of a radian a second, which is felt by its square.
    np.testing.assert_allclose(speed, truth, atol=1e-5 if law == "coulomb_torque" else 1e-9)
