"""Loops of an MJCF: equalities that connect or weld, and joint equalities that no mimic says."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import InputError
from harness.system.description import Array, Mimic, constant
from harness.system.loop import MOTIONS, SHIFTS, Coupling, Frame, Loop
from harness.system.mjcf_files import unique
from harness.system.mjcf_left_out import disabled
from harness.system.rotation import from_quaternion

Polynomial = np.polynomial.Polynomial
SAME = 1e-9  # slopes and offsets [rad or m] of one joint by two ways that differ by less are the same but for rounding


def loops(
    model: Any,
    bodies: Sequence[str],
    body_in_link: Sequence[Array],
    joints: Sequence[str],
    following: Mapping[str, Mimic],
    mimics: Container[int],
    lines: Mapping[tuple[str, str], int],
    source: Path | None = None,
) -> tuple[dict[int, Loop | Coupling], frozenset[int], list[str]]:
    """Loops by number of the equality, numbers of those that say what mimics say already, and notes on both.

    bodies, joints: names in MuJoCo's order. body_in_link: where each body's frame lies in its link's. following: mimics by joint,
    mimics: the equalities that they are. lines: of equalities in the source, by ("loop", name).
    Raises InputError for an equality that contradicts mimics.
    """
    import mujoco

    found: dict[int, Loop | Coupling] = {}
    if disabled(model, "CONSTRAINT") or disabled(model, "EQUALITY"):
        return found, frozenset(), []
    said: set[int] = set()
    taken = {model.equality(i).name for i in range(model.neq)}
    notes: list[str] = []
    for i in range(model.neq):
        if not model.eq_active0[i] or i in mimics:
            continue
        kind = mujoco.mjtEq(int(model.eq_type[i]))
        name = model.equality(i).name or unique(f"equality{i + 1}", taken)
        taken.add(name)
        if kind in (mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD):
            welded = kind == mujoco.mjtEq.mjEQ_WELD
            frames = _frames(model, i, welded, bodies, body_in_link)
            found[i] = Loop(name, *frames, MOTIONS if welded else SHIFTS)
        elif kind == mujoco.mjtEq.mjEQ_JOINT:
            coupling = _coupling(model, i, name, joints, following)
            if coupling is not None and coupling.joint == coupling.leader:
                coupling = _of_itself(coupling, lines.get(("loop", name)), source)
                if coupling is None:
                    said.add(i)
                    notes.append(
                        f"equality {name!r} says of joint {joints[int(model.eq_obj1id[i])]!r} what others say already"
                    )
                    continue
            if coupling is None:
                notes.append(f"equality {name!r} left out: it is about joints that turn in space")
            else:
                found[i] = coupling
    if found:
        names = ", ".join(repr(loop.name) for loop in found.values())
        several = len(found) > 1
        notes.append(
            f"equalit{'ies' if several else 'y'} {names} hold{'' if several else 's'} exactly here, MuJoCo holds "
            f"{'them' if several else 'it'} softly (solref, solimp)"
        )
    return found, frozenset(said), notes


def _of_itself(coupling: Coupling, line: int | None, source: Path | None) -> Coupling | None:
    """What is left of an equality that mimics have made one of a joint with itself: the place it is locked at, or nothing.

    Raises InputError where no place will do.
    """
    constant, slope, *beyond = coupling.coefficients
    if any(beyond):
        return coupling
    if abs(slope - 1.0) > SAME:
        return Coupling(coupling.name, coupling.joint, None, (constant / (1.0 - slope), 0.0, 0.0, 0.0, 0.0))
    if abs(constant) <= SAME:
        return None
    raise InputError(
        f"equality {coupling.name!r} contradicts others: by them joint {coupling.joint!r} would be {abs(constant):.3g} (rad or m) "
        "from where it is",
        mend="take one out, or check their polycoef",
        source=source,
        line=line,
    )


def _frames(
    model: Any, i: int, welded: bool, bodies: Sequence[str], body_in_link: Sequence[Array]
) -> tuple[Frame, Frame]:
    import mujoco

    data = model.eq_data[i]
    ids = int(model.eq_obj1id[i]), int(model.eq_obj2id[i])
    if int(model.eq_objtype[i]) == int(mujoco.mjtObj.mjOBJ_SITE):
        of = [int(model.site_bodyid[site]) for site in ids]
        places = [np.array(model.site_pos[site]) for site in ids]
        turns = [from_quaternion(model.site_quat[site]) for site in ids]
    else:
        of = list(ids)
        # A weld's anchor is in the second body, and where that has to be in the first stands behind it.
        places = [np.array(data[3:6]), np.array(data[0:3])] if welded else [np.array(data[0:3]), np.array(data[3:6])]
        turns = [from_quaternion(data[6:10]) if welded else np.eye(3), np.eye(3)]
    first, second = (
        Frame(bodies[b], constant(place + body_in_link[b]), constant(turn))
        for b, place, turn in zip(of, places, turns, strict=True)
    )
    return first, second


def _coupling(model: Any, i: int, name: str, joints: Sequence[str], following: Mapping[str, Mimic]) -> Coupling | None:
    """A joint equality, about positions relative to ``qpos0`` in the file, as a polynomial of positions."""
    import mujoco

    one = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
    first, second = int(model.eq_obj1id[i]), int(model.eq_obj2id[i])
    if any(k >= 0 and int(model.jnt_type[k]) not in one for k in (first, second)):
        return None
    rest = [float(model.qpos0[model.jnt_qposadr[k]]) if k >= 0 else 0.0 for k in (first, second)]
    terms = [float(c) for c in model.eq_data[i, :5]]
    polynomial = Polynomial(terms if second >= 0 else terms[:1])(Polynomial([-rest[1], 1.0])) + rest[0]
    joint, leader = joints[first], joints[second] if second >= 0 else None
    # What follows another joint is said of that one.
    while leader is not None and leader in following:
        mimic = following[leader]
        polynomial, leader = polynomial(Polynomial([mimic.offset, mimic.multiplier])), mimic.joint
    while joint in following:
        mimic = following[joint]
        polynomial, joint = (polynomial - mimic.offset) / mimic.multiplier, mimic.joint
    c = [*(float(x) for x in polynomial.coef), 0.0, 0.0, 0.0, 0.0]
    return Coupling(name, joint, leader, (c[0], c[1], c[2], c[3], c[4]))
