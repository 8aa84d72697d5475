"""The command as a user meets it: help, exit status, one line for bad input, nothing half-written."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import harness
from harness.cli.main import VERBS, status_of

ROOT = Path(__file__).parents[2]
PENDULUM = str(ROOT / "models" / "urdf" / "rigid_pendulum.urdf")


@pytest.fixture
def run(capfd):
    """Run the command in this process: (status, standard output, standard error)."""

    def call(*arguments: str) -> tuple[int, str, str]:
        status = status_of(list(arguments))
        out, err = capfd.readouterr()
        return status, out, err

    return call


def refused(result: tuple[int, str, str], *words: str) -> None:
    status, out, err = result
    assert status == 2, err
    assert len(err.strip().splitlines()) == 1, err
    assert "Traceback" not in err + out
    for word in words:
        assert word in err


def test_help_names_every_verb(run):
    status, out, _ = run("--help")
    assert status == 0
    for verb in VERBS:
        assert f"  {verb} " in out


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_helps_with_an_example(run, verb):
    status, out, _ = run(verb, "--help")
    assert status == 0
    assert "Example" in out
    assert f"denoc {verb}" in out
    assert "--json" in out
    assert "--out" in out
    # But for commands to copy, a terminal of 80 columns holds it.
    wide = [line for line in out.splitlines() if len(line) > 80 and not line.lstrip().startswith("denoc ")]
    assert not wide


@pytest.mark.parametrize("verb", VERBS)
def test_whatever_reads_a_model_may_be_allowed_its_meshes(run, verb):
    """The mend of a mesh that lies elsewhere is ``--allow-path DIR``, so every verb that could say so has it."""
    _, out, _ = run(verb, "--help")
    reads = any(word in out.split("Options:")[0].splitlines()[0] for word in ("MODEL", "SYSTEM")) or "--model " in out
    assert ("--allow-path" in out) == reads


def test_a_recorded_pose_asks_for_a_root_that_floats(run, tmp_path):
    log = tmp_path / "thrown.csv"
    names = ",".join(f"root_joint.pose.{name}" for name in ("x", "y", "z", "qw", "qx", "qy", "qz"))
    log.write_text(f"time,{names}\n" + "".join(f"{k / 100},0,0,{1 - k * k * 4.9e-4},1,0,0,0\n" for k in range(40)))
    refused(run("diagnose", str(log), "--model", PENDULUM), "'root_joint.pose.qw'", "--floating")
    alone = tmp_path / "alone.urdf"
    alone.write_text(
        '<robot name="a"><link name="l"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    refused(run("diagnose", str(log), "--model", str(alone)), "nothing can move", "--floating")
    thrown = str(ROOT / "models" / "mjcf" / "floating" / "thrown_box.xml")
    refused(run("diagnose", str(log), "--model", thrown, "--floating"), "the file is no URDF", "type free")
    refused(run("validate", str(alone), "--floating", "--audit-import"), "--audit-import is of joints of one degree")
    # Now it floats, and what is asked for is more of its pose.
    log.write_text("time,l.pose.x\n" + "".join(f"{k / 100},{k * k}\n" for k in range(40)))
    refused(
        run("diagnose", str(log), "--model", str(alone), "--floating"), "has no qw of the pose of joint 'root_joint'"
    )


def test_a_mesh_elsewhere_is_read_where_it_is_allowed(run, tmp_path):
    """A tetrahedron of 10 cm edges along the axes, density 1000: 1000 · 0.1³ / 6 kg."""
    (tmp_path / "meshes").mkdir()
    (tmp_path / "models").mkdir()
    corners = [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    (tmp_path / "meshes" / "l.obj").write_text(
        "\n".join(
            [*("v {} {} {}".format(*c) for c in corners), *("f {} {} {}".format(*(k + 1 for k in f)) for f in faces)]
        )
    )
    model = tmp_path / "models" / "m.xml"
    model.write_text(
        '<mujoco><compiler meshdir="../meshes"/><asset><mesh name="l" file="l.obj"/></asset><worldbody><body name="p">'
        '<joint name="h" axis="0 1 0"/><geom type="mesh" mesh="l" density="1000"/></body></worldbody></mujoco>'
    )
    beside = ("--allow-path", str(tmp_path / "meshes"))
    for verb in (
        ("audit",),
        ("validate", "--engine", "mujoco"),
        ("view", "--duration", "0.1", "--out", str(tmp_path / "v.html")),
    ):
        refused(run(verb[0], str(model), *verb[1:]), "--allow-path")
        status, _, err = run(verb[0], str(model), *verb[1:], *beside)
        assert status == 0, err
    assert harness.load(model, allow=[tmp_path / "meshes"]).links[0].mass == pytest.approx(1000.0 * 0.1**3 / 6.0)


def test_help_loads_nothing_heavy():
    code = "import sys; from harness.cli.main import status_of; status_of(['--help']); print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert not {"numpy", "scipy", "numba", "pinocchio", "mujoco", "matplotlib", "rich", "pandas"} & set(loaded)


def test_python_m_harness_is_the_same_command():
    done = subprocess.run([sys.executable, "-m", "harness", "--version"], capture_output=True, text=True)
    assert done.returncode == 0
    assert "0." in done.stdout


def test_misspelt_words_are_refused_with_what_was_meant(run):
    refused(run("validat"), "did you mean 'validate'")
    refused(run("validate", "--engin", "mujoco"), "--engine")
    refused(run("validate", "--engine", "mujco"), "did you mean 'mujoco'")
    refused(run("validate", "--case", "rigid_pendulm"), "did you mean 'rigid_pendulum'")
    refused(run("report", "x", "--format", "htm"), "html")


def test_missing_files_are_refused(run, tmp_path):
    refused(run("validate", "nowhere.urdf"), "nowhere.urdf", "no such file")
    refused(run("simulate", "nowhere.xml"), "nowhere.xml")
    refused(run("report", str(tmp_path)), "results.json")
    refused(run("gate", "--reference", str(tmp_path / "acepted.json"), "--no-self-test"), "no accepted figures")
    refused(run("audit", "nowhere.toml"), "nowhere.toml")


def test_validate_writes_everything_and_ends_well(run, tmp_path):
    out = tmp_path / "results"
    file = tmp_path / "answer.json"
    status, text, _ = run(
        "validate",
        "--case",
        "chain_2",
        "--engine",
        "pinocchio",
        "--out",
        str(out),
        "--json",
        str(file),
        "--workers",
        "1",
    )
    assert status == 0
    assert "All 6 comparisons are within what is allowed" in text
    assert {p.name for p in out.iterdir()} == {"results.json", "results.md", "results.csv", "junit.xml", "report.html"}
    document = json.loads(file.read_text())
    assert document["schema"] == "denoc.results/1"
    row = document["rows"][0]
    assert {
        "case",
        "quantity",
        "engines",
        "difference",
        "allowed",
        "unit",
        "why_allowed",
        "verdict",
        "note",
    } <= row.keys()
    assert "first_divergence" in row
    assert document["versions"]["pinocchio"]


def test_json_on_standard_output_stands_alone(run):
    status, out, _ = run("validate", PENDULUM, "--engine", "pinocchio", "--json", "-", "--workers", "1")
    assert status == 0
    assert json.loads(out)["rows"]


def test_saved_results_are_rendered_again(run, tmp_path):
    run("validate", "--case", "chain_2", "--engine", "pinocchio", "--out", str(tmp_path), "--workers", "1")
    first = (tmp_path / "results.md").read_text()
    (tmp_path / "results.md").unlink()
    status, _, _ = run("report", str(tmp_path), "--format", "md", "--format", "junit")
    assert status == 0
    assert (tmp_path / "results.md").read_text() == first
    assert run("report", str(tmp_path))[1].count("chain_2") == 1


def gate_files(run, tmp_path) -> tuple[Path, Path]:
    run("validate", "--case", "chain_2", "--engine", "pinocchio", "--out", str(tmp_path), "--workers", "1")
    return tmp_path / "results.json", tmp_path / "reference" / "accepted.json"


def test_the_gate_accepts_with_a_reason_and_then_holds(run, tmp_path):
    results, reference = gate_files(run, tmp_path)
    gate = ("gate", "--results", str(results), "--reference", str(reference), "--no-self-test")
    # A path that is not there never becomes a new reference by itself.
    refused(run(*gate), "no accepted figures")
    refused(run(*gate, "--accept", "--why", "first"), "no accepted figures")
    refused(run(*gate, "--accept", "--new"), "reason")
    assert not reference.exists()
    assert run(*gate, "--accept", "--new", "--why", "first figures")[0] == 0
    assert json.loads(reference.read_text())["history"][0]["why"] == "first figures"
    refused(run(*gate, "--accept", "--new", "--why", "again"), "exists already")
    assert run(*gate)[0] == 0


def test_the_gate_closes_on_a_changed_figure_and_says_which(run, tmp_path):
    results, reference = gate_files(run, tmp_path)
    gate = ("gate", "--results", str(results), "--reference", str(reference), "--no-self-test")
    run(*gate, "--accept", "--new", "--why", "first figures")
    document = json.loads(results.read_text())
    document["rows"][0].update(difference=1.0, verdict="fail", first_divergence={"coordinate": "joint1"})
    del document["rows"][1]
    results.write_text(json.dumps(document))
    answer = tmp_path / "gate.json"
    status, out, _ = run(*gate, "--json", str(answer))
    assert status == 1
    assert "acceleration" in out and "left the line" in out and "joint1" in out and "missing" in out
    rows = json.loads(answer.read_text())["rows"]
    assert {"accepted", "change", "reason"} <= rows[0].keys()
    assert rows[0]["change"] == pytest.approx(1.0)
    refused(run(*gate, "--accept", "--why", "wish"), "rows fail")


def test_simulate_writes_a_recording_that_can_be_read(run, tmp_path):
    from harness.recording import read_recording

    for name in ("run.csv", "run.csv.gz", "run.parquet"):
        file = tmp_path / name
        status, _, err = run(
            "simulate", PENDULUM, "--engine", "mujoco", "--duration", "1", "--rate", "100", "--position", "pivot=30[deg]",
            "--out", str(file),
        )  # fmt: skip
        assert status == 0, err
        recording = read_recording(file)
        assert recording.samples == 101
        position = next(c for c in recording.channels if c.name == "pivot.position").values
        # 30° in radians.
        assert position[0] == pytest.approx(0.5235987755982988, abs=1e-12)


def test_simulate_says_which_shapes_a_beam_got_and_why(run, tmp_path):
    model = ROOT / "models" / "toml" / "flexible_pendulum.toml"
    status, out, _ = run("simulate", str(model), "--duration", "0.05", "--out", str(tmp_path / "run.csv"))
    assert status == 0
    assert "rod: picked pinned modes with the hub's inertia" in out and "because the joint is free to turn" in out


def test_simulate_runs_an_unphysical_model_if_told_to(run, tmp_path):
    model = tmp_path / "leg.urdf"
    # About the joint 0.05 kg·m², so that it moves; about the centre of mass a negative moment, which no body has.
    model.write_text(
        """<robot name="leg"><link name="base"/><link name="leg"><inertial><origin xyz="0 0 -0.2"/><mass value="1.5"/>
        <inertia ixx="-0.01" iyy="-0.01" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="hip" type="continuous"><parent link="base"/><child link="leg"/><axis xyz="0 1 0"/></joint></robot>"""
    )
    simulate = ("simulate", str(model), "--duration", "0.1", "--rate", "100", "--position", "hip=0.5")
    refused(run(*simulate), "--allow-unphysical")
    status, out, err = run(*simulate, "--allow-unphysical")
    assert status == 0, err
    assert len(out.splitlines()) == 12


def test_simulate_refuses_what_makes_no_run(run, tmp_path):
    simulate = ("simulate", PENDULUM, "--engine", "mujoco")
    refused(run(*simulate, "--position", "pivt=1"), "did you mean 'pivot'")
    refused(run(*simulate, "--position", "pivot"), "joint=value")
    refused(run(*simulate, "--position", "pivot=9e9"), "pivot of 9e+09 rad is beyond any mechanism")
    refused(run(*simulate, "--velocity", "pivot=-9e9"), "pivot of -9e+09 rad/s is beyond any mechanism")
    refused(run(*simulate, "--position", "pivot=nan"), "finite")
    refused(run(*simulate, "--position", "pivot=1", "--position", "pivot=2"), "twice")
    refused(run(*simulate, "--position", "pivot=1[kg]"), "kg")
    refused(run(*simulate, "--duration", "-1"), "--duration")
    refused(run(*simulate, "--rate", "0"), "--rate")
    refused(run(*simulate, "--duration", "1e9"), "samples")
    refused(run(*simulate, "--duration", "ten"), "ten")
    refused(run(*simulate, "--out", str(tmp_path / "run.xyz")), ".csv")
    refused(run(*simulate, "--effort", "nowhere.csv"), "nowhere.csv")
    refused(run(*simulate, "--hold", "cubic"), "cubic")
    assert list(tmp_path.iterdir()) == []


def test_simulate_holds_an_effort_between_its_samples(run, tmp_path):
    effort = tmp_path / "effort.csv"
    effort.write_text("time,pivot.effort\n" + "".join(f"{0.1 * k},0.05\n" for k in range(30)))
    status, out, err = run(
        "simulate", PENDULUM, "--engine", "mujoco", "--duration", "1", "--rate", "10", "--effort", str(effort)
    )
    assert status == 0, err
    header, *rows = out.splitlines()
    assert header == "time,pivot.position,pivot.velocity,pivot.effort"
    assert {row.split(",")[3] for row in rows} == {"0.05"}
    assert float(rows[-1].split(",")[1]) != 0.0


def test_audit_finds_the_printed_table_impossible(run):
    status, out, _ = run(
        "audit", str(ROOT / "models" / "toml" / "flexible_pendulum_as_printed.toml"), "--measured", "rod=37"
    )
    assert status == 1
    assert "40000 kg/m³" in out
    refused(run("audit", PENDULUM, "--measured", "rod"), "--measured")
    flexible = str(ROOT / "models" / "toml" / "flexible_pendulum.toml")
    refused(run("audit", flexible, "--measured", "rod=nan"), "no frequency of 'rod'")


def test_audit_calls_impossible_only_what_cannot_be(run, tmp_path):
    model = tmp_path / "arm.toml"
    joint = '[[joint]]\nname = "j"\ntype = "revolute"\nparent = "base"\nchild = "arm"\naxis = [0, 1, 0]\n'
    # A radius of gyration of 3.2 m at 0.2 m from the joint: odd, and no law of physics is against it.
    model.write_text(f'{joint}[[link]]\nname = "arm"\nmass = 1.0\ncom = [0, 0, -0.2]\ninertia = [10, 10, 0.1]\n')
    status, out, _ = run("audit", str(model))
    assert status == 1
    assert "implausible: arm" in out
    assert "hardly true" in out and "cannot be true" not in out


def test_doctor_tries_every_engine(run):
    from harness.engines import registry

    status, out, _ = run("doctor", "--json", "-")
    document = json.loads(out)
    assert {engine["name"] for engine in document["engines"]} == set(registry.names())
    assert {e["name"]: e["said"] for e in document["engines"] if e["state"] == "broken"} == {}
    assert status == 0


def test_output_that_nobody_reads_is_no_error():
    command = [sys.executable, "-m", "harness", "simulate", PENDULUM, "--engine", "mujoco", "--duration", "20"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None and process.stderr is not None
        process.stdout.readline()
        process.stdout.close()
        assert process.stderr.read() == ""
        assert process.wait() == 0


@pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGINT for a child")
def _until_it_works(pid):
    """Wait for the processes that a command hands its work to; on a busy machine it may take long to get there."""
    children = Path(f"/proc/{pid}/task/{pid}/children")
    for _ in range(600 if children.exists() else 50):
        time.sleep(0.2)
        if children.exists() and len(children.read_text().split()) >= 2:
            break
    time.sleep(2.0)


def test_ctrl_c_ends_with_one_line_and_writes_nothing(tmp_path):
    out = tmp_path / "results"
    command = [sys.executable, "-m", "harness", "validate", "--out", str(out), "--workers", "2"]
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # A shell that started these tests in the background has had SIGINT ignored, and children inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as process:
        _until_it_works(process.pid)
        os.killpg(process.pid, signal.SIGINT)
        _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    # A first use says before that it compiles.
    told = [line for line in err.splitlines() if not line.startswith("compiling")]
    assert told == ["denoc: stopped; nothing was written"]
    assert not out.exists()


ARMS = ROOT / "tests" / "compare" / "descriptions"


def test_two_descriptions_of_one_robot_are_held_against_one_another(run, tmp_path):
    both = (str(ARMS / "arm.urdf"), str(ARMS / "arm_inertia.xml"), "--engine", "pinocchio", "--workers", "1")
    file = tmp_path / "answer.json"
    status, out, _ = run("validate", *both, "--json", str(file))
    assert status == 1
    assert "inertia of fore" in out and "ixx 0.01 against 0.0105" in out and "moves elbow by" in out
    failed = [row for row in json.loads(file.read_text())["rows"] if row["verdict"] == "fail"]
    assert [(row["case"], row["quantity"], row["engines"]) for row in failed] == [
        ("arm against arm_inertia", "inertia@fore", ["arm", "arm_inertia"])
    ]
    # 0.0005 of 0.0105 is 4.8 %.
    assert run("validate", *both, "--tolerance", "0.05")[0] == 0
    assert run("validate", *both, "--separate")[0] == 0
    refused(run("validate", *both, "--tolerance", "-1"), "--tolerance")


def test_validate_warns_of_what_an_audit_would_say(run, tmp_path):
    file = tmp_path / "answer.json"
    model = str(ARMS / "arm_grams.urdf")  # the forearm's inertia is 10 for 0.01 kg·m²
    status, out, _ = run(
        "validate", model, "--engine", "pinocchio", "--workers", "1", "--json", str(file), "--out", str(tmp_path)
    )
    assert status == 0
    (doubt,) = json.loads(file.read_text())["warnings"]
    assert (doubt["case"], doubt["site"], doubt["severity"]) == ("arm_grams", "fore", "implausible")
    # √(10 / 1.2) m
    assert "radius of gyration 2.89 m" in doubt["what"]
    for text in (out, (tmp_path / "results.md").read_text(), (tmp_path / "report.html").read_text()):
        assert "Warnings" in text and "radius of gyration 2.89 m" in text
    # Rendered again, it still warns.
    assert "radius of gyration 2.89 m" in run("report", str(tmp_path))[1]
    assert "Warnings" not in run("validate", str(ARMS / "arm.urdf"), "--engine", "pinocchio", "--workers", "1")[1]


@pytest.mark.slow
def test_an_effect_of_ones_own_is_rerun_from_the_model_that_has_it(run, tmp_path):
    from scipy.integrate import solve_ivp

    from harness.engines.expressed import described
    from harness.recording import read_recording
    from harness.system import load
    from harness.system.write import write

    # A leaf spring that is soft one way; the pendulum is 0.2 kg at 0.15 m with no inertia about it.
    effect = tmp_path / "leaf.py"
    effect.write_text(
        "name = 'one_way_leaf'\n"
        "parameters = {'stiffness': {'unit': 'N*m/rad', 'lower': 0.0}, 'soft': {'unit': 'N*m/rad', 'lower': 0.0}}\n"
        "def torque(position, velocity, time, p):\n"
        "    return -p[0] * position if position > 0.0 else -p[1] * position\n"
    )
    model = tmp_path / "augmented.toml"
    model.write_text(
        "name = 'pendulum'\n"
        "[[joint]]\nname = 'pivot'\ntype = 'revolute'\nparent = 'base'\nchild = 'bob'\naxis = [0, 1, 0]\n"
        "[[link]]\nname = 'bob'\nmass = 0.2\ncom = [0, 0, -0.15]\ninertia = [0, 0, 0]\n"
        "[[effect]]\nname = 'one_way_leaf'\nsite = 'pivot'\nparameters = { stiffness = 0.3, soft = 0.05 }\n"
    )
    out = tmp_path / "run.csv"
    simulate = (
        "simulate", str(model), "--duration", "1", "--rate", "100", "--position", "pivot=0.5", "--out", str(out),
    )  # fmt: skip
    refused(run(*simulate), "one_way_leaf", "--effects FILE")
    status, _, err = run(*simulate, "--effects", str(effect))
    assert status == 0, err
    found = next(c for c in read_recording(out).channels if c.name == "pivot.position").values

    def rate(t, y):
        leaf = -(0.3 if y[0] > 0.0 else 0.05) * y[0]
        return [y[1], (leaf - 0.2 * 9.81 * 0.15 * math.sin(y[0])) / (0.2 * 0.15**2)]

    time = [0.01 * k for k in range(101)]
    expected = solve_ivp(rate, (0.0, 1.0), [0.5, 0.0], t_eval=time, rtol=1e-11, atol=1e-13, method="DOP853").y[0]
    assert abs(found - expected).max() < 1e-6
    # What URDF and MJCF can say of it is written, and the rest told.
    system = load(model)
    for name in ("augmented.urdf", "augmented.xml"):
        left_out = write(described(system), tmp_path / name)
        assert any("one_way_leaf" in line for line in left_out)
        assert load(tmp_path / name).link("bob").mass == pytest.approx(0.2)
    refused(run(*simulate, "--effects", str(effect), "--engine", "mujoco"), "mujoco", "one_way_leaf")
