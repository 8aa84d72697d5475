"""Systems from MJCF, read by MuJoCo itself so that defaults, classes, fromto and the compiler mean what they mean there.

Conventions, MuJoCo to ours:

- A joint at ``pos`` p in body b becomes a joint frame at p, axes of the body; the link frame follows the joint, so the
  body frame lies at -p in it.
- Several joints of one body become a chain of massless links ``<body>__<joint>``; the last carries the body.
- A joint position is MuJoCo's ``qpos``: ``ref`` is kept as a turn (shift) by -ref at our zero.
- A free joint hangs on ``world`` at its origin, so that its positions are MuJoCo's too: those of its body as the file places it
  are in the keyframe ``qpos0``. Quaternions, and velocities of free and ball joints, are MuJoCo's.
- A joint equality whose polynomial is linear makes its first joint follow the second; others, and what is connected or welded, are
  loops.
- A body without joints becomes a link on a fixed joint; ``world`` is the base.
"""

from __future__ import annotations

import contextlib
import re
import threading
import warnings as python_warnings
from collections.abc import Container, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import InputError
from harness.system.check import check_bodies, check_dynamics, check_joints, check_loops
from harness.system.description import Array, Attachment, Joint, JointType, Keyframe, Link, System, constant
from harness.system.mjcf_actuators import actuators, reflected
from harness.system.mjcf_equalities import mimics
from harness.system.mjcf_files import Places, places, take_out_shapes, unique
from harness.system.mjcf_keyframes import unusable, written
from harness.system.mjcf_left_out import compensation, disabled, left_out, rubs, uniform_compensation
from harness.system.mjcf_limits import act, ends, margins, stops
from harness.system.mjcf_loops import loops
from harness.system.mjcf_trial import GROWING, try_apart
from harness.system.names import check_names
from harness.system.rotation import about_axis, from_quaternion
from harness.system.soft_constraints import as_soft_as_by_default
from harness.system.topology import arrange
from harness.system.xml_source import parse_xml, without_foreign_comments

BASE = "world"
_warning_handler = threading.Lock()


def read_mjcf(
    data: bytes,
    root: Any,
    source: Path | None = None,
    *,
    tolerance: float | None = None,
    physical: bool = True,
    allow: Sequence[Path] = (),
) -> System:
    """A system from an MJCF document.

    data, root: the document and its parsed root element. source: its file, which includes and meshes are relative to.
    allow: folders beside the model's own that files may be read from.
    Actuators are kept apart, for single runs. What MuJoCo would let act and a system does not hold (tendons, equalities, contacts,
    fluid, higher damping and stiffness) becomes a line in ``System.notes``.
    Raises InputError with MuJoCo's own message.
    """
    spec, model, meaningless, notes = _loaded(data, root, source, allow)
    names = names_of_joints(model)
    drives, told_drives = actuators(model, names)
    following, followed = mimics(model, names)
    own: list[str] = []
    joints, links, effects, body_in_link = _tree(model, own)
    lines = _lines(spec) if root.find(".//include") is None else {}
    closed, said, told_loops = loops(model, _body_names(model), body_in_link, names, following, followed, lines, source)
    notes += [*left_out(model, followed | said | set(closed)), *told_drives, *own, *margins(model, names), *told_loops]
    notes += [f"keyframe {_key_name(model, i)!r} left out: {why}" for i, why in meaningless.items()]
    joints = [replace(joint, mimic=following.get(joint.name)) for joint in joints]
    ordered_joints, ordered_links = arrange(joints, links, BASE, source=source, lines=lines)
    notes += check_joints(ordered_joints, physical=physical, source=source, lines=lines)
    ordered_links, told = check_bodies(ordered_links, physical=physical, source=source, lines=lines)
    notes += told
    weightless = disabled(model, "GRAVITY")
    system = System(
        name=root.get("model") or (source.stem if source is not None else "model"),
        joints=ordered_joints,
        links=ordered_links,
        base=BASE,
        gravity=constant(np.zeros(3) if weightless else (1.0 - uniform_compensation(model)) * model.opt.gravity),
        tolerance=0.01 if tolerance is None else tolerance,
        attachments=tuple(effects),
        actuators=drives,
        limits=stops(model, names),
        limits_act=act(model),
        keyframes=_keyframes(model, names, meaningless),
        source=source,
        notes=tuple(notes),
        loops=tuple(closed.values()),
    )
    check_names(system, lines)
    system = replace(system, notes=(*system.notes, *check_loops(system, lines)))
    check_dynamics(system, lines=lines)
    return system


def _loaded(
    data: bytes, root: Any, source: Path | None, allow: Sequence[Path]
) -> tuple[Any, Any, dict[int, str], list[str]]:
    """Specification, compiled model, keyframes that say nothing, and what is to be told; tried apart first where it can grow."""
    known = places(root, source, allow)
    if known.elements & GROWING:
        try_apart(data, source, allow)
    return _compile(data, root, source, known)


def load(data: bytes, source: Path | None, allow: Sequence[Path] = ()) -> Any:
    """A document as MuJoCo compiles it here and now; InputError with its message where it refuses it."""
    root = parse_xml(data, source)
    return _compile(data, root, source, places(root, source, allow))[1]


def _compile(data: bytes, root: Any, source: Path | None, known: Places) -> tuple[Any, Any, dict[int, str], list[str]]:
    import mujoco

    by_path = source is not None and (source.suffix.lower() == ".xml" or root.tag == "robot")
    if not by_path and root.find(".//include") is not None:
        raise InputError("has includes but does not end in .xml", mend="rename it to .xml", source=source)
    with _collected_warnings(mujoco) as warnings:
        try:
            if by_path:
                spec = mujoco.MjSpec.from_file(str(source))
            else:
                spec = mujoco.MjSpec.from_string(without_foreign_comments(data).decode("utf-8-sig"))
                spec.modelfiledir = str((source or Path.cwd() / "model").parent)
            notes = take_out_shapes(mujoco, spec, known, source)
            keyframes = written(spec)
            model = spec.compile()
        except UnicodeDecodeError:
            raise InputError("is not UTF-8 text", mend="save it as UTF-8", source=source) from None
        except InputError:
            raise
        except (ValueError, RuntimeError) as error:
            message = " ".join(str(error).split())
            line = re.search(r"line (\d+)", message)
            message = re.sub(r",? ?line \d+|\bElement name ''|, id \d+|\b(XML )?Error: ", "", message)
            message = re.sub(r" Element (name )?('[^']+')", r" (\2)", message).strip(" ,")
            raise InputError(
                f"MuJoCo refuses it: {message}",
                mend="mend the model so that MuJoCo loads it",
                source=source,
                line=int(line[1]) if line else None,
            ) from None
    told = [*(f"MuJoCo warns: {' '.join(text.split())}" for text in dict.fromkeys(warnings)), *notes]
    return spec, model, unusable(keyframes, model), told


@contextlib.contextmanager
def _collected_warnings(mujoco: Any) -> Iterator[list[str]]:
    """Warnings of MuJoCo as a list, instead of a log file in the working directory and lines of Python's."""
    warnings: list[str] = []
    with _warning_handler, python_warnings.catch_warnings(record=True) as raised:
        python_warnings.simplefilter("always")
        before = mujoco.get_mju_user_warning()
        mujoco.set_mju_user_warning(warnings.append)
        try:
            yield warnings
        finally:
            mujoco.set_mju_user_warning(before)
            warnings += [str(warning.message) for warning in raised]


def _line(element: Any) -> int | None:
    found = re.search(r"line (\d+)", element.info or "")
    return int(found[1]) if found else None


def _lines(spec: Any) -> dict[tuple[str, str], int]:
    lines = {}
    for kind, elements in (("link", spec.bodies), ("joint", spec.joints), ("loop", spec.equalities)):
        for element in elements:
            line = _line(element)
            if element.name and line is not None:
                lines[(kind, element.name)] = line
    return lines


def compiled(path: Path, *, allow: Sequence[Path] = ()) -> Any:
    """A URDF or MJCF file as MuJoCo reads it by itself, compiled; InputError with its message where it refuses the file."""
    data = path.read_bytes()
    root = parse_xml(data, path)
    return _loaded(data, root, path, allow)[1]


def names_of_joints(model: Any) -> list[str]:
    """Names of a compiled model's joints in MuJoCo's order; one without a name gets one that nobody has."""
    return _joint_names(model, _body_names(model))


def _body_names(model: Any) -> list[str]:
    """Names of the bodies in MuJoCo's order; one without a name gets one that nobody has."""
    stated = {model.body(b).name for b in range(model.nbody)}
    names = [model.body(b).name or unique(f"body{b}", stated) for b in range(model.nbody)]
    return [BASE, *names[1:]]


def _joint_names(model: Any, bodies: list[str]) -> list[str]:
    """Names of the joints in MuJoCo's order, in the same way."""
    names = [model.joint(k).name for k in range(model.njnt)]
    taken = set(names)
    for k, name in enumerate(names):
        if not name:
            b = int(model.jnt_bodyid[k])
            several = int(model.body_jntnum[b]) > 1
            number = k - int(model.body_jntadr[b]) + 1 if several else ""
            names[k] = unique(f"{bodies[b]}__joint{number}", taken)
            taken.add(names[k])
    return names


def _key_name(model: Any, i: int) -> str:
    return model.key(i).name or f"key{i + 1}"


def _keyframes(model: Any, joints: list[str], without: Container[int]) -> tuple[Keyframe, ...]:
    """The states that the file names (``key1``, … where it names none), by joint and actuator, and ``qpos0`` last."""
    drives = {
        model.actuator(a).name or f"actuator{a + 1}": int(model.actuator_ctrladr[a])
        for a in range(model.nactuator)
        if model.actuator_ctrlnum[a] == 1
    }
    named = tuple(
        Keyframe(
            _key_name(model, i),
            _named(model, joints, model.key_qpos[i], "position_names"),
            _named(model, joints, model.key_qvel[i], "velocity_names"),
            {name: float(model.key_ctrl[i, at]) for name, at in drives.items()},
        )
        for i in range(model.nkey)
        if i not in without
    )
    rest = _named(model, joints, model.qpos0, "position_names")
    return (*named, Keyframe("qpos0", rest, {}, {}))


def _kind(model: Any, k: int) -> JointType:
    import mujoco

    kind = mujoco.mjtJoint
    words = {
        kind.mjJNT_FREE: JointType.FREE,
        kind.mjJNT_BALL: JointType.BALL,
        kind.mjJNT_SLIDE: JointType.PRISMATIC,
        kind.mjJNT_HINGE: JointType.REVOLUTE,
    }
    return words[kind(int(model.jnt_type[k]))]


def _in_space() -> tuple[int, int]:
    """MuJoCo's numbers of free and ball joints."""
    import mujoco

    return int(mujoco.mjtJoint.mjJNT_FREE), int(mujoco.mjtJoint.mjJNT_BALL)


def _named(model: Any, joints: list[str], values: Array, which: str) -> dict[str, float]:
    """Positions or velocities of MuJoCo's by our names."""
    first = model.jnt_qposadr if which == "position_names" else model.jnt_dofadr
    found: dict[str, float] = {}
    for k, name in enumerate(joints):
        names = getattr(Joint(name, _kind(model, k), "", ""), which)
        found |= {each: float(values[int(first[k]) + i]) for i, each in enumerate(names)}
    return found


def _tree(model: Any, notes: list[str]) -> tuple[list[Joint], list[Link], list[Attachment], list[Array]]:
    """Joints, links and joint laws of a compiled model, one fixed joint for a body without joints.

    The last is where each body's frame lies in the frame of the link that stands for it (axes are parallel).
    """
    joints: list[Joint] = []
    links: list[Link] = []
    effects: list[Attachment] = []
    names = _body_names(model)
    joint_names = _joint_names(model, names)
    # Names of the links and joints that no body or joint of the file stands for.
    link_names, all_joints = set(names), set(joint_names)
    body_in_link = [np.zeros(3) for _ in range(model.nbody)]
    for b in range(1, model.nbody):
        parent = int(model.body_parentid[b])
        xyz = model.body_pos[b] + body_in_link[parent]
        rotation = from_quaternion(model.body_quat[b])
        first, count = int(model.body_jntadr[b]), int(model.body_jntnum[b])
        if count == 0:
            joints.append(
                Joint(
                    unique(f"{names[b]}__fixed", all_joints),
                    JointType.FIXED,
                    names[parent],
                    names[b],
                    xyz=constant(xyz),
                    rotation=constant(rotation),
                )
            )
        anchor = np.zeros(3)
        carrier = names[parent]
        for k in range(first, first + count):
            name = joint_names[k]
            last = k == first + count - 1
            child = names[b] if last else unique(f"{names[b]}__{name}", link_names)
            # The first joint is placed in the parent; the others in the massless link before them, whose axes are
            # the body's.
            place = xyz + rotation @ model.jnt_pos[k] if k == first else model.jnt_pos[k] - anchor
            turn = rotation if k == first else np.eye(3)
            if _kind(model, k) is JointType.FREE:
                place, turn = np.zeros(3), np.eye(3)
            if model.jnt_type[k] in _in_space():
                joints.append(_joint_in_space(model, k, name, carrier, child, place, turn, notes))
            else:
                joints.append(_joint(model, k, name, carrier, child, place, turn))
                effects += _joint_laws(model, k, name, notes)
            if not last:
                links.append(Link(child))
            # A free joint's positions are those of its body's frame.
            anchor = np.zeros(3) if _kind(model, k) is JointType.FREE else model.jnt_pos[k].copy()
            carrier = child
        body_in_link[b] = -anchor
        axes = from_quaternion(model.body_iquat[b])
        inertia = axes @ np.diag(model.body_inertia[b]) @ axes.T
        links.append(
            Link(
                names[b],
                mass=float(model.body_mass[b]),
                com=constant(model.body_ipos[b] - anchor),
                inertia=constant((inertia + inertia.T) / 2.0),
                gravcomp=compensation(model, b),
            )
        )
    return joints, links, effects, body_in_link


def _joint_in_space(
    model: Any, k: int, name: str, parent: str, child: str, place: Array, turn: Array, notes: list[str]
) -> Joint:
    """A free or ball joint; tells of springs, dry friction and limits, which they have none of here."""
    dof = int(model.jnt_dofadr[k])
    if (model.jnt_stiffness[k] or np.any(model.jnt_stiffnesspoly[k])) and not disabled(model, "SPRING"):
        notes.append(f"joint {name!r}: its spring of stiffness {float(model.jnt_stiffness[k]):g} is left out")
    if model.dof_frictionloss[dof] and not disabled(model, "FRICTIONLOSS"):
        notes.append(f"joint {name!r}: its dry friction {float(model.dof_frictionloss[dof]):g} is left out")
    if np.any(model.dof_dampingpoly[dof]) and not disabled(model, "DAMPER"):
        notes.append(f"joint {name!r}: its damping beyond linear is left out")
    if model.jnt_limited[k] and act(model):
        notes.append(f"joint {name!r}: its limit of {float(model.jnt_range[k, 1]):g} rad is left out")
    return Joint(
        name,
        _kind(model, k),
        parent,
        child,
        xyz=constant(place),
        rotation=constant(turn),
        armature=float(model.dof_armature[dof]),
        damping=0.0 if disabled(model, "DAMPER") else float(model.dof_damping[dof]),
    )


def _joint(model: Any, k: int, name: str, parent: str, child: str, place: Array, turn: Array) -> Joint:
    import mujoco

    dof, coordinate = int(model.jnt_dofadr[k]), int(model.jnt_qposadr[k])
    axis = np.asarray(model.jnt_axis[k], dtype=np.float64)
    axis = axis / np.linalg.norm(axis)
    prismatic = int(model.jnt_type[k]) == int(mujoco.mjtJoint.mjJNT_SLIDE)
    reference = float(model.qpos0[coordinate])
    if prismatic:
        place = place - reference * (turn @ axis)
    elif reference != 0.0:
        turn = turn @ about_axis(axis, -reference)
    lower, upper = ends(model, k)
    force_limited = bool(model.jnt_actfrclimited[k])
    springs, dampers = not disabled(model, "SPRING"), not disabled(model, "DAMPER")
    dry = rubs(model)
    driven = reflected(model, k)
    return Joint(
        name,
        JointType.PRISMATIC if prismatic else JointType.REVOLUTE,
        parent,
        child,
        xyz=constant(place),
        rotation=constant(turn),
        axis=constant(axis),
        armature=float(model.dof_armature[dof]) + driven.armature,
        damping=float(model.dof_damping[dof]) + driven.damping[0] if dampers else 0.0,
        friction=float(model.dof_frictionloss[dof]) if dry else 0.0,
        stiffness=float(model.jnt_stiffness[k]) if springs else 0.0,
        rest_position=float(model.qpos_spring[coordinate]) if model.jnt_stiffness[k] != 0.0 and springs else 0.0,
        lower=lower,
        upper=upper,
        effort=float(np.abs(model.jnt_actfrcrange[k]).max()) if force_limited else np.inf,
    )


def _joint_laws(model: Any, k: int, name: str, notes: list[str]) -> list[Attachment]:
    """Damping and stiffness beyond linear: −(a v + b v|v| + c v³) and −(k1 x + k2 x² + k3 x³), x from where the spring is slack.

    Where one term of the catalogue's is all there is, it goes by its name.
    """
    dof, coordinate = int(model.jnt_dofadr[k]), int(model.jnt_qposadr[k])
    effects = []
    drag, thick = (float(v) for v in np.asarray(model.dof_dampingpoly[dof]) + np.array(reflected(model, k).damping[1:]))
    if not disabled(model, "DAMPER"):
        if drag >= 0.0 and not thick:
            effects += [Attachment("quadratic_drag", name, {"coefficient": drag})] if drag else []
        else:
            effects.append(Attachment("polynomial_damping", name, {"quadratic": drag, "cubic": thick}))
    if not disabled(model, "SPRING"):
        square, cubic = (float(value) for value in model.jnt_stiffnesspoly[k])
        slack = float(model.qpos_spring[coordinate])
        if cubic > 0.0 and slack == 0.0 and not square:
            effects.append(Attachment("cubic_stiffness", name, {"stiffness": cubic}))
        elif cubic or square:
            effects.append(
                Attachment("polynomial_stiffness", name, {"quadratic": square, "cubic": cubic, "rest_angle": slack})
            )
        if square:
            notes.append(
                f"joint {name!r}: its stiffness {square:g} x², x = position - {slack:g}, pulls to one side alone, whichever side "
                "x is on; it acts so"
            )
    dry = rubs(model) and model.dof_frictionloss[dof]
    if dry and not as_soft_as_by_default(model.dof_solref[dof], model.dof_solimp[dof]):
        notes.append(
            f"joint {name!r}: how soft its dry friction is (solreffriction, solimpfriction) is left out: it sticks here"
        )
    if model.jnt_plasticadr[k] >= 0:
        notes.append(f"joint {name!r}: plastic yield of its spring is left out")
    return effects
