"""Two identified models held against recordings, and one unit's parameters against another's.

Motions come from the textbook's equation integrated by SciPy and from MuJoCo (``simulated_recordings``); combinations of inertial
parameters from a textbook's formulas and from Pinocchio's regressor.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from harness.diagnose.arbitration.agreement import by_combination, by_number
from harness.diagnose.arbitration.arbitrate import arbitrate, reservations
from harness.diagnose.arbitration.base_parameters import ARMATURE, base_parameters, inertial_parameters
from harness.diagnose.arbitration.transfer import transfer
from harness.errors import InputError
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

from simulated_recordings import Rig, double_pendulum, nominal, recording, releases, swing  # isort: skip

DRY, VISCOUS, NOISE = 6e-3, 1.5e-3, 2e-3
TRUE = Rig(viscous=VISCOUS, dry=DRY)


def identified(**changes: float) -> System:
    """The pendulum's model with damping and friction as some toolbox has identified them."""
    system = nominal()
    return system.replace_joint(replace(system.joints[0], **changes))


def by_label(document: dict, key: str = "numbers") -> dict:
    return {row["number"]: row for row in document[key]}


def test_combinations_of_two_links_in_a_plane_are_the_textbooks() -> None:
    """Khalil and Dombre, Modeling, Identification and Control of Robots (2002), section 9.4.4: ZZR1 = ZZ1 + Ia1 + d2² M2,
    MXR1 = MX1 + d2 M2; here the second joint lies 0.3 m down the first link's z."""
    system, _ = double_pendulum(0.0, 0.0, 0)
    found = {p.key: {key: factor for factor, key in p.with_} for p in base_parameters(system)}
    assert set(found) == {
        *((link, name) for link in ("upper", "lower") for name in ("inertia_yy", "first_x", "first_z")),
        ("elbow", ARMATURE),
    }
    first = found["upper", "inertia_yy"]
    assert set(first) == {("shoulder", ARMATURE), ("lower", "mass")}
    assert first["shoulder", ARMATURE] == pytest.approx(1.0)
    assert first["lower", "mass"] == pytest.approx(0.3**2)
    assert found["upper", "first_z"] == pytest.approx({("lower", "mass"): -0.3})
    assert not any(found[key] for key in found if key[0] == "lower")


def test_as_many_combinations_as_pinocchios_regressor_has_rank() -> None:
    pinocchio = pytest.importorskip("pinocchio")
    rng = np.random.default_rng(3)
    joints, links, model = [], [], pinocchio.Model()
    parent, number = "base", 0
    for k, kind in enumerate(("revolute", "revolute", "prismatic", "revolute")):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        xyz = rng.normal(size=3)
        joints.append(Joint(f"j{k}", JointType(kind), parent, f"l{k}", xyz=constant(xyz), axis=constant(axis)))
        com, half = rng.normal(size=3), rng.normal(size=(3, 3))
        links.append(Link(f"l{k}", 1.0 + k, constant(com), constant(half @ half.T + np.eye(3))))
        moving = (
            pinocchio.JointModelPrismaticUnaligned if kind == "prismatic" else pinocchio.JointModelRevoluteUnaligned
        )
        number = model.addJoint(number, moving(axis), pinocchio.SE3(np.eye(3), xyz), f"j{k}")
        model.appendBodyToJoint(
            number, pinocchio.Inertia(links[-1].mass, com, np.array(links[-1].inertia)), pinocchio.SE3.Identity()
        )
        parent = f"l{k}"
    data = model.createData()
    rows = [pinocchio.computeJointTorqueRegressor(model, data, *rng.normal(size=(3, 4))).copy() for _ in range(60)]
    rank = np.linalg.matrix_rank(np.concatenate(rows), tol=1e-8)
    found = base_parameters(System("tree", tuple(joints), tuple(links)))
    assert sum(p.key[1] != ARMATURE for p in found) == rank


def test_recordings_side_with_the_model_that_has_the_friction() -> None:
    runs = releases(TRUE, (1.4, 0.8, 1.1), NOISE, 1, duration=6.0)
    both = arbitrate(
        runs, [identified(damping=VISCOUS, friction=DRY), identified(damping=8e-3)], names=["dry", "damped"]
    )
    row = both["prediction"][0]
    assert row["better"] == "dry"
    assert row["models"]["dry"]["heldout_rmse"] == pytest.approx(NOISE, rel=0.1)
    assert row["models"]["damped"]["heldout_rmse"] > 10.0 * NOISE
    assert all(place["better"] in ("dry", "too few") for place in both["where"])
    told = by_label(both)
    for label, true in (("viscous damping at pivot", VISCOUS), ("dry friction at pivot", DRY)):
        assert told[label]["says"] == "dry"
        assert abs(told[label]["value"] - true) < 4.0 * told[label]["std"]
        assert told[label]["std"] < 0.02 * true
    assert told["first moment z of rod"]["says"] == "agree"
    # Without a known torque nothing tells the inertia itself.
    assert both["counted_by"] == "inertia yy of rod with what acts like it"


def test_a_known_torque_tells_the_inertia_itself() -> None:
    time = np.arange(0.0, 6.0, 0.01)
    rng = np.random.default_rng(4)

    def effort(t: float) -> float:
        return 0.2 * np.sin(5.0 * t) + 0.1 * np.sin(11.0 * t)

    runs = []
    for k, angle in enumerate((0.6, -0.4, 0.9)):
        moved = swing(Rig(viscous=VISCOUS), angle, time, effort) + NOISE * rng.standard_normal(len(time))
        pushed = np.array([effort(t) for t in time])
        runs.append(recording(f"run{k}", time, {"pivot.position": moved, "pivot.effort": pushed}))
    true = nominal()
    lighter = true.replace_link(
        replace(true.links[0], mass=0.8 * true.links[0].mass, inertia=constant(0.8 * true.links[0].inertia))
    )
    found = arbitrate(runs, [true, lighter], names=["whole", "lighter"])
    told = by_label(found)
    assert found["counted_by"] is None
    about = inertial_parameters(true)["rod", "inertia_yy"]
    row = told["inertia yy of rod with what acts like it"]
    assert row["says"] == "whole"
    assert abs(row["value"] - about) < 4.0 * row["std"] < 0.05 * about
    assert found["prediction"][0]["better"] == "whole"


def test_models_with_other_masses_and_the_same_combinations_agree() -> None:
    """What no motion shows cannot be decided, and is not told as a difference: 100 g of the lower link about the elbow moved to the
    upper one at the elbow, with the lower link's moments as they were."""
    nominal_, runs = double_pendulum(2e-3, 1e-3, 5)
    one = nominal_.replace_joint(replace(nominal_.joint("elbow"), damping=2e-3))
    moved = 0.1

    def with_moments(link: Link, mass: float, first: np.ndarray, second: np.ndarray) -> Link:
        com = first / mass
        return replace(
            link, mass=mass, com=constant(com),
            inertia=constant(second - mass * (float(com @ com) * np.eye(3) - np.outer(com, com))),
        )  # fmt: skip

    def moments(link: Link) -> tuple[np.ndarray, np.ndarray]:
        c = link.com
        return link.mass * c, link.inertia + link.mass * (float(c @ c) * np.eye(3) - np.outer(c, c))

    upper, lower = one.link("upper"), one.link("lower")
    at = np.array([0.0, 0.0, -0.3])
    first, second = moments(upper)
    point = moved * (float(at @ at) * np.eye(3) - np.outer(at, at))
    other = one.replace_link(with_moments(upper, upper.mass + moved, first + moved * at, second + point))
    other = other.replace_link(with_moments(lower, lower.mass - moved, *moments(lower)))
    found = arbitrate(runs, [one, other], names=["one", "other"])
    for row in found["numbers"]:
        assert row["models"]["one"] == pytest.approx(row["models"]["other"], abs=1e-12)
        assert row["says"] in ("agree", "open", "reference"), row
    assert found["prediction"][0]["models"]["one"] == pytest.approx(found["prediction"][0]["models"]["other"], rel=1e-6)
    assert all(place["better"] in ("level", "too few") for place in found["where"])


def test_a_short_noisy_swing_leaves_friction_open() -> None:
    runs = releases(Rig(viscous=1e-3), (0.1, 0.12), 2e-2, 6, duration=1.5)
    found = arbitrate(runs, [identified(damping=1e-3), identified(friction=2e-3)], names=["viscous", "dry"])
    told = by_label(found)
    assert {told[f"{law} at pivot"]["says"] for law in ("viscous damping", "dry friction")} == {"open"}
    assert told["viscous damping at pivot"]["ci95"][0] <= 1e-3 <= told["viscous damping at pivot"]["ci95"][1]
    assert any(row["says"] == "open" for row in found["combinations"])
    assert "leave open" in found["summary"]


@pytest.mark.parametrize(("std", "says"), [(0.0004, "neither"), (0.0100, "open")])
def test_a_number_that_an_interval_leaves_out_is_not_left_open(std: float, says: str) -> None:
    """0.0122 ± 0.0008 N·m·s/rad of what is published as nothing, whose size is the natural one of 0.0005: thirty standard
    deviations off. Of an interval that holds nothing too, no more can be said."""
    number = SimpleNamespace(
        label="viscous damping at servo", joint="servo", unit="N·m·s/rad", size=5e-4, positive=True, inertial=None
    )
    estimate = SimpleNamespace(
        numbers=np.array([0.0122]), std=np.array([std]), x=np.array([24.4]), covariance=np.array([[(std / 5e-4) ** 2]]),
        reference=None, fitted=SimpleNamespace(free=np.array([True])),
        freed=SimpleNamespace(numbers=[number], of=lambda numbers: numbers / 5e-4),
    )  # fmt: skip
    for rows in (by_number, by_combination):
        (row,) = rows(estimate, {"published": np.array([0.0])})
        assert row["says"] == says


def test_what_carries_over_to_another_unit() -> None:
    """The other unit rubs twice as much; all else is the same."""
    runs = releases(replace(TRUE, dry=2.0 * DRY), (1.4, 0.8, 1.1), NOISE, 7, duration=6.0)
    found = transfer(runs, identified(damping=VISCOUS, friction=DRY), name="first unit")
    told = by_label(found)
    assert told["dry friction at pivot"]["says"] == "does not"
    low, high = told["dry friction at pivot"]["ci95"]
    assert low - 0.01 * DRY <= 2.0 * DRY <= high + 0.01 * DRY
    assert told["viscous damping at pivot"]["says"] == "carries over"
    errors = {name: parts["heldout_rmse"] for name, parts in found["prediction"][0]["models"].items()}
    assert errors["first unit"] > 5.0 * NOISE
    assert errors["mended"] == pytest.approx(NOISE, rel=0.1)
    assert errors["refitted"] == pytest.approx(NOISE, rel=0.1)
    assert "ratios alone" in found["summary"] and found["counted_by"] in found["summary"]
    assert "more than noise" not in found["summary"]


def test_a_law_that_no_model_has_is_a_reservation() -> None:
    told = reservations(None, [{"channel": "a", "times_noise": 1.2}, {"channel": "b", "times_noise": 31.7}])
    assert "b 32 times" in told and "a 1.2" not in told and "ratios" not in told
    assert reservations(None, [{"channel": "a", "times_noise": 1.2}]) == ""


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda s: replace(s, joints=(replace(s.joints[0], name="hinge"),)), "'pivot'"),
        (lambda s: replace(s, joints=(replace(s.joints[0], type=JointType.PRISMATIC),)), "prismatic"),
    ],
)
def test_models_of_other_joints_are_refused(change, told) -> None:
    runs = releases(TRUE, (0.8, 0.6), NOISE, 8, duration=2.0)
    with pytest.raises(InputError, match=told):
        arbitrate(runs, [nominal(), change(nominal())], names=["one", "other"])


def test_links_may_have_other_names() -> None:
    runs = releases(TRUE, (0.8, 0.6), NOISE, 9, duration=3.0)
    system = identified(damping=VISCOUS, friction=DRY)
    other = replace(
        system, joints=(replace(system.joints[0], child="arm"),), links=(replace(system.links[0], name="arm"),)
    )
    found = arbitrate(runs, [system, other], names=["one", "other"])
    assert found["prediction"][0]["models"]["one"] == found["prediction"][0]["models"]["other"]
