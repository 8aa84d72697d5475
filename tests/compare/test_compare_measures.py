"""Differences as numbers, the odd one out, first divergence, horizon of predictability."""

from dataclasses import replace

import numpy as np
import pytest

from harness.compare.odd_one_out import vote
from harness.compare.quantities import accelerations, forces, mass_matrices, relative
from harness.compare.trajectories import compare, horizon
from harness.engines import registry
from harness.engines.protocol import EngineModel
from harness.system import Joint, JointType, Link, System, Trajectory
from harness.system.random_systems import random_chain


def rods(count: int) -> System:
    """Point masses of 1 kg on massless rods of 1 m, one below the other."""
    joints, links = [], []
    for k in range(count):
        parent, place = ("base", np.zeros(3)) if k == 0 else (f"rod{k}", np.array([0.0, 0.0, -1.0]))
        axis = np.array([0.0, 1.0, 0.0])
        joints.append(Joint(f"joint{k + 1}", JointType.REVOLUTE, parent, f"rod{k + 1}", xyz=place, axis=axis))
        links.append(Link(f"rod{k + 1}", 1.0, np.array([0.0, 0.0, -1.0])))
    return System(f"rods{count}", tuple(joints), tuple(links))


def model(name: str, system: System) -> EngineModel:
    return registry.engine(name).build(system)


def test_relative_difference_by_hand() -> None:
    a = np.array([[1.0, 2.0], [0.0, 0.0], [1e-9, 0.0]])
    b = np.array([[1.0, 2.1], [0.0, 0.0], [2e-9, 0.0]])
    # 0.1/2.1; exact zeros agree; near zero the scale is 1 % of the largest entry, 0.021.
    assert relative(a, b) == pytest.approx([0.1 / 2.1, 0.0, 1e-9 / 0.021])
    assert relative(a, np.full_like(a, np.nan)).tolist() == [np.inf] * 3
    with pytest.raises(ValueError, match="shapes"):
        relative(a, b[:, :1])


def test_differences_do_not_depend_on_the_unit_of_a_coordinate() -> None:
    rng = np.random.default_rng(0)
    root = rng.normal(size=(4, 3, 3))
    mass = root @ np.swapaxes(root, 1, 2) + np.eye(3)
    a, b = rng.normal(size=(2, 4, 3))
    # The third coordinate in millimetres instead of metres: q scales by 1000, forces and rows of M by 1/1000.
    unit = np.array([1.0, 1.0, 1000.0])
    other = mass / unit[:, None] / unit[None, :]
    assert accelerations(other, a * unit, b * unit) == pytest.approx(accelerations(mass, a, b))
    assert forces(other, a / unit, b / unit) == pytest.approx(forces(mass, a, b))
    assert mass_matrices(other, other * 1.01) == pytest.approx(mass_matrices(mass, mass * 1.01))
    # Forces are measured by the accelerations they cause.
    cause, effect = forces(mass, a, b), accelerations(mass, _solve(mass, a), _solve(mass, b))
    assert cause == pytest.approx(effect)


def _solve(mass: np.ndarray, force: np.ndarray) -> np.ndarray:
    return np.asarray(np.linalg.solve(mass, force[:, :, None])[:, :, 0])


def test_odd_one_out_is_the_engine_with_the_other_mass() -> None:
    system = random_chain(4, 1)
    wrong = system.replace_link(replace(system.links[1], mass=system.links[1].mass * 1.001))
    q, qd, tau = np.random.default_rng(1).normal(size=(3, 5, 4))
    values = {}
    for name in ("pinocchio", "mujoco", "exudyn"):
        built = model(name, wrong if name == "mujoco" else system)
        values[name] = np.array([built.forward_dynamics(*state) for state in zip(q, qd, tau, strict=True)])
    found = vote(values, 1e-10)
    assert found.odd == ("mujoco",)
    assert found.majority == ("pinocchio", "exudyn")
    assert found.sentence.startswith("odd one out: mujoco (pinocchio and exudyn agree")
    assert vote({k: v for k, v in values.items() if k != "mujoco"}, 1e-10).sentence == "all agree"


def test_votes_that_nobody_wins() -> None:
    one, two, three = (np.array([[value]]) for value in (1.0, 1.1, 2.0))
    assert "a third one would tell" in vote({"a": one, "b": two}, 1e-3).sentence
    assert vote({"a": one, "b": two, "c": three}, 1e-3).sentence == "no majority agrees; the closest are a and b"
    tied = vote({"a": one, "b": one, "c": two, "d": two}, 1e-3)
    assert tied.odd == ()
    assert "no majority" in tied.sentence
    # a-b and b-c agree, a-c do not: b cannot be asked to choose.
    chain = {"a": np.array([[1.0]]), "b": np.array([[1.0009]]), "c": np.array([[1.0018]])}
    assert vote(chain, 1e-3).odd == ()
    broken = vote({"a": one, "b": one, "c": np.array([[np.nan]])}, 1e-3)
    assert broken.odd == ("c",)


def test_first_divergence_is_placed() -> None:
    time = np.linspace(0.0, 1.0, 11)
    a = Trajectory(time, ("x", "y"), np.zeros((11, 2)), np.zeros((11, 2)))
    position = np.zeros((11, 2))
    position[7:, 1] = [2e-6, 5e-6, 3e-6, 1e-3]
    b = Trajectory(time, ("y", "x"), position[:, ::-1], np.zeros((11, 2)))
    found = compare(a, b, 4e-6)
    assert found.first is not None
    assert (found.first.time, found.first.coordinate) == (pytest.approx(0.8), "y")
    assert found.largest == 1e-3
    assert not found.agree
    assert compare(a, b, 4e-6, until=0.75).agree
    assert compare(a, b, 4e-6, until=0.75).largest == 2e-6
    position[3, 0] = np.nan
    broken = compare(a, Trajectory(time, ("x", "y"), position, position), 1.0)
    assert broken.first is not None
    assert broken.first.time == pytest.approx(0.3)
    with pytest.raises(ValueError, match="different times"):
        compare(a, replace(b, time=time + 0.1), 1.0)
    with pytest.raises(ValueError, match="no coordinate in common"):
        compare(a, replace(b, names=("u", "v")), 1.0)


def test_planted_mass_error_is_dated_in_a_trajectory() -> None:
    system = rods(2)
    wrong = system.replace_link(replace(system.links[1], mass=1.0 + 1e-4))
    time = np.linspace(0.0, 3.0, 301)
    start = np.array([0.5, 0.3]), np.zeros(2)
    sound, other = (model("pinocchio", s).simulate(*start, time) for s in (system, wrong))
    same = model("mujoco", system).simulate(*start, time)
    assert compare(sound, same, 1e-8).agree
    found = compare(sound, other, 1e-8)
    assert found.first is not None
    # Starting from rest the angles part as ½ Δq'' t²; the date is that of the difference, not of the sampling.
    apart = abs(model("pinocchio", system).forward_dynamics(*start, np.zeros(2)) - _first(wrong, start))
    assert found.first.time == pytest.approx(np.sqrt(2.0 * 1e-8 / np.max(apart)), abs=0.011)


def _first(system: System, start: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    return model("pinocchio", system).forward_dynamics(*start, np.zeros(2))


def test_horizon_of_a_chaotic_double_pendulum() -> None:
    built = model("mujoco", rods(2))
    time = np.linspace(0.0, 20.0, 1001)
    start = np.array([2.5, 1.5]), np.zeros(2)
    measured = horizon(built, *start, time, allowed=1e-4, nudge=1e-10)
    assert measured.chaotic
    assert not measured.complete
    assert "chaotic" in measured.sentence()
    # Another nudge comes to the line at another time, by the factor's logarithm over the growth rate.
    nearer = horizon(built, *start, time, allowed=1e-4, nudge=1e-8)
    assert nearer.until < measured.until
    expected = np.log(100.0) / measured.growth
    assert measured.until - nearer.until == pytest.approx(expected, rel=0.6)
    # Another engine agrees up to the horizon and leaves soon after.
    other = model("pinocchio", rods(2)).simulate(*start, time)
    ours = built.simulate(*start, time, step=2.5e-4)
    assert compare(ours, other, 1e-4, until=measured.until).agree


def test_regular_swing_is_predictable() -> None:
    built = model("analytic", rods(1))
    measured = horizon(built, np.array([1.5]), np.zeros(1), np.linspace(0.0, 50.0, 501), allowed=1e-6)
    assert measured.complete
    assert not measured.chaotic
    # Amplitudes 1e-10 apart drift in phase in proportion to time: a line, not an exponential.
    assert 0.0 <= measured.growth < 0.2
