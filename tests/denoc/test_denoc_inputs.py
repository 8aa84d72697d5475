"""What cannot be computed is refused in one line that names it."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from harness.denoc import Denoc
from harness.errors import InputError
from harness.system import Joint, JointType, Link, System, random_chain

MODEL = Denoc(random_chain(3, 1, prismatic=0.0))
FLEXIBLE = Denoc(random_chain(2, 1, flexible=1.0, modes=1))
GOOD = np.array([0.1, -0.2, 0.3])


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (np.zeros(2), r"q has shape \(2,\)"),
        (np.zeros((3, 1)), r"q has shape \(3, 1\)"),
        (0.0, r"q has shape \(\)|q has shape \(1,\)"),
        ("abc", "q is not a vector of numbers"),
        (None, "q "),
        ([0.0, np.nan, 0.0], r"q\[1\] \(joint2\) is nan"),
        (np.array([0.0, 0.0, np.inf]), r"q\[2\] \(joint3\) is inf"),
    ],
)
def test_bad_states_are_refused(bad: object, message: str) -> None:
    for call in (
        lambda: MODEL.forward_dynamics(bad, GOOD, GOOD),
        lambda: MODEL.inverse_dynamics(bad, GOOD, GOOD),
        lambda: MODEL.mass_matrix(bad),
        lambda: MODEL.energy(bad, GOOD),
    ):
        with pytest.raises(InputError, match=message) as caught:
            call()
        assert "\n" not in str(caught.value)


def test_nan_in_velocity_or_force_is_refused_too() -> None:
    bad = np.array([0.0, np.nan, 0.0])
    with pytest.raises(InputError, match=r"qd\[1\]"):
        MODEL.forward_dynamics(GOOD, bad, GOOD)
    with pytest.raises(InputError, match=r"tau\[1\]"):
        MODEL.forward_dynamics(GOOD, GOOD, bad)
    with pytest.raises(InputError, match=r"qdd\[1\]"):
        MODEL.inverse_dynamics(GOOD, GOOD, bad)


@pytest.mark.parametrize(
    "vector",
    [
        list(GOOD),
        tuple(GOOD),
        GOOD.astype(np.float32).astype(np.float64)[::1],
        np.repeat(GOOD, 2)[::2],
        np.asfortranarray(np.tile(GOOD, (2, 1)))[1],
    ],
    ids=["list", "tuple", "plain", "strided", "column"],
)
def test_anything_that_holds_the_numbers_gives_the_same(vector: object) -> None:
    plain = np.array(vector, dtype=np.float64)
    expected = MODEL.forward_dynamics(plain, plain, plain)
    assert np.array_equal(MODEL.forward_dynamics(vector, vector, vector), expected)
    assert np.array_equal(MODEL.mass_matrix(vector), MODEL.mass_matrix(plain))
    # The short way of one state and the loop over many are the same kernel.
    assert np.allclose(MODEL.mass_matrix(plain), MODEL.mass_matrix_batch(plain[None])[0], rtol=1e-13, atol=1e-13)


def test_integers_are_numbers() -> None:
    whole = np.array([1, 0, -1])
    assert np.array_equal(
        MODEL.forward_dynamics(whole, whole, whole), MODEL.forward_dynamics(*[whole.astype(float)] * 3)
    )


def test_results_are_the_callers_own() -> None:
    first = MODEL.forward_dynamics(GOOD, GOOD, GOOD)
    kept = first.copy()
    MODEL.forward_dynamics(-GOOD, GOOD, GOOD)
    assert np.array_equal(first, kept)


def test_flexible_models_refuse_the_same() -> None:
    n = FLEXIBLE.n
    with pytest.raises(InputError, match="q has shape"):
        FLEXIBLE.forward_dynamics(np.zeros(n + 1), np.zeros(n), np.zeros(n))
    with pytest.raises(InputError, match=r"q\[1\] \(link1.mode1\) is nan"):
        FLEXIBLE.forward_dynamics(np.array([0.0, np.nan, *np.zeros(n - 2)]), np.zeros(n), np.zeros(n))


def test_batches_of_the_wrong_shape_are_refused() -> None:
    with pytest.raises(InputError, match=r"Q has shape \(4, 2\)"):
        MODEL.forward_dynamics_batch(np.zeros((4, 2)), np.zeros((4, 3)), np.zeros((4, 3)))
    with pytest.raises(InputError, match="numbers of states differ"):
        MODEL.forward_dynamics_batch(np.zeros((4, 3)), np.zeros((5, 3)), np.zeros((4, 3)))
    with pytest.raises(InputError, match=r"Qdd\[1, 2\] is nan"):
        bad = np.zeros((4, 3))
        bad[1, 2] = np.nan
        MODEL.inverse_dynamics_batch(np.zeros((4, 3)), np.zeros((4, 3)), bad)


def test_wrenches_of_the_wrong_shape_are_refused() -> None:
    with pytest.raises(InputError, match="wrenches of shape"):
        MODEL.forward_dynamics(GOOD, GOOD, GOOD, wrenches=np.zeros((3, 3)))


def test_a_joint_without_inertia_is_named() -> None:
    joints = (Joint("hinge", JointType.REVOLUTE, "base", "ghost", axis=np.array([0.0, 1.0, 0.0])),)
    model = Denoc(System("ghost", joints, (Link("ghost"),)))
    with pytest.raises(InputError, match="joint 'hinge' moves no inertia"):
        model.forward_dynamics(np.zeros(1), np.zeros(1), np.ones(1))


def test_nothing_movable_and_unusable_numbers_are_refused() -> None:
    welded = (Joint("weld", JointType.FIXED, "base", "block"),)
    with pytest.raises(InputError, match="no movable joint"):
        Denoc(System("welded", welded, (Link("block", 1.0),)))
    chain = random_chain(2, 1)
    first = chain.joints[0]
    for change, message in (
        ({"axis": np.zeros(3)}, "joint 'joint1': axis has no length"),
        ({"damping": np.nan}, "joint 'joint1': damping is not finite"),
        ({"xyz": np.array([0.0, np.inf, 0.0])}, "joint 'joint1': origin is not finite"),
    ):
        with pytest.raises(InputError, match=message):
            Denoc(chain.replace_joint(replace(first, **change)))
    with pytest.raises(InputError, match="link 'link1': mass is not finite"):
        Denoc(chain.replace_link(replace(chain.links[0], mass=np.nan)))


def test_models_travel_to_other_processes() -> None:
    again = pickle.loads(pickle.dumps(MODEL))
    assert np.array_equal(again.forward_dynamics(GOOD, GOOD, GOOD), MODEL.forward_dynamics(GOOD, GOOD, GOOD))


def test_unknown_link_is_named() -> None:
    with pytest.raises(InputError, match="no link 'elbow'"):
        MODEL.link_pose(GOOD, "elbow")


def test_a_path_in_the_place_of_a_system_is_told():
    with pytest.raises(InputError, match=r"Denoc is of a System, not of a str \(read a file by harness.load\(path\)\)"):
        Denoc("robot.urdf")
