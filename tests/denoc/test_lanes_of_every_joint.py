"""Lanes of screws, mimics, planar, universal, ball and free joints against runs of the single model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.denoc import Denoc
from harness.denoc.lanes.model import LaneModel
from harness.system import JointType, System
from harness.system.charted import chart_for, charted, turning
from harness.system.followers import screws_apart
from harness.system.manifold import quaternions
from harness.system.random_joints import following, in_space, spinning_freely
from harness.system.rotation import from_quaternion

TIME = np.linspace(0.0, 0.5, 26)


def on_the_base() -> System:
    """What follows others, a screw among them, on a universal joint."""
    system = following()
    first = replace(system.joints[0], type=JointType.UNIVERSAL)
    return replace(system, joints=(first, *system.joints[1:]))


def test_screws_and_mimics_are_couplings_in_lanes() -> None:
    system = on_the_base()
    single, lanes = Denoc(system), LaneModel(system)
    assert single.names == ("ball.angle1", "ball.angle2", "screw", "thumb")
    rng = np.random.default_rng(5)
    q, v = 0.5 * rng.standard_normal((2, single.n))
    truth = single.simulate(q, v, TIME, rtol=1e-12, atol=1e-13)
    start, rate = np.zeros((2, lanes.n))
    places = [lanes.names.index(name) for name in single.names]
    start[places], rate[places] = q, v
    found = lanes.simulate(lanes.row(), start, rate, TIME)[0][0]
    np.testing.assert_allclose(found[:, places], truth.position, atol=1e-8)
    # finger = −0.5 thumb + 0.2, the screw's shift is 0.1 m/rad.
    at = {name: found[:, k] for k, name in enumerate(lanes.names)}
    np.testing.assert_allclose(at["finger"], -0.5 * at["thumb"] + 0.2, atol=1e-10)
    np.testing.assert_allclose(at["screw.slide"], 0.1 * at["screw"], atol=1e-10)


def test_a_free_body_and_its_ball_are_lanes_in_a_chart_that_suits_their_motion() -> None:
    """Copies with other masses move as single models with these masses do."""
    system = spinning_freely(in_space())
    names = {joint: at for joint, at, _ in quaternions(system)}
    assert list(names) == [joint.name for joint in turning(system)] == ["root", "hip"]
    runs, scales = [], (1.0, 1.3)
    for scale in scales:
        heavier = tuple(replace(l, mass=scale * l.mass) if l.name == "c" else l for l in system.links)
        model = Denoc(replace(system, links=heavier))
        v = np.zeros(model.n)
        v[[0, 2, 3, 5, 6, 9]] = 0.4, 2.0, 0.7, 1.1, -0.8, 1.2
        runs.append(model.simulate(model.neutral, v, TIME, rtol=1e-12, atol=1e-13).position)
    charts = {}
    for joint, at in names.items():
        turned = np.array([from_quaternion(q[at : at + 4]) for run in runs for q in run])
        charts[joint] = chart_for(turned)
        assert charts[joint] is not None
    lanes = LaneModel(charted(system, charts))
    rows = np.tile(lanes.row(), (2, 1))
    link = system.link("c")
    rows[1, lanes.slot("c", "mass")] += 0.3 * link.mass
    for axis, value in zip(("x", "y", "z"), 0.3 * link.mass * np.asarray(link.com), strict=True):
        rows[1, lanes.slot("c", f"first_{axis}")] += value
    second = 0.3 * link.mass * (link.com @ link.com * np.eye(3) - np.outer(link.com, link.com))
    for (i, j), ending in zip(
        ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)), ("xx", "yy", "zz", "xy", "xz", "yz"), strict=True
    ):
        rows[1, lanes.slot("c", f"inertia_{ending}")] += second[i, j]

    def coordinates(run: np.ndarray) -> np.ndarray:
        """Positions (T, n) in the lanes' coordinates."""
        known = dict(zip(system.position_names, run.T, strict=True))
        for joint, at in names.items():
            angles = charts[joint].angles(np.array([from_quaternion(q[at : at + 4]) for q in run]))
            known |= {f"{joint}.{name}": angles[:, k] for k, name in enumerate(("rx", "ry", "rz"))}
        return np.stack([known[name] for name in lanes.names], axis=1)

    truth = np.array([coordinates(run) for run in runs])
    # Where all begin, and how fast by the first hundredths of a second: a polynomial through them.
    rates = np.array([_slope(TIME[:9], one[:9]) for one in truth])
    found = lanes.simulate(rows, truth[:, 0], rates, TIME)[0]
    np.testing.assert_allclose(found, truth, atol=2e-6)


def _slope(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Slope at the first time of the polynomial through all values (T, n)."""
    powers = np.vander(time - time[0], increasing=True)
    return np.linalg.solve(powers, values)[1]


def test_a_screw_is_a_turn_and_a_slide_of_the_same_motion() -> None:
    system = on_the_base()
    apart = screws_apart(system)
    assert [joint.name for joint in apart.joints if joint.prismatic] == ["screw.slide", "finger", "tip.slide"]
    assert screws_apart(in_space()).loops == ()
