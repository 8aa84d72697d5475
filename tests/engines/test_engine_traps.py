"""What the engines do without a word, and the adapters must not: NaN, wrong sizes, silent resets, features left out."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.engines import registry
from harness.engines.folded import bodies
from harness.engines.mujoco_model import mujoco_model
from harness.engines.pinocchio_model import depth_first
from harness.engines.protocol import Engine, EngineError, EngineModel
from harness.errors import EngineUnavailableError, InputError, UnsupportedError
from harness.system import Attachment, Joint, JointType, Link, System
from harness.system.random_systems import random_chain, random_tree

ALL = ("denoc", "pinocchio", "mujoco", "exudyn", "analytic")


def pendulum(**joint: object) -> System:
    """A point mass of 1 kg, 1 m below the pivot."""
    pivot = Joint("pivot", JointType.REVOLUTE, "base", "bob", axis=np.array([0.0, 1.0, 0.0]), **joint)
    return System("pendulum", (pivot,), (Link("bob", 1.0, np.array([0.0, 0.0, -1.0])),))


@pytest.mark.parametrize("name", ALL)
def test_adapters_fulfil_the_protocol(name: str) -> None:
    engine = registry.engine(name)
    assert isinstance(engine, Engine)
    assert engine.name == name
    model = engine.build(pendulum())
    assert isinstance(model, EngineModel)
    assert model.names == ("pivot",)


@pytest.mark.parametrize("name", ALL)
def test_point_mass_on_a_string(name: str) -> None:
    # q'' = -(g/l) sin q by hand; MuJoCo's compiler would refuse a body without inertia.
    model = registry.engine(name).build(pendulum())
    q = np.array([0.3])
    assert model.forward_dynamics(q, np.zeros(1), np.zeros(1))[0] == pytest.approx(-9.81 * np.sin(0.3), rel=1e-13)
    assert model.mass_matrix(q)[0, 0] == pytest.approx(1.0, rel=1e-13)
    assert model.frequencies(np.zeros(1)) == pytest.approx([np.sqrt(9.81) / (2.0 * np.pi)], rel=1e-9)
    assert len(model.frequencies(np.array([np.pi]))) == 0


@pytest.mark.parametrize("name", ALL)
def test_bad_states_are_refused_before_they_reach_the_engine(name: str) -> None:
    model = registry.engine(name).build(pendulum())
    good, bad, long = np.zeros(1), np.array([np.nan]), np.zeros(2)
    for q, qd, tau in [(bad, good, good), (good, bad, good), (good, good, bad), (long, good, good), (good, good, long)]:
        with pytest.raises(InputError):
            model.forward_dynamics(q, qd, tau)
        with pytest.raises(InputError):
            model.inverse_dynamics(q, qd, tau)
    for time in ([0.0, 0.0], [0.0, np.nan], [], [[0.0]]):
        with pytest.raises(InputError):
            model.simulate(good, good, np.array(time))
    with pytest.raises(InputError, match="tau"):
        model.simulate(good, good, np.array([0.0, 1.0]), tau=np.zeros((3, 1)))
    with pytest.raises(InputError, match="step"):
        if name == "analytic":
            raise InputError("step does not matter to a closed form")
        model.simulate(good, good, np.array([0.0, 1.0]), step=-1.0)


def test_mujoco_does_not_reset_silently(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # MuJoCo alone would restart a run that blows up at qpos0, and leave MUJOCO_LOG.TXT in the working directory.
    monkeypatch.chdir(tmp_path)
    stiff = registry.engine("mujoco").build(pendulum(stiffness=1e8))
    with pytest.raises(EngineError, match="smaller step"):
        stiff.simulate(np.ones(1), np.zeros(1), np.linspace(0.0, 1.0, 11), step=1e-2)
    assert list(tmp_path.iterdir()) == []
    # The model is usable afterwards.
    assert stiff.forward_dynamics(np.zeros(1), np.zeros(1), np.zeros(1))[0] == 0.0


def test_pinocchio_refuses_sizes_that_exhaust_memory() -> None:
    engine = registry.engine("pinocchio")
    assert engine.refuses(random_chain(200, 0)) is None
    system = random_chain(500, 0)
    # Four tensors of 500³ doubles are 4.0 GB.
    assert "4.0 GB" in str(engine.refuses(system))
    with pytest.raises(UnsupportedError):
        engine.build(system)


@pytest.mark.parametrize("name", ALL)
def test_elastic_links_and_unknown_effects_are_refused(name: str) -> None:
    engine = registry.engine(name)
    if name != "denoc":
        assert "elastic" in str(engine.refuses(random_chain(1, 0, flexible=1.0)))
    strange = replace(pendulum(), attachments=(Attachment("no_such_effect", "pivot", {}),))
    assert "no_such_effect" in str(engine.refuses(strange))
    with pytest.raises(UnsupportedError):
        engine.build(strange)
    assert engine.refuses(System("nothing", (), ())) is not None


def test_dry_friction_acts_in_motion_only_and_only_where_the_engine_has_it() -> None:
    system = pendulum(friction=0.5, damping=0.1)
    q, qd, tau = np.array([0.3]), np.array([2.0]), np.zeros(1)
    for name in ALL:
        model = registry.engine(name).build(system)
        assert model.forward_dynamics(q, qd, tau)[0] == pytest.approx(-9.81 * np.sin(0.3) - 0.2, rel=1e-12)
    for name in ("pinocchio", "exudyn", "analytic"):
        with pytest.raises(UnsupportedError, match=r"dry friction|damping"):
            registry.engine(name).build(system).simulate(q, qd, np.array([0.0, 1.0]))
    # A rotor without gravity coasts to rest: v = v0 - (F/J) t, by hand, while it slides.
    rotor = replace(pendulum(friction=0.5), gravity=np.zeros(3))
    time = np.linspace(0.0, 2.0, 21)
    for name, allowed in (("mujoco", 2e-3), ("analytic", 1e-12)):
        run = registry.engine(name).build(rotor).simulate(np.zeros(1), np.array([2.0]), time)
        assert np.max(np.abs(run.velocity[:, 0] - (2.0 - 0.5 * time))) < allowed
    model = registry.engine("mujoco").build(rotor)
    model.simulate(np.zeros(1), np.array([2.0]), time)
    assert model.forward_dynamics(np.zeros(1), np.array([2.0]), tau)[0] == 0.0


def test_mujoco_gets_exactly_our_inertias() -> None:
    system = random_tree(6, 4, fixed=0.3)
    model = mujoco_model(system)
    for link in system.links:
        body = model.body(link.name).id
        assert model.body_mass[body] == link.mass
        moments = np.sort(np.linalg.eigvalsh(link.inertia))
        assert np.sort(model.body_inertia[body]) == pytest.approx(moments, rel=1e-12)


def test_joints_reach_pinocchio_depth_first() -> None:
    # base -> a -> c and base -> b -> d, stated breadth first.
    def joint(parent: str, child: str) -> Joint:
        return Joint(f"to_{child}", JointType.REVOLUTE, parent, child)

    links = tuple(Link(name, 1.0, np.ones(3), np.eye(3)) for name in "abcd")
    system = System("t", (joint("base", "a"), joint("base", "b"), joint("a", "c"), joint("b", "d")), links)
    assert [link.name for _, link in depth_first(system)] == ["a", "c", "b", "d"]
    mass = registry.engine("pinocchio").build(system).mass_matrix(np.zeros(4))
    # a and c are one branch, b and d the other; the branches do not couple.
    assert mass[0, 1] == mass[0, 3] == mass[1, 2] == mass[2, 3] == 0.0
    assert mass[0, 2] != 0.0
    assert mass[1, 3] != 0.0
    assert np.array_equal(mass, mass.T)


def test_welding_keeps_mass_and_centre_of_mass() -> None:
    system = random_tree(5, 7, fixed=0.5)
    moving, fixed_potential = bodies(system)
    assert len(moving) == 5
    assert sum(body.mass for body in moving) <= sum(link.mass for link in system.links) * (1.0 + 1e-12)
    total = sum(link.mass for link in system.links) - sum(body.mass for body in moving)
    assert (total > 1e-12) == (fixed_potential != 0.0)


def test_missing_engine_is_a_line_not_a_crash(monkeypatch: pytest.MonkeyPatch) -> None:
    from importlib import metadata

    real = metadata.version

    def without_pin(name: str) -> str:
        if name == "pin":
            raise metadata.PackageNotFoundError(name)
        return real(name)

    monkeypatch.setattr(metadata, "version", without_pin)
    with pytest.raises(EngineUnavailableError, match=r"denoc-harness\[engines\]"):
        registry.engine("pinocchio").version()
    lines = {line.name: line for line in registry.availability()}
    assert lines["pinocchio"].version is None
    assert "denoc-harness[engines]" in lines["pinocchio"].reason
    assert lines["mujoco"].version is not None
    assert "pinocchio" not in [engine.name for engine in registry.available()]


def test_an_older_mujoco_beside_the_core_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """The core is one of two distributions that write into one package."""
    from importlib import metadata

    def installed(name: str) -> str:
        known = {"mujoco": "3.3.2", "mujoco-core": "4.0.0"}
        if name not in known:
            raise metadata.PackageNotFoundError(name)
        return known[name]

    monkeypatch.setattr(metadata, "version", installed)
    with pytest.raises(EngineUnavailableError, match=r"3\.3\.2 and mujoco-core 4\.0\.0 .*--upgrade mujoco"):
        registry.engine("mujoco").version()


def test_registry_lists_the_native_engine_first_and_knows_its_names() -> None:
    assert registry.names()[0] == "denoc"
    assert set(ALL) <= set(registry.names())
    assert [engine.name for engine in registry.engines()] == list(registry.names())
    with pytest.raises(InputError, match="no engine is named 'bullet'"):
        registry.engine("bullet")
