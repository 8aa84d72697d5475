"""Model files as our readers take them, against MuJoCo and Pinocchio reading the very same files by themselves."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from harness.cases.beams import closed_form
from harness.cases.case import NATIVE, Array, Bench, Case, Row, Series
from harness.cases.checks import Measured
from harness.cases.checks.as_read import AsRead
from harness.cases.checks.beam_blame import afloat, by_frequencies
from harness.cases.flexible_pendulum import pinned_with_hub
from harness.cases.users import state_checks
from harness.compare import quantities
from harness.compare.readings import differences, field_differences, fields_of, phrase
from harness.denoc import Denoc
from harness.engines.readers import Reading, placed_bodies, read_by
from harness.errors import UnsupportedError
from harness.system import System, load

SHIPPED = Path(__file__).parents[2] / "models"
STATES = 5
MANY = 12  # coordinates, by which accelerations of floating mechanisms are judged
FLOATING = (
    "acrobat", "biped", "buoy", "flying_arm", "gripper_in_flight", "quadruped", "rope", "satellite", "thrown_box", "two_bodies",
)  # fmt: skip
ALLOWED = 1e-11
WHY = "the same file read twice: rounding of double precision, conversions of rotations included"

# General rotations in every place that has some, and numbers that are all different.
URDF = """<robot name="general">
  <link name="world"/>
  <link name="one"><inertial><origin xyz="0.1 0.02 -0.03" rpy="0.3 -0.4 0.5"/><mass value="1.3"/>
    <inertia ixx="0.021" iyy="0.033" izz="0.027" ixy="0.002" ixz="-0.003" iyz="0.001"/></inertial></link>
  <link name="two"><inertial><origin xyz="-0.05 0.07 0.11" rpy="-0.2 0.6 1.1"/><mass value="0.7"/>
    <inertia ixx="0.011" iyy="0.009" izz="0.014" ixy="-0.001" ixz="0.002" iyz="0.0015"/></inertial></link>
  <link name="plate"><inertial><origin xyz="0.01 0.02 0.03" rpy="0.7 0.1 -0.3"/><mass value="0.4"/>
    <inertia ixx="0.004" iyy="0.005" izz="0.006" ixy="0.0003" ixz="0.0002" iyz="-0.0004"/></inertial></link>
  <link name="three"><inertial><origin xyz="0.02 -0.03 0.08" rpy="1.2 -0.7 0.4"/><mass value="0.5"/>
    <inertia ixx="0.005" iyy="0.007" izz="0.004" ixy="0.0005" ixz="0.0006" iyz="0.0002"/></inertial></link>
  <joint name="first" type="revolute"><parent link="world"/><child link="one"/><origin xyz="0.1 -0.2 0.3" rpy="0.4 -0.9 1.3"/>
    <axis xyz="0.6 0 0.8"/><limit lower="-1.1" upper="2.2" effort="30" velocity="4"/>
    <dynamics damping="0.13" friction="0"/></joint>
  <joint name="second" type="prismatic"><parent link="one"/><child link="two"/><origin xyz="-0.3 0.1 0.2" rpy="-1.0 0.3 0.8"/>
    <axis xyz="0 -0.28 0.96"/><limit lower="-0.4" upper="0.5" effort="20" velocity="2"/>
    <dynamics damping="0.21" friction="0"/></joint>
  <joint name="weld" type="fixed"><parent link="two"/><child link="plate"/>
    <origin xyz="0.05 0.06 -0.07" rpy="0.9 0.8 -0.6"/></joint>
  <joint name="third" type="revolute"><parent link="plate"/><child link="three"/><origin xyz="0.2 0.3 -0.1" rpy="2.0 -1.1 0.5"/>
    <axis xyz="-0.36 0.48 0.8"/><limit lower="-0.7" upper="1.9" effort="10" velocity="3"/>
    <dynamics damping="0.07" friction="0"/></joint>
</robot>
"""
MJCF = """<mujoco model="general">
  <compiler angle="degree" eulerseq="zyx" autolimits="true"/>
  <default><joint damping="0.11"/><default class="geared"><joint armature="0.013" damping="0.19"/></default></default>
  <option gravity="0.3 -0.4 -9.7"/>
  <worldbody>
    <body name="one" pos="0.1 -0.2 0.3" euler="25 -40 70">
      <joint name="first" type="hinge" axis="0.6 0 0.8" pos="0.02 0.03 -0.01" range="-60 110"/>
      <inertial pos="0.1 0.02 -0.03" mass="1.3" fullinertia="0.021 0.033 0.027 0.002 -0.003 0.001"/>
      <body name="two" pos="-0.3 0.1 0.2" quat="0.6 0.3 -0.2 0.7">
        <joint name="second" type="slide" axis="0 -0.28 0.96" range="-0.4 0.5" stiffness="3.1" springref="0.2"/>
        <inertial pos="-0.05 0.07 0.11" quat="0.8 -0.2 0.4 0.1" mass="0.7" diaginertia="0.011 0.009 0.014"/>
        <body name="plate" pos="0.05 0.06 -0.07" xyaxes="0.8 0.6 0 -0.6 0.8 0">
          <inertial pos="0.01 0.02 0.03" mass="0.4" diaginertia="0.004 0.005 0.006"/>
          <body name="three" pos="0.2 0.3 -0.1" axisangle="0.36 0.48 0.8 50">
            <joint name="third" class="geared" type="hinge" axis="-0.36 0.48 0.8" pos="0.04 -0.03 0.02"
              range="-40 109" stiffness="0.9"/>
            <inertial pos="0.02 -0.03 0.08" mass="0.5" diaginertia="0.005 0.007 0.004"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def _shipped(file: str) -> System:
    path = SHIPPED / file
    if not path.exists():
        raise UnsupportedError("the folder models/ is not here", mend="run in a checkout of the repository")
    return load(path)


def _written(text: str) -> System:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.xml"
        path.write_text(text, encoding="utf-8")
        return load(path)


def _states(system: System, rng: np.random.Generator) -> tuple[Array, Array]:
    n = len(system.joint_names)
    return rng.uniform(-0.4, 0.4, (STATES, n)), rng.standard_normal((STATES, n))


def _mujoco(text: str | None, path: Path | None, bench: Bench) -> Iterable[Row | Series]:
    """Mass matrix, bias, passive forces and limits by MuJoCo's own reading."""
    if "mujoco" not in bench.models:
        return
    import mujoco

    model: Any = mujoco.MjModel.from_xml_string(text) if text is not None else mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    native = Denoc(bench.system)
    names = bench.system.joint_names
    places = [int(model.joint(name).dofadr[0]) for name in names]
    ours: dict[str, list[Array]] = {"mass_matrix": [], "bias": [], "passive": []}
    theirs: dict[str, list[Array]] = {"mass_matrix": [], "bias": [], "passive": []}
    for q, qd in zip(*_states(bench.system, bench.rng()), strict=True):
        data.qpos[places], data.qvel[places] = q, qd
        mujoco.mj_forward(model, data)
        full = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        theirs["mass_matrix"].append(full[np.ix_(places, places)])
        theirs["bias"].append(data.qfrc_bias[places].copy())
        theirs["passive"].append(data.qfrc_passive[places].copy())
        ours["mass_matrix"].append(native.mass_matrix(q))
        ours["bias"].append(native.bias(q, qd))
        ours["passive"].append(native.passive(q, qd))
    for quantity, values in ours.items():
        apart = float(quantities.relative(np.array(values), np.array(theirs[quantity])).max())
        yield _row(bench, quantity, "mujoco", apart, text, path)
    found = np.array([[joint.lower, joint.upper] for joint in bench.system.movable_joints])
    stated = np.array([model.joint(name).range for name in names])
    limited = np.array([bool(model.jnt_limited[model.joint(name).id]) for name in names])
    stated[~limited] = (-np.inf, np.inf)
    other = found != stated  # infinities are equal, and have no difference
    apart = float(np.abs(found[other] - stated[other]).max(initial=0.0))
    yield _row(bench, "limits", "mujoco", apart, text, path)


def against_pinocchio(text: str | None, path: Path | None, bench: Bench) -> Iterable[Row | Series]:
    """Mass matrix, bias and limits by Pinocchio's own reading of URDF."""
    if "pinocchio" not in bench.models:
        return
    import pinocchio as pin

    model = pin.buildModelFromXML(text) if text is not None else pin.buildModelFromUrdf(str(path))
    model.gravity.linear = np.array(bench.system.gravity)
    data = pin.Data(model)
    native = Denoc(bench.system)
    names = bench.system.joint_names
    ours: tuple[list[Array], list[Array]] = ([], [])
    theirs: tuple[list[Array], list[Array]] = ([], [])
    where = [model.joints[model.getJointId(name)].idx_v for name in names]
    for q, qd in zip(*_states(bench.system, bench.rng()), strict=True):
        theirs_q, theirs_v = np.zeros(model.nq), np.zeros(model.nv)
        for name, angle, rate in zip(names, q, qd, strict=True):
            joint = model.joints[model.getJointId(name)]
            # Pinocchio takes cosine and sine of a joint without limits.
            theirs_q[joint.idx_q : joint.idx_q + joint.nq] = (
                [angle] if joint.nq == 1 else [np.cos(angle), np.sin(angle)]
            )
            theirs_v[joint.idx_v] = rate
        mass = pin.crba(model, data, theirs_q)
        theirs[0].append(mass[np.ix_(where, where)])
        theirs[1].append(pin.nonLinearEffects(model, data, theirs_q, theirs_v)[where])
        ours[0].append(native.mass_matrix(q))
        ours[1].append(native.bias(q, qd))
    for quantity, a, b in zip(("mass_matrix", "bias"), ours, theirs, strict=True):
        apart = float(quantities.relative(np.array(a), np.array(b)).max())
        yield _row(bench, quantity, "pinocchio", apart, text, path)
    apart = 0.0
    for joint in bench.system.movable_joints:
        there = model.joints[model.getJointId(joint.name)]
        if there.nq == 1:
            stated = (model.lowerPositionLimit[there.idx_q], model.upperPositionLimit[there.idx_q])
            apart = max(apart, abs(joint.lower - stated[0]), abs(joint.upper - stated[1]))
    yield _row(bench, "limits", "pinocchio", apart, text, path)


def _row(bench: Bench, quantity: str, engine: str, apart: float, text: str | None, path: Path | None) -> Row:
    """A row; where it fails, with the joint or body that the engine reads otherwise. text or path: of the file."""
    note = ""
    place: dict[str, object] | None = None
    if not apart <= ALLOWED:
        reading = _read(engine, text, path, bench.system)
        found = (
            *differences(placed_bodies(bench.system), reading.placed()),
            *field_differences(fields_of(bench.system), reading.fields())[1],
        )
        if found:
            note = f"the readers take the file to mean different things: {phrase(found)}"
            place = found[0].place
        else:
            note = f"the readers agree on every field, so it is the answer to {quantity.replace('_', ' ')}"
            place = {"term": quantity}
    return bench.row(f"file_{quantity}", (NATIVE, engine), apart, ALLOWED, why=WHY, first_divergence=place, note=note)


def _read(engine: str, text: str | None, path: Path | None, system: System) -> Reading:
    """The file as the engine's own reader has it."""
    with tempfile.TemporaryDirectory() as folder:
        if path is None:
            path = Path(folder) / "model.xml"
            path.write_text(text or "", encoding="utf-8")
        return read_by(engine, path, system)


def _strip(bench: Bench) -> Iterable[Row | Series]:
    """The strip of the TOML file, by the closed form of what the file says."""
    link = bench.system.links[0]
    beam = link.beam
    assert beam is not None
    # The file's own numbers, written here once more: 0.30 m, 25 x 1 mm, 200 GPa, 0.060 kg, hub 2e-5 kg·m².
    stiffness, mass, length = 2.0e11 * 0.025 * 0.001**3 / 12.0, 0.060, 0.30
    told = replace(link, beam=replace(beam, bending_stiffness=stiffness, mass=mass, length=length))
    true = np.array([closed_form(root, told) for root in pinned_with_hub(2e-5 / (mass * length**2), 2)])
    weightless = afloat(bench.system)
    found = Denoc(weightless).frequencies()[-2:]
    errors = np.abs(found - true) / true
    worst = int(np.argmax(errors))
    note = ", ".join(f"{f:.6g} Hz" for f in found)
    place: dict[str, object] | None = None
    if not errors[worst] <= 1e-6:
        said, place = by_frequencies(weightless, NATIVE, true, dict(enumerate(found / true)), mode=worst)
        note = f"{note}; {said}"
    yield bench.row(
        "file_frequency",
        (NATIVE, "analytic"),
        float(errors[worst]),
        1e-6,
        why="exact shapes; central differences in the linearization",
        note=note,
        first_divergence=place,
        about={"link": link.name},
        source="cos z sinh z − sin z cosh z = h z³ (1 + cos z cosh z)",
    )


def _surface(bench: Bench) -> Iterable[Row | Series]:
    """Half the thickness that the TOML file states, where a gauge would sit."""
    beam = bench.system.links[0].beam
    assert beam is not None
    apart = abs(beam.half_depth - 0.0005) / 0.0005  # 1 mm thick
    yield bench.row(
        "file_half_depth",
        (NATIVE, "analytic"),
        apart,
        1e-12,
        why="one division",
        note="" if apart <= 1e-12 else "the reader of TOML takes the surface of a strip to be elsewhere",
        about={"link": bench.system.links[0].name, "value": "half_depth"},
        source="a rectangle's surface is half its thickness from its middle",
    )


def _case(name: str, title: str, build: Any, *checks: Measured) -> Case:
    return Case(
        name=name,
        title=title,
        source="MuJoCo's and Pinocchio's own readers of the same file",
        system=build,
        checks=checks,
        group="rigid",
        engines=(NATIVE, "mujoco", "pinocchio"),
    )


def _read_again(name: str, title: str, file: str) -> Case:
    """A floating mechanism, handed on to every engine, and read once more by those that have a reader."""
    return Case(
        name=name,
        title=title,
        source="MuJoCo's and Pinocchio's own readers of the same file",
        system=partial(_shipped, file),
        checks=(*state_checks(MANY), AsRead(SHIPPED / file)),
        group="rigid",
        engines=(NATIVE, "mujoco", "pinocchio"),
    )


def _both(text: str | None, path: Path | None) -> tuple[Measured, ...]:
    return (
        Measured("file_by_mujoco", partial(_mujoco, text, path)),
        Measured("file_by_pinocchio", partial(against_pinocchio, text, path)),
    )


CASES = (
    _case("file_urdf_general", "A URDF with general rotations in every place", partial(_written, URDF), *_both(URDF, None)),
    _case(
        "file_mjcf_general",
        "An MJCF with every way to state a rotation, defaults, springs and armature",
        partial(_written, MJCF),
        Measured("file_by_mujoco", partial(_mujoco, MJCF, None)),
    ),
    *(
        _case(
            f"file_urdf_{name}", f"models/urdf/{name}.urdf", partial(_shipped, f"urdf/{name}.urdf"),
            *_both(None, SHIPPED / "urdf" / f"{name}.urdf"),
        )
        for name in ("cart_pendulum", "double_pendulum", "rigid_pendulum", "triple_pendulum")
    ),
    *(
        _case(
            f"file_mjcf_{name}", f"models/mjcf/{name}.xml", partial(_shipped, f"mjcf/{name}.xml"),
            Measured("file_by_mujoco", partial(_mujoco, None, SHIPPED / "mjcf" / f"{name}.xml")),
        )
        for name in ("cart_pendulum", "double_pendulum", "rigid_pendulum", "triple_pendulum")
    ),
    *(
        _read_again(f"file_floating_{name}", f"models/mjcf/floating/{name}.xml", f"mjcf/floating/{name}.xml")
        for name in FLOATING
    ),
    Case(
        name="file_toml_flexible_pendulum",
        title="models/toml/flexible_pendulum.toml",
        source="the numbers of the file in the closed form of a strip pinned with hub inertia",
        system=partial(_shipped, "toml/flexible_pendulum.toml"),
        checks=(Measured("file_frequency", _strip), Measured("file_half_depth", _surface)),
        group="flexible",
        engines=(NATIVE,),
    ),
)  # fmt: skip
