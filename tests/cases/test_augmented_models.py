"""Models with effects attached run as files, the effects that add coordinates of their own included."""

from dataclasses import replace

import numpy as np
import pytest

from harness import effects
from harness.cases.single_run import run_once
from harness.cases.users import case_of
from harness.engines import registry
from harness.engines.expressed import realised
from harness.system import Attachment, load
from harness.system.write import write

TIME = np.arange(0.0, 0.5, 0.01)
ADDING = [e.name for e in effects.catalogue().values() if e.reshape is not None and e.reshape.topology]
# Stiff against what the pendulum weighs (0.1 to 1 kg, 0.3 to 1 m), and soft enough to show.
SIZES = {
    "backlash": {"gap": 0.02},
    "base_compliance": {"stiffness": 800.0, "mass": 0.3, "damping": 2.0},
    "geometric_stiffening": {"scale": 0.5},
    "higher_mode": {"frequency": 60.0, "damping_ratio": 0.05},
    "joint_flexibility": {"stiffness": 20.0, "damping": 0.05},
    "link_flexibility": {"frequency": 20.0, "damping_ratio": 0.05},
}
FLEXIBLE = ("geometric_stiffening", "higher_mode")


def with_effect(name, folder):
    """A model file with one effect in it, read again."""
    bends = name in FLEXIBLE
    plain = load(f"models/{'toml/flexible_pendulum.toml' if bends else 'urdf/double_pendulum.urdf'}")
    if name == "geometric_stiffening":
        (link,) = (link for link in plain.links if link.beam is not None)
        plain = plain.replace_link(replace(link, beam=replace(link.beam, geometric_stiffening=False)))
    kind = effects.effect(name)
    site = {"joint": plain.joint_names[0], "link": plain.links[0].name, "base": "base"}[str(kind.site)]
    parameters = {p.name: SIZES[name].get(p.name, 1.0) for p in kind.parameters}
    path = folder / f"{name}.toml"
    write(replace(plain, attachments=(Attachment(name, site, parameters),)), path)
    return plain, load(path), path


@pytest.mark.parametrize("name", ADDING)
def test_effects_that_add_coordinates_run_in_every_engine_that_has_them(name, tmp_path):
    plain, system, _ = with_effect(name, tmp_path)
    start, speed = {plain.joint_names[0]: 0.6}, {plain.joint_names[-1]: -0.5}
    tau = np.zeros((len(TIME), len(plain.coordinate_names)))
    tau[:, 0] = 0.2
    native = run_once(system, TIME, start, speed, tau=tau)
    first = f"{plain.joint_names[0]}.position"
    assert native.columns[first][0] == pytest.approx(0.6)
    assert set(native.columns) >= {f"{joint}.position" for joint in plain.joint_names}
    # With the effect it is another motion, else nothing was attached at all.
    without = run_once(plain, TIME, start, speed, tau=tau)
    assert np.abs(native.columns[first] - without.columns[first]).max() > 1e-6
    for engine in ("mujoco", "exudyn", "pinocchio"):
        if registry.engine(engine).refuses(realised(system)) is None:
            other = run_once(system, TIME, start, speed, engine=engine, tau=tau, step=2e-4)
            assert np.abs(other.columns[first] - native.columns[first]).max() < 2e-4


@pytest.mark.parametrize("name", ADDING)
def test_effects_that_add_coordinates_are_refused_in_words_by_engines_without_them(name, tmp_path):
    _, system, _ = with_effect(name, tmp_path)
    for engine in ("mujoco", "exudyn", "pinocchio", "analytic"):
        reason = registry.engine(engine).refuses(system)
        if realised(system).flexible:
            assert reason is not None and "elastic" in reason


@pytest.mark.parametrize("name", ADDING)
def test_a_users_model_with_an_effect_is_compared_with_it(name, tmp_path):
    from harness.cases.run import run_case

    _, system, path = with_effect(name, tmp_path)
    case = case_of(name, path)
    assert case.system().coordinate_names == realised(system).coordinate_names
    assert len(case.system().coordinate_names) >= len(system.coordinate_names)
    engines = {n: registry.engine(n) for n in ("denoc", "mujoco", "exudyn", "pinocchio")}
    rows = [row for row in run_case(case, engines).rows if row.verdict == "fail"]
    assert rows == []
