"""Systems from MJCF, read by MuJoCo itself so that defaults, classes, fromto and the compiler mean what they mean there.

Conventions, MuJoCo to ours:

- A joint at ``pos`` p in body b becomes a joint frame at p, axes of the body; the link frame follows the joint, so the
  body frame lies at -p in it.
- Several joints of one body become a chain of massless links ``<body>__<joint>``; the last carries the body.
- A joint position is MuJoCo's ``qpos``: ``ref`` is kept as a turn (shift) by -ref at our zero.
- A body without joints becomes a link on a fixed joint; ``world`` is the base.
"""

from __future__ import annotations

import contextlib
import re
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import InputError, UnsupportedError
from harness.system.check import check_bodies, check_dynamics, check_joints
from harness.system.description import Array, Joint, JointType, Link, System, constant
from harness.system.rotation import about_axis
from harness.system.topology import arrange
from harness.system.xml_source import parse_xml

BASE = "world"
_warning_handler = threading.Lock()


def read_mjcf(
    data: bytes, root: Any, source: Path | None = None, *, tolerance: float | None = None, physical: bool = True
) -> System:
    """A system from an MJCF document.

    data, root: the document and its parsed root element. source: its file, which includes and meshes are relative to.
    What MuJoCo would let act and a system does not hold (tendons, equalities, actuators, contacts, fluid, higher
    damping and stiffness) becomes a line in ``System.notes``.
    Raises InputError with MuJoCo's own message, and UnsupportedError naming free and ball joints.
    """
    folder = (source.parent if source is not None else Path.cwd()).resolve()
    _refuse_outside_files(root, source, folder, folder, set())
    spec, model, warnings = _compile(data, root, source)
    notes = [*warnings, *_left_out(model)]
    joints, links = _tree(model, source, notes)
    lines = _lines(spec) if root.find(".//include") is None else {}
    ordered_joints, ordered_links = arrange(joints, links, BASE, source=source, lines=lines)
    notes += check_joints(ordered_joints, physical=physical, source=source, lines=lines)
    ordered_links, told = check_bodies(ordered_links, physical=physical, source=source, lines=lines)
    notes += told
    system = System(
        name=root.get("model") or (source.stem if source is not None else "model"),
        joints=ordered_joints,
        links=ordered_links,
        base=BASE,
        gravity=constant(np.zeros(3) if _disabled(model, "GRAVITY") else model.opt.gravity),
        tolerance=0.01 if tolerance is None else tolerance,
        source=source,
        notes=tuple(notes),
    )
    check_dynamics(system, lines=lines)
    return system


def _refuse_outside_files(root: Any, source: Path | None, here: Path, folder: Path, seen: set[Path]) -> None:
    """Refuse files named by the document that lie outside the model's folder, before MuJoCo opens anything."""
    places = {here, folder}
    for compiler in root.iter("compiler"):
        for key in ("meshdir", "texturedir", "assetdir"):
            if compiler.get(key):
                places |= {place / compiler.get(key) for place in tuple(places)}
    for element in root.iter():
        if not isinstance(element.tag, str):
            continue
        named = [value for key, value in element.attrib.items() if key.startswith("file") and value]
        if element.tag == "compiler":
            named += [element.get(key) for key in ("meshdir", "texturedir", "assetdir") if element.get(key)]
        for name in named:
            for place in places:
                target = (place / name).resolve()
                if not target.is_relative_to(folder):
                    raise InputError(
                        f"<{element.tag}> names {name!r}, which lies outside the model's folder",
                        mend="move it under the folder of the model",
                        source=source,
                        line=element.sourceline,
                    )
                # Includes, and whole models attached as assets, may name files in their turn.
                if element.tag in ("include", "model") and target.is_file() and target not in seen:
                    seen.add(target)
                    inner = parse_xml(target.read_bytes(), target)
                    _refuse_outside_files(inner, target, target.parent, folder, seen)


def _compile(data: bytes, root: Any, source: Path | None) -> tuple[Any, Any, list[str]]:
    import mujoco

    by_path = source is not None and source.suffix.lower() == ".xml"
    if not by_path and root.find(".//include") is not None:
        raise InputError("has includes but does not end in .xml", mend="rename it to .xml", source=source)
    with _collected_warnings(mujoco) as warnings:
        try:
            if by_path:
                spec = mujoco.MjSpec.from_file(str(source))
            else:
                spec = mujoco.MjSpec.from_string(data.decode("utf-8-sig"))
                spec.modelfiledir = str((source or Path.cwd() / "model").parent)
            _refuse_joint_types(mujoco, spec, source)
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
    return spec, model, [f"MuJoCo warns: {' '.join(text.split())}" for text in warnings]


@contextlib.contextmanager
def _collected_warnings(mujoco: Any) -> Iterator[list[str]]:
    """Warnings of MuJoCo as a list, instead of a log file in the working directory."""
    warnings: list[str] = []
    with _warning_handler:
        before = mujoco.get_mju_user_warning()
        mujoco.set_mju_user_warning(warnings.append)
        try:
            yield warnings
        finally:
            mujoco.set_mju_user_warning(before)


def _refuse_joint_types(mujoco: Any, spec: Any, source: Path | None) -> None:
    words = {mujoco.mjtJoint.mjJNT_FREE: "free", mujoco.mjtJoint.mjJNT_BALL: "ball"}
    for joint in spec.joints:
        if joint.type in words:
            body = joint.parent.name or "without name"
            called = f"joint {joint.name!r}" if joint.name else f"joint of body {body!r}"
            raise UnsupportedError(
                f"{called}: type {words[joint.type]!r} is not modelled",
                mend="use hinge and slide joints on a fixed base",
                source=source,
                line=_line(joint),
            )


def _line(element: Any) -> int | None:
    found = re.search(r"line (\d+)", element.info or "")
    return int(found[1]) if found else None


def _lines(spec: Any) -> dict[tuple[str, str], int]:
    lines = {}
    for kind, elements in (("link", spec.bodies), ("joint", spec.joints)):
        for element in elements:
            line = _line(element)
            if element.name and line is not None:
                lines[(kind, element.name)] = line
    return lines


def _disabled(model: Any, what: str) -> bool:
    import mujoco

    return bool(model.opt.disableflags & int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{what}")))


def _tree(model: Any, source: Path | None, notes: list[str]) -> tuple[list[Joint], list[Link]]:
    """Joints and links of a compiled model, one fixed joint for a body without joints."""
    import mujoco

    joints: list[Joint] = []
    links: list[Link] = []
    names = [model.body(b).name or f"body{b}" for b in range(model.nbody)]
    names[0] = BASE
    # Where each body's frame lies in the frame of the link that stands for it (axes are parallel).
    body_in_link = [np.zeros(3) for _ in range(model.nbody)]
    for b in range(1, model.nbody):
        parent = int(model.body_parentid[b])
        xyz = model.body_pos[b] + body_in_link[parent]
        rotation = _matrix(model.body_quat[b])
        first, count = int(model.body_jntadr[b]), int(model.body_jntnum[b])
        if count == 0:
            joints.append(
                Joint(
                    f"{names[b]}__fixed",
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
            name = model.joint(k).name or f"{names[b]}__joint{k - first + 1 if count > 1 else ''}"
            kind = mujoco.mjtJoint(int(model.jnt_type[k]))
            if kind not in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
                raise UnsupportedError(
                    f"joint {name!r}: only hinge and slide joints are modelled", mend="use those", source=source
                )
            last = k == first + count - 1
            child = names[b] if last else f"{names[b]}__{name}"
            # The first joint is placed in the parent; the others in the massless link before them, whose axes are
            # the body's.
            place = xyz + rotation @ model.jnt_pos[k] if k == first else model.jnt_pos[k] - anchor
            turn = rotation if k == first else np.eye(3)
            joints.append(_joint(model, k, name, carrier, child, place, turn, notes))
            if not last:
                links.append(Link(child))
            anchor = model.jnt_pos[k].copy()
            carrier = child
        body_in_link[b] = -anchor
        axes = _matrix(model.body_iquat[b])
        inertia = axes @ np.diag(model.body_inertia[b]) @ axes.T
        links.append(
            Link(
                names[b],
                mass=float(model.body_mass[b]),
                com=constant(model.body_ipos[b] - anchor),
                inertia=constant((inertia + inertia.T) / 2.0),
            )
        )
    return joints, links


def _joint(
    model: Any, k: int, name: str, parent: str, child: str, place: Array, turn: Array, notes: list[str]
) -> Joint:
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
    limited = bool(model.jnt_limited[k])
    force_limited = bool(model.jnt_actfrclimited[k])
    springs, dampers = not _disabled(model, "SPRING"), not _disabled(model, "DAMPER")
    dry = not (_disabled(model, "FRICTIONLOSS") or _disabled(model, "CONSTRAINT"))
    if np.any(model.dof_dampingpoly[dof]) and dampers:
        b, c = model.dof_dampingpoly[dof]
        notes.append(
            f"joint {name!r}: damping beyond linear, {b:g} v|v| + {c:g} v³, is left out; "
            "attach quadratic_drag to have the first"
        )
    if np.any(model.jnt_stiffnesspoly[k]) and springs:
        notes.append(f"joint {name!r}: stiffness beyond linear is left out; attach cubic_stiffness to have it")
    if model.jnt_plasticadr[k] >= 0:
        notes.append(f"joint {name!r}: plastic yield of its spring is left out")
    return Joint(
        name,
        JointType.PRISMATIC if prismatic else JointType.REVOLUTE,
        parent,
        child,
        xyz=constant(place),
        rotation=constant(turn),
        axis=constant(axis),
        armature=float(model.dof_armature[dof]),
        damping=float(model.dof_damping[dof]) if dampers else 0.0,
        friction=float(model.dof_frictionloss[dof]) if dry else 0.0,
        stiffness=float(model.jnt_stiffness[k]) if springs else 0.0,
        rest_position=float(model.qpos_spring[coordinate]) if model.jnt_stiffness[k] != 0.0 and springs else 0.0,
        lower=float(model.jnt_range[k, 0]) if limited else -np.inf,
        upper=float(model.jnt_range[k, 1]) if limited else np.inf,
        effort=float(np.abs(model.jnt_actfrcrange[k]).max()) if force_limited else np.inf,
    )


def _matrix(quaternion: Array) -> Array:
    """Rotation matrix of a quaternion (w, x, y, z), which need not be of unit length, shape (3, 3)."""
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _left_out(model: Any) -> list[str]:
    """What would act in MuJoCo and is not part of a system, one line each."""
    notes = [
        f"{count} {what} left out"
        for count, what in (
            (model.neq, "equality constraint(s)"),
            (model.ntendon, "tendon(s)"),
            (model.nflex, "flexible mesh(es)"),
            (model.nplugin, "plugin(s)"),
            (model.nmocap, "mocap bodies taken as fixed; their motion is"),
        )
        if count
    ]
    if model.nu:
        bias = np.any(model.actuator_biasprm != 0.0)
        passive = np.any(model.actuator_armature != 0.0) or np.any(model.actuator_damping != 0.0)
        acts = ", though some act without a command (feedback, armature or damping)" if bias or passive else ""
        notes.append(f"{model.nu} actuator(s) left out{acts}; joint effort is an input here")
    moving = [g for g in range(model.ngeom) if model.geom_contype[g] or model.geom_conaffinity[g]]
    if len(moving) > 1 and not (_disabled(model, "CONTACT") or _disabled(model, "CONSTRAINT")):
        notes.append(f"contacts between {len(moving)} geom(s) left out")
    if np.any(model.body_gravcomp != 0.0):
        notes.append("gravity compensation (gravcomp) left out")
    if model.opt.density != 0.0 or model.opt.viscosity != 0.0:
        notes.append("forces of the surrounding fluid (density, viscosity) left out")
    return notes
