"""Every number that a model file can state, read and held against the number that stands in it, or what it means by a formula."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from harness.cases.case import NATIVE, Bench, Case, Row, Series
from harness.cases.checks import Measured
from harness.cases.model_files import URDF, against_pinocchio
from harness.system import System, load

#: A value by its place: "joint 'hip' damping", "link 'rod' payload".
Stated = Mapping[str, object]


def _turn(*rpy: float) -> np.ndarray:
    """Fixed-axis roll, pitch and yaw, by SciPy."""
    return np.asarray(Rotation.from_euler("xyz", rpy).as_matrix())


def _tensor(xx: float, yy: float, zz: float, xy: float, xz: float, yz: float) -> np.ndarray:
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


URDF_FIELDS = """<robot name="stated" version="1.1">
  <link name="world"/>
  <link name="a"><inertial><origin xyz="0.1 0.2 0.3"/><mass value="2.5"/>
    <inertia ixx="0.2" iyy="0.3" izz="0.4" ixy="0.01" ixz="0.02" iyz="0.03"/></inertial></link>
  <link name="b"><inertial><mass value="1.5"/><inertia ixx="0.1" iyy="0.12" izz="0.13" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="c"><inertial><mass value="0.5"/>
    <inertia ixx="0.01" iyy="0.012" izz="0.013" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hip" type="revolute"><parent link="world"/><child link="a"/><origin xyz="1 2 3" rpy="0.1 0.2 0.3"/>
    <axis xyz="0 3 4"/><dynamics damping="0.7" friction="0.4"/><limit lower="-1" upper="2" effort="30" velocity="5"/></joint>
  <joint name="rail" type="prismatic"><parent link="a"/><child link="b"/>
    <origin xyz="0.5 0 0" quat_xyzw="0.5 0.5 0.5 0.5"/><dynamics friction="0.6"/>
    <limit lower="-0.2" upper="0.3" effort="40" velocity="6"/></joint>
  <joint name="spin" type="continuous"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
    <limit effort="7" velocity="8"/><mimic joint="hip" multiplier="-2" offset="0.25"/></joint>
</robot>
"""
URDF_STATED: Stated = {
    "joint 'hip' type": "revolute", "joint 'hip' xyz": (1, 2, 3), "joint 'hip' rotation": _turn(0.1, 0.2, 0.3),
    "joint 'hip' axis": (0, 0.6, 0.8), "joint 'hip' damping": 0.7, "joint 'hip' friction": 0.4, "joint 'hip' lower": -1,
    "joint 'hip' upper": 2, "joint 'hip' effort": 30, "joint 'hip' velocity": 5,
    "joint 'rail' type": "prismatic", "joint 'rail' axis": (1, 0, 0), "joint 'rail' friction": 0.6,
    # Half a turn by 120° about (1, 1, 1): x goes to y, y to z, z to x.
    "joint 'rail' rotation": [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
    "joint 'rail' lower": -0.2, "joint 'rail' upper": 0.3, "joint 'rail' effort": 40, "joint 'rail' velocity": 6,
    "joint 'spin' type": "continuous", "joint 'spin' lower": -math.inf, "joint 'spin' upper": math.inf,
    "joint 'spin' effort": 7, "joint 'spin' velocity": 8, "joint 'spin' mimic.joint": "hip",
    "joint 'spin' mimic.multiplier": -2, "joint 'spin' mimic.offset": 0.25,
    "link 'a' mass": 2.5, "link 'a' com": (0.1, 0.2, 0.3), "link 'a' inertia": _tensor(0.2, 0.3, 0.4, 0.01, 0.02, 0.03),
}  # fmt: skip

MJCF_FIELDS = """<mujoco model="stated">
  <compiler angle="radian" autolimits="true"/>
  <option gravity="0.1 0.2 -9"/>
  <worldbody>
    <body name="a" pos="1 2 3">
      <joint name="hip" type="hinge" axis="0 3 4" range="-1 2" damping="0.7" frictionloss="0.4" armature="0.05" stiffness="1.5"
        springref="0.2" ref="0.1" actuatorfrcrange="-12 12"/>
      <inertial pos="0.1 0.2 0.3" mass="2.5" fullinertia="0.2 0.3 0.4 0.01 0.02 0.03"/>
      <body name="b" pos="0.5 0 0">
        <joint name="rail" type="slide" axis="1 0 0" damping="0.3 0.2" stiffness="5 0 70"/>
        <inertial pos="0 0 0" mass="1.5" diaginertia="0.1 0.12 0.13"/>
        <body name="c">
          <joint name="spin" type="hinge" axis="0 0 1"/>
          <inertial pos="0 0 0" mass="0.5" diaginertia="0.01 0.012 0.013"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="drive" joint="rail" gear="3" armature="0.02" damping="0.1" forcerange="-4 5"/></actuator>
  <equality><joint joint1="spin" joint2="rail" polycoef="0.25 -2 0 0 0"/></equality>
</mujoco>
"""
MJCF_STATED: Stated = {
    "gravity": (0.1, 0.2, -9),
    "joint 'hip' type": "revolute", "joint 'hip' xyz": (1, 2, 3), "joint 'hip' axis": (0, 0.6, 0.8),
    # ref is the position at which the file's pose is drawn.
    "joint 'hip' rotation": Rotation.from_rotvec([0, -0.06, -0.08]).as_matrix(),
    "joint 'hip' damping": 0.7, "joint 'hip' friction": 0.4, "joint 'hip' armature": 0.05, "joint 'hip' stiffness": 1.5,
    "joint 'hip' rest_position": 0.2, "joint 'hip' lower": -1, "joint 'hip' upper": 2, "joint 'hip' effort": 12,
    "joint 'rail' type": "prismatic", "joint 'rail' stiffness": 5,
    # A motor's own terms act through its gear, squared.
    "joint 'rail' damping": 0.3 + 9 * 0.1, "joint 'rail' armature": 9 * 0.02,
    "actuator 'drive' lower": -12, "actuator 'drive' upper": 15, "actuator 'drive' gain": 3,
    "effect 'quadratic_drag' coefficient": 0.2, "effect 'cubic_stiffness' stiffness": 70,
    "joint 'spin' mimic.joint": "rail", "joint 'spin' mimic.multiplier": -2, "joint 'spin' mimic.offset": 0.25,
    "link 'a' mass": 2.5, "link 'a' com": (0.1, 0.2, 0.3), "link 'a' inertia": _tensor(0.2, 0.3, 0.4, 0.01, 0.02, 0.03),
}  # fmt: skip

TOML_FIELDS = """
name = "stated"
gravity = [0.1, 0.2, -9.0]
tolerance = 0.02
[[joint]]
name = "hip"
type = "revolute"
parent = "base"
child = "a"
origin = { xyz = [1, 2, 3], rpy = [0.1, 0.2, 0.3] }
axis = [0, 3, 4]
armature = 0.05
damping = 0.7
friction = 0.4
stiffness = 1.5
rest_position = 0.2
limits = { lower = -1, upper = 2, effort = 30, velocity = 5 }
[[joint]]
name = "cross"
type = "universal"
parent = "a"
child = "b"
axis = [1, 0, 0]
axis2 = [0, 0.6, 0.8]
[[joint]]
name = "screw"
type = "helical"
parent = "b"
child = "c"
axis = [0, 0, 1]
pitch = 0.003
mimic = { joint = "hip", multiplier = -2.0, offset = 0.25 }
[[joint]]
name = "root"
type = "revolute"
parent = "c"
child = "rod"
axis = [0, 1, 0]
[[joint]]
name = "end"
type = "fixed"
parent = "rod"
child = "bar"
[[link]]
name = "a"
mass = 2.5
com = [0.1, 0.2, 0.3]
inertia = [0.2, 0.3, 0.4, 0.01, 0.02, 0.03]
end = [0.4, 0.5, 0.6]
[[link]]
name = "b"
mass = 1.5
com = [0, 0, 0.1]
inertia = [0.1, 0.12, 0.13]
[[link]]
name = "c"
mass = 0.5
com = [0, 0, 0.1]
inertia = [[0.01, 0.001, 0], [0.001, 0.012, 0], [0, 0, 0.013]]
[[link]]
name = "rod"
length = 0.4
direction = [0, 0, -2]
bending = [3, 0, 0]
bending2 = true
section = { width = 0.025, thickness = 0.002 }
material = { youngs_modulus = 2.0e11, density = 7850.0, damping = 3.0e-4, poissons_ratio = 0.3 }
modes = 3
torsion_modes = 2
modal_damping = [0.005, 0.006]
geometric_stiffening = false
payload = 0.07
payload_inertia = [3e-5, 2e-5, 1e-5]
[[link]]
name = "bar"
length = 0.3
direction = [0, 1, 0]
bending = [0, 0, 1]
section = { area = 5e-5, second_moment = 6e-12, half_depth = 7e-4 }
material = { youngs_modulus = 7.0e10 }
mass = 0.04
modes = 1
[[effect]]
name = "quadratic_drag"
site = "hip"
parameters = { coefficient = 0.2 }
"""
TOML_LOOP = """
name = "closed"
[[joint]]
name = "one"
type = "revolute"
parent = "base"
child = "a"
axis = [0, 1, 0]
[[joint]]
name = "two"
type = "revolute"
parent = "base"
child = "b"
axis = [0, 1, 0]
[[joint]]
name = "three"
type = "prismatic"
parent = "b"
child = "c"
axis = [0, 1, 0]
[[link]]
name = "a"
mass = 1.0
inertia = [0.1, 0.1, 0.1]
[[link]]
name = "b"
mass = 1.0
inertia = [0.1, 0.1, 0.1]
[[link]]
name = "c"
mass = 1.0
[[loop]]
name = "cut"
first = { link = "a", xyz = [0.1, 0, 0.05], rpy = [0.3, 0, 0] }
second = { link = "b", xyz = [0.12, 0.2, 0] }
closed = ["x"]
[[coupling]]
name = "gear"
joint = "two"
leader = "one"
polynomial = [0.1, 2.0, 0.3]
"""
TOML_LOOP_STATED: Stated = {
    "loop 'cut' first.link": "a", "loop 'cut' first.xyz": (0.1, 0, 0.05), "loop 'cut' first.rotation": _turn(0.3, 0, 0),
    "loop 'cut' second.link": "b", "loop 'cut' second.xyz": (0.12, 0.2, 0), "loop 'cut' conditions": ("x",),
    "loop 'gear' joint": "two", "loop 'gear' leader": "one", "loop 'gear' coefficients": (0.1, 2, 0.3, 0, 0),
}  # fmt: skip
_E, _W, _T, _L = 2.0e11, 0.025, 0.002, 0.4
TOML_STATED: Stated = {
    "gravity": (0.1, 0.2, -9), "tolerance": 0.02,
    "joint 'hip' type": "revolute", "joint 'hip' xyz": (1, 2, 3), "joint 'hip' rotation": _turn(0.1, 0.2, 0.3),
    "joint 'hip' axis": (0, 0.6, 0.8), "joint 'hip' damping": 0.7, "joint 'hip' friction": 0.4, "joint 'hip' armature": 0.05,
    "joint 'hip' stiffness": 1.5, "joint 'hip' rest_position": 0.2, "joint 'hip' lower": -1, "joint 'hip' upper": 2,
    "joint 'hip' effort": 30, "joint 'hip' velocity": 5,
    "joint 'cross' type": "universal", "joint 'cross' axis2": (0, 0.6, 0.8), "joint 'screw' pitch": 0.003,
    "joint 'screw' mimic.joint": "hip", "joint 'screw' mimic.multiplier": -2, "joint 'screw' mimic.offset": 0.25,
    "link 'a' mass": 2.5, "link 'a' com": (0.1, 0.2, 0.3), "link 'a' inertia": _tensor(0.2, 0.3, 0.4, 0.01, 0.02, 0.03),
    "link 'a' end": (0.4, 0.5, 0.6), "link 'b' inertia": np.diag([0.1, 0.12, 0.13]),
    "link 'c' inertia": _tensor(0.01, 0.012, 0.013, 0.001, 0, 0),
    "beam 'rod' length": _L, "beam 'rod' direction": (0, 0, -1), "beam 'rod' bending": (1, 0, 0), "beam 'rod' bending2": True,
    "beam 'rod' mass": 7850.0 * _W * _T * _L, "beam 'rod' bending_stiffness": _E * _W * _T**3 / 12,
    "beam 'rod' bending_stiffness2": _E * _T * _W**3 / 12,
    "beam 'rod' polar_inertia": 7850.0 * _W * _T * (_W**2 + _T**2) / 12,
    "beam 'rod' material_damping": 3e-4, "beam 'rod' modes": 3, "beam 'rod' torsion_modes": 2,
    "beam 'rod' modal_damping": (0.005, 0.006), "beam 'rod' geometric_stiffening": False, "beam 'rod' payload": 0.07,
    "beam 'rod' payload_inertia": np.diag([3e-5, 2e-5, 1e-5]), "beam 'rod' half_depth": _T / 2,
    "beam 'bar' mass": 0.04, "beam 'bar' bending_stiffness": 7e10 * 6e-12, "beam 'bar' half_depth": 7e-4,
    "beam 'bar' geometric_stiffening": True, "beam 'bar' payload": 0, "beam 'bar' modes": 1,
    "effect 'quadratic_drag' coefficient": 0.2,
}  # fmt: skip


def torsion_constant(width: float, thickness: float) -> float:
    """Of a rectangle, by the series of S. Timoshenko and J. Goodier, Theory of Elasticity (1970), § 109."""
    odd = np.arange(1, 99, 2)
    total = (np.tanh(odd * math.pi * width / (2 * thickness)) / odd**5).sum()
    return width * thickness**3 / 3 * (1 - 192 / math.pi**5 * thickness / width * float(total))


def _general_toml() -> str:
    """The mechanism of the general URDF, inertias turned into the links' axes by SciPy."""
    inertias = {
        "one": (1.3, (0.1, 0.02, -0.03), (0.3, -0.4, 0.5), (0.021, 0.033, 0.027, 0.002, -0.003, 0.001)),
        "two": (0.7, (-0.05, 0.07, 0.11), (-0.2, 0.6, 1.1), (0.011, 0.009, 0.014, -0.001, 0.002, 0.0015)),
        "plate": (0.4, (0.01, 0.02, 0.03), (0.7, 0.1, -0.3), (0.004, 0.005, 0.006, 0.0003, 0.0002, -0.0004)),
        "three": (0.5, (0.02, -0.03, 0.08), (1.2, -0.7, 0.4), (0.005, 0.007, 0.004, 0.0005, 0.0006, 0.0002)),
    }
    joints = (
        ("first", "revolute", "world", "one", (0.1, -0.2, 0.3), (0.4, -0.9, 1.3), (0.6, 0, 0.8), 0.13, (-1.1, 2.2)),
        ("second", "prismatic", "one", "two", (-0.3, 0.1, 0.2), (-1.0, 0.3, 0.8), (0, -0.28, 0.96), 0.21, (-0.4, 0.5)),
        ("weld", "fixed", "two", "plate", (0.05, 0.06, -0.07), (0.9, 0.8, -0.6), (0, 0, 1), 0.0, None),
        (
            "third",
            "revolute",
            "plate",
            "three",
            (0.2, 0.3, -0.1),
            (2.0, -1.1, 0.5),
            (-0.36, 0.48, 0.8),
            0.07,
            (-0.7, 1.9),
        ),
    )
    lines = ['name = "general"', 'base = "world"']
    for name, kind, parent, child, xyz, rpy, axis, damping, limits in joints:
        lines += ["[[joint]]", f'name = "{name}"', f'type = "{kind}"', f'parent = "{parent}"', f'child = "{child}"']
        lines += [
            f"origin = {{ xyz = {list(xyz)}, rpy = {list(rpy)} }}",
            f"axis = {list(axis)}",
            f"damping = {damping}",
        ]
        if limits is not None:
            lines.append(f"limits = {{ lower = {limits[0]}, upper = {limits[1]} }}")
    for name, (mass, com, rpy, six) in inertias.items():
        tensor = _turn(*rpy) @ _tensor(*six) @ _turn(*rpy).T
        lines += [
            "[[link]]",
            f'name = "{name}"',
            f"mass = {mass}",
            f"com = {list(com)}",
            f"inertia = {tensor.tolist()}",
        ]
    return "\n".join(lines) + "\n"


def _loaded(text: str, ending: str) -> System:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"model.{ending}"
        path.write_text(text, encoding="utf-8")
        return load(path)


def _found(system: System, place: str) -> object:
    """What the description has at a place."""
    kind, _, rest = place.partition(" ")
    if not rest:
        return getattr(system, kind)
    name, key = rest.split("' ", 1)
    name = name.lstrip("'")
    owner: object
    if kind == "joint":
        owner = system.joint(name)
    elif kind == "beam":
        owner = system.link(name).beam
    elif kind == "link":
        owner = system.link(name)
    elif kind == "effect":
        effects = [one.parameters[key] for one in system.attachments if one.effect == name]
        return effects[0] if effects else None
    else:
        several = {"loop": system.loops, "actuator": system.actuators}[kind]
        owner = next((one for one in several if one.name == name), None)
    for part in key.split("."):
        owner = getattr(owner, part, None)
    return owner


def _apart(found: object, stated: object) -> float:
    """Relative, of the largest number; infinite where words differ or something is missing."""
    if isinstance(stated, str | bool) or (isinstance(stated, tuple) and stated and isinstance(stated[0], str)):
        return 0.0 if found == stated or str(found) == str(stated) else math.inf
    if found is None:
        return math.inf
    a, b = np.asarray(found, dtype=np.float64), np.asarray(stated, dtype=np.float64)
    if a.shape != b.shape:
        return math.inf
    other = a != b  # infinities are equal, and have no difference
    if not np.isfinite(a[other]).all() or not np.isfinite(b[other]).all():
        return math.inf
    size = float(np.abs(b[np.isfinite(b)]).max(initial=0.0))
    return float(np.abs(a[other] - b[other]).max(initial=0.0)) / (size or 1.0)


def _place(system: System, stated: str) -> dict[str, object]:
    """Whose number it is, and which: ``{"joint": "hip", "value": "damping"}``; of the mechanism itself the number alone."""
    kind, _, rest = stated.partition(" '")
    if not rest:
        return {"value": kind}
    name, _, member = rest.partition("' ")
    if kind == "effect":
        sites = [one.site for one in system.attachments if one.effect == name]
        place: dict[str, object] = {"term": name, "value": member}
        return place | ({"joint": sites[0]} if sites else {})
    # Numbers of a beam are its link's.
    return {"link" if kind == "beam" else kind: name, "value": member}


def fields(stated: Stated, bench: Bench) -> Iterable[Row | Series]:
    """Every number stated, against the description."""
    apart = {place: _apart(_found(bench.system, place), value) for place, value in stated.items()}
    wrong = {place: far for place, far in apart.items() if not far <= 1e-12}
    worst = max(apart.values())
    said = "; ".join(f"{place}: {_found(bench.system, place)} for {stated[place]}" for place in list(wrong)[:4])
    first = next(iter(wrong), None)
    yield bench.row(
        "file_fields",
        (NATIVE, "analytic"),
        min(worst, 1e300),
        1e-12,
        why="numbers as they stand in the file",
        note=f"the readers take the file to mean different things: {said}" if wrong else f"{len(apart)} numbers",
        first_divergence=None if first is None else _place(bench.system, first),
        source="the numbers that stand in the file, read by a person",
    )


def torsion(bench: Bench) -> Iterable[Row | Series]:
    """The rod's torsional stiffness against the exact series."""
    beam = bench.system.link("rod").beam
    assert beam is not None
    true = _E / (2 * 1.3) * torsion_constant(_W, _T)
    yield bench.row(
        "file_torsion",
        (NATIVE, "analytic"),
        abs(beam.torsional_stiffness - true) / true,
        5e-3,
        why="Roark's formula for a rectangle is certain to 0.5 %",
        about={"link": "rod", "value": "torsional_stiffness"},
        source="S. Timoshenko and J. Goodier, Theory of Elasticity (1970), § 109",
    )


def _case(name: str, title: str, build: Callable[[], System], *checks: Measured, engines: tuple[str, ...] = ()) -> Case:
    source = "the numbers that stand in the file, read by a person"
    return Case(name=name, title=title, source=source, system=build, checks=checks, group="rigid", engines=engines)


CASES = (
    _case(
        "file_urdf_fields", "Every number a URDF states", partial(_loaded, URDF_FIELDS, "urdf"),
        Measured("file_fields", partial(fields, URDF_STATED)),
    ),
    _case(
        "file_mjcf_fields", "Every number an MJCF states of joints, motors and links", partial(_loaded, MJCF_FIELDS, "xml"),
        Measured("file_fields", partial(fields, MJCF_STATED)),
    ),
    _case(
        "file_toml_fields", "Every number a TOML file states", partial(_loaded, TOML_FIELDS, "toml"),
        Measured("file_fields", partial(fields, TOML_STATED)), Measured("file_torsion", torsion),
    ),
    _case(
        "file_toml_loop", "Loops and couplings as a TOML file states them", partial(_loaded, TOML_LOOP, "toml"),
        Measured("file_fields", partial(fields, TOML_LOOP_STATED)),
    ),
    _case(
        "file_toml_general", "The general URDF's mechanism in TOML, against Pinocchio reading the URDF",
        lambda: _loaded(_general_toml(), "toml"), Measured("file_by_pinocchio", partial(against_pinocchio, URDF, None)),
        engines=(NATIVE, "pinocchio"),
    ),
)  # fmt: skip
