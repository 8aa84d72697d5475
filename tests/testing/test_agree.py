"""Other projects' engines: held against ours by an assertion, by pytest's plugin, by entry point, and in a workflow."""

from __future__ import annotations

import itertools
import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.denoc import Denoc
from harness.engines import own, registry
from harness.errors import InputError
from harness.system import load, random_chain
from harness.system.description import constant
from harness.testing import assert_dynamics_agree

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "own_engine"
CART = ROOT / "models" / "urdf" / "cart_pendulum.urdf"


def borrowed(system, spoil=lambda system: system, names=None):
    """Pinocchio under another name, with its own order of coordinates."""
    model = registry.engine("pinocchio").build(spoil(system))
    ours = model.names
    order = [ours.index(name) for name in (names or ours)]
    back = [order.index(k) for k in range(len(ours))]

    class Model:
        def forward_dynamics(self, q, qd, tau):
            return model.forward_dynamics(q[back], qd[back], tau[back])[order]

        def inverse_dynamics(self, q, qd, qdd):
            return model.inverse_dynamics(q[back], qd[back], qdd[back])[order]

        def mass_matrix(self, q):
            return model.mass_matrix(q[back])[np.ix_(order, order)]

        def bias(self, q, qd):
            return model.bias(q[back], qd[back])[order]

        def gravity(self, q):
            return model.gravity(q[back])[order]

        def simulate(self, q0, qd0, time):
            run = model.simulate(q0[back], qd0[back], time)
            return run.position[:, order], run.velocity[:, order]

    found = Model()
    found.names = tuple(ours[k] for k in order)
    return found


def test_an_engine_that_is_right_agrees():
    rows = assert_dynamics_agree(borrowed, CART).rows
    assert {row.quantity for row in rows if row.verdict == "pass"} >= {"acceleration", "mass_matrix", "trajectory"}
    assert all("borrowed" in row.engines for row in rows)


def test_an_order_of_coordinates_of_its_own_is_sorted_out():
    system = random_chain(4, seed=3, prismatic=0.3, damping=True)
    assert_dynamics_agree(lambda s: borrowed(s, names=("joint3", "joint1", "joint4", "joint2")), system)


@pytest.mark.parametrize("has", ["forward_dynamics", "inverse_dynamics"])
@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda s: replace(s, gravity=constant(1.01 * s.gravity)), "gravity is 0.990099 times the reference's"),
        (lambda s: s.replace_joint(replace(s.joints[1], damping=0.3)), "damping differs at joint2 alone"),
        (lambda s: s.replace_link(replace(s.links[2], mass=1.01 * s.links[2].mass)), "the mass of link 'link3'"),
    ],
)
def test_an_engine_with_one_method_alone_is_told_why_too(has, spoil, words):
    def few(system):
        model = borrowed(system, spoil)
        alone = type("Alone", (), {has: staticmethod(getattr(model, has))})()
        alone.names = model.names
        return alone

    with pytest.raises(AssertionError, match=words):
        assert_dynamics_agree(few, random_chain(3, seed=3, prismatic=0.0, damping=True))


def test_an_engine_that_is_wrong_is_told_where_and_why():
    def heavier(system):
        link = system.links[2]
        return system.replace_link(replace(link, mass=link.mass * 1.01))

    system = random_chain(4, seed=3, prismatic=0.3, damping=True)
    with pytest.raises(AssertionError) as caught:
        assert_dynamics_agree(lambda s: borrowed(s, heavier), system)
    said = str(caught.value)
    assert "mass matrix" in said and "joint3" in said
    assert "trajectory" in said and re.search(r"time [0-9.]+", said)


class Silent:
    name = "silent"

    def build(self, system):
        return self


class Misshapen(Silent):
    name = "misshapen"

    def gravity(self, q):
        return np.zeros(len(q) + 1)


class Renamed(Silent):
    names = ("a", "b")

    def gravity(self, q):
        return np.zeros(len(q))


@pytest.mark.parametrize(
    ("engine", "kind", "words"),
    [
        (Silent, AssertionError, "has no forward_dynamics"),
        (Misshapen, AssertionError, r"gravity gave shape \(3,\), not \(2,\)"),
        (Renamed, AssertionError, "the system has slide, pivot"),
        ("no_such_engine", InputError, "no engine is named"),
        (7, InputError, "is no engine"),
    ],
)
def test_what_is_no_engine_is_told_so(engine, kind, words):
    with pytest.raises(kind, match=words):
        assert_dynamics_agree(engine, CART)


def test_flexible_links_are_not_handed_to_an_engine_that_does_not_speak_of_them():
    with pytest.raises(InputError, match="flexible links"):
        assert_dynamics_agree(borrowed, ROOT / "models" / "toml" / "flexible_pendulum.toml")


@pytest.fixture
def installed(tmp_path):
    """The example as another repository has it, installed beside us as pip would; its environment for subprocesses."""
    repository = tmp_path / "repository"
    shutil.copytree(EXAMPLE, repository, ignore=shutil.ignore_patterns("__pycache__"))
    site = tmp_path / "site"
    shutil.copytree(EXAMPLE, site, ignore=shutil.ignore_patterns("__pycache__", "test_*"))
    facts = site / "my_engine-1.0.dist-info"
    facts.mkdir()
    (facts / "METADATA").write_text("Metadata-Version: 2.1\nName: my-engine\nVersion: 1.0\n", encoding="utf-8")
    (facts / "entry_points.txt").write_text(
        f"[{own.GROUP}]\nmine = my_engine:MyEngine\nlost = no_such_module:Engine\n", encoding="utf-8"
    )
    path = os.pathsep.join((str(ROOT), str(site)))
    folder = Path(sys.executable).parent
    environment = {**os.environ, "PYTHONPATH": path, "PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"}
    return repository, {name: value for name, value in environment.items() if not name.startswith("PYTEST_")}


def test_the_example_s_own_tests_pass_with_the_plugin(installed):
    repository, environment = installed
    # By its module, since the plugin's entry point may not be that of the code under test.
    arguments = [
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:denoc",
        "-p",
        "harness.testing.plugin",
        "--junitxml",
        "junit.xml",
        "-m",
        "dynamics",
    ]
    run = subprocess.run(
        [sys.executable, *arguments], cwd=repository, env=environment, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr
    assert "2 passed" in run.stdout
    assert "acceleration [denoc+mine]" in (repository / "junit.xml").read_text("utf-8")


def test_an_engine_of_another_package_takes_part_by_name(installed):
    repository, environment = installed
    command = [
        sys.executable,
        "-m",
        "harness",
        "validate",
        "pendulum.urdf",
        "--engine",
        "mine",
        "--rows",
        "--workers",
        "1",
    ]
    run = subprocess.run(command, cwd=repository, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    assert re.search(r"acceleration +denoc · mine ", run.stdout)
    assert re.search(r"All \d+ comparisons are within what is allowed", run.stdout)
    command = [sys.executable, "-m", "harness", "doctor"]
    told = subprocess.run(command, cwd=repository, env=environment, capture_output=True, text=True, check=False).stdout
    assert re.search(r"mine +1\.0 +works", told)
    assert re.search(r"lost .*missing", told) and "no_such_module" in told


def steps() -> dict[str, str]:
    """The shell steps of the action by id; read by hand, so that no YAML reader is needed for one file."""
    text = (ROOT / ".github" / "actions" / "gate" / "action.yml").read_text("utf-8")
    found = {}
    for step in text.split("\n    - ")[1:]:
        if "      run: |\n" in step:
            name = re.match(r"id: (\w+)", step)
            body = step.split("      run: |\n")[1]
            found[name[1]] = "\n".join(line.removeprefix("        ") for line in body.splitlines())
    return found


@pytest.mark.parametrize(("extras", "package"), [("engines", ""), ("", ". another")])
def test_the_action_installs_its_own_version_and_what_else_it_is_told(tmp_path, extras, package):
    told = tmp_path / "python"
    told.write_text('#!/bin/sh\nprintf "%s\\n" "$@"\n', encoding="utf-8")
    told.chmod(0o755)
    action = ROOT / ".github" / "actions" / "gate"
    environment = {
        "PATH": f"{tmp_path}:{os.environ['PATH']}",
        "ACTION": str(action),
        "EXTRAS": extras,
        "PACKAGE": package,
    }
    command = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", steps()["install"]]
    run = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
    own = f"{ROOT}[engines]" if extras else str(ROOT)
    assert run.stdout.splitlines() == ["-m", "pip", "install", "--quiet", own, *package.split()]
    assert (ROOT / "pyproject.toml").exists()


def test_the_action_as_another_repository_runs_it(installed, tmp_path):
    repository, environment = installed
    (repository / "harness").mkdir()  # as others name theirs, too
    (repository / "harness" / "__init__.py").write_text("raise ImportError('another harness')\n", encoding="utf-8")
    gate = [
        sys.executable,
        "-P",
        "-m",
        "harness",
        "gate",
        "pendulum.urdf",
        "--reference",
        "gate.json",
        "--workers",
        "1",
    ]
    subprocess.run(
        [*gate, "--engine", "mine", "--accept", "--new", "--why", "as delivered"],
        cwd=repository, env=environment, check=True, capture_output=True,
    )  # fmt: skip
    script = steps()["gate"]
    files = {"GITHUB_OUTPUT": tmp_path / "output", "GITHUB_STEP_SUMMARY": tmp_path / "summary.md"}
    inputs = {"MODELS": "pendulum.urdf", "REFERENCE": "gate.json", "ENGINES": "mine", "OUT": "out/denoc gate"}
    environment = {**environment, **{name: str(path) for name, path in files.items()}, **inputs}

    def act() -> subprocess.CompletedProcess[str]:
        for path in files.values():
            path.write_text("", encoding="utf-8")
        # As the runner starts `shell: bash`.
        command = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", script]
        return subprocess.run(command, cwd=repository, env=environment, capture_output=True, text=True, check=False)

    run = act()
    assert run.returncode == 0, run.stdout + run.stderr
    told = dict(line.split("=", 1) for line in files["GITHUB_OUTPUT"].read_text("utf-8").splitlines())
    assert (told["open"], told["artifact"], told["junit"]) == ("true", "out-denoc-gate", "out/denoc gate/junit.xml")
    assert "**Open**" in files["GITHUB_STEP_SUMMARY"].read_text("utf-8")
    model = repository / "pendulum.urdf"
    text = model.read_text("utf-8")
    mass = re.search(r'<mass value="([0-9.e-]+)"', text)
    model.write_text(text.replace(mass[0], f'<mass value="{1.05 * float(mass[1])}"'), encoding="utf-8")
    run = act()
    assert run.returncode == 1, run.stdout + run.stderr
    line = text[: mass.start()].count("\n") + 1
    assert f"::error file=pendulum.urdf,line={line},title=pendulum%3A masses::" in run.stdout
    assert "open=false" in files["GITHUB_OUTPUT"].read_text("utf-8")
    summary = files["GITHUB_STEP_SUMMARY"].read_text("utf-8")
    assert "**Closed**" in summary and "mass of link" in summary
    assert (repository / "out" / "denoc gate" / "junit.xml").exists() and (
        repository / "out" / "denoc gate" / "denoc.sarif"
    ).exists()


def test_the_example_is_the_model_it_says():
    assert (
        load(EXAMPLE / "pendulum.urdf").joint_names
        == load(ROOT / "models" / "urdf" / "rigid_pendulum.urdf").joint_names
    )


def stepped(length=None, after=0.0, equations=True, stated=True):
    """The native equations by Euler's steps; length: of its own, whatever is asked; after: when gravity grows by a tenth."""

    def build(system):
        heavier = Denoc(replace(system, gravity=constant(1.1 * system.gravity)))
        model = Denoc(system)

        def run(q0, qd0, time, step):
            q, v, rows = q0.copy(), qd0.copy(), [(q0, qd0)]
            for begin, end in itertools.pairwise(time):
                count = int(np.ceil((end - begin) / step - 1e-9))
                for k in range(count):
                    h = (end - begin) / count
                    late = after > 0.0 and begin + k * h >= after - 1e-9
                    a = (heavier if late else model).forward_dynamics(q, v, np.zeros_like(q))
                    # Of order two, so that what gravity does stands out where it is asked for.
                    q, v = (q + h * v + 0.5 * h * h * a, v + h * a) if after else (q + h * v, v + h * a)
                rows.append((q, v))
            return tuple(np.array(part) for part in zip(*rows, strict=True))

        class Model:
            if equations:

                def forward_dynamics(self, q, qd, tau):
                    return model.forward_dynamics(q, qd, tau)

            if stated:

                def simulate(self, q0, qd0, time, step=None):
                    return run(q0, qd0, time, step or length)

            else:

                def simulate(self, q0, qd0, time):
                    return run(q0, qd0, time, length)

        return Model()

    return build


@pytest.mark.parametrize(
    ("engine", "step", "said", "never"),
    [
        (stepped(), 1e-3, "cause solver", "it is the model"),
        (stepped(equations=False), 1e-3, "cause solver", "it is the model"),
        # One that does not answer to a step: by its own equations, or not at all.
        (
            stepped(1e-3, stated=False),
            1e-3,
            "integrating its own equations closely moves build",
            "finer integration mends",
        ),
        (stepped(1e-3, equations=False, stated=False), 1e-3, "answers to no step", "it is the model"),
        # And one whose own step nobody was told.
        (stepped(1e-3, equations=False), None, "cause solver", "it is the model"),
    ],
)
def test_an_error_of_an_integrator_is_not_taken_for_the_model(engine, step, said, never):
    with pytest.raises(AssertionError) as failed:
        assert_dynamics_agree(engine, CART, quantities=["trajectory"], step=step)
    assert said in str(failed.value)
    assert never not in str(failed.value)


def test_a_force_that_sets_in_later_is_told_from_when_it_does():
    with pytest.raises(AssertionError) as failed:
        assert_dynamics_agree(
            stepped(after=0.5, equations=False), CART, quantities=["trajectory"], allowed_trajectory=1e-3, step=1e-4
        )
    text = str(failed.value)
    assert 0.5 <= float(re.search(r"begins ([0-9.]+) s", text).group(1)) <= 0.56
    assert "exponential" not in text
