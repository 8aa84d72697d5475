"""What formats say of gimbals, which they do not have: as slides or as a ball, or not at all."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from harness.errors import UnsupportedError
from harness.system.description import Gimbal, Joint, JointType, System


def without_gimbals(system: System, form: str, *, balls: bool = False) -> tuple[System, list[str]]:
    """The system as a format without gimbals can say it, and what that leaves out, a line each.

    Damping of a velocity as a vector is the same damping of each of three slides square to one another. Damping of an angular
    velocity is that of a ball joint: the three turns become one where the format has it (``balls``), whose zero is theirs.
    Raises UnsupportedError where a gimbal resists otherwise: left out, that would make another mechanism of it, and at the three
    joints it is another law.
    """
    left_out = []
    for gimbal in system.gimbals:
        plain = not gimbal.friction and _plain(system, gimbal)
        if gimbal.damping and plain and (balls or gimbal.slides):
            system = _slides(system, gimbal) if gimbal.slides else _ball(system, gimbal)
        elif gimbal.damping or gimbal.friction:
            raise _refusal(system, gimbal, form)
        if gimbal.slides or not (gimbal.damping and balls):
            left_out.append(f"gimbal {gimbal.name!r}: that {', '.join(gimbal.coordinates)} belong together")
    return replace(system, gimbals=()), left_out


def _refusal(system: System, gimbal: Gimbal, form: str) -> UnsupportedError:
    resists = [
        f"{what} {size:g}" for what, size in (("damping", gimbal.damping), ("friction", gimbal.friction)) if size
    ]
    of = "the velocity" if gimbal.slides else "the angular velocity"
    return UnsupportedError(
        f"gimbal {gimbal.name!r} has {' and '.join(resists)} against {of} of three joints, which {form} cannot say",
        mend="write TOML, or the system before its balls were taken apart",
        source=system.source,
    )


def _plain(system: System, gimbal: Gimbal) -> bool:
    """Whether the three joints follow one another at one place, square to one another, and nothing acts at one of them alone."""
    joints = [system.joint(name) for name in gimbal.coordinates]
    first = system.joints.index(joints[0])
    in_a_row = system.joints[first : first + 3] == tuple(joints) and all(
        b.parent == a.child and not np.any(np.asarray(b.xyz)) and np.array_equal(np.asarray(b.rotation), np.eye(3))
        for a, b in pairwise(joints)
    )
    between = {joint.child for joint in joints[:2]}
    empty = not any(link.mass or np.any(link.inertia) for link in system.links if link.name in between) and not any(
        joint.parent in between for joint in system.joints if joint not in joints
    )
    axes = np.array([joint.axis for joint in joints])
    own = any(j.damping or j.friction or j.stiffness or j.armature or j.mimic is not None for j in joints)
    ends = [end for j in joints for end in (j.lower, j.upper, j.effort, j.velocity)]
    acted_on = {a.site for a in system.attachments} | {d.joint for d in system.drives} | {s.joint for s in system.stops}
    alone = own or np.any(np.isfinite(ends)) or acted_on & {*gimbal.coordinates, *between} or system.loops
    return in_a_row and empty and bool(np.allclose(axes @ axes.T, np.eye(3), atol=1e-12)) and not alone


def _slides(system: System, gimbal: Gimbal) -> System:
    damped = {name: replace(system.joint(name), damping=gimbal.damping) for name in gimbal.coordinates}
    return replace(system, joints=tuple(damped.get(joint.name, joint) for joint in system.joints))


def _ball(system: System, gimbal: Gimbal) -> System:
    """The system with a ball joint in place of the three turns and the massless links between them."""
    first, second, third = (system.joint(name) for name in gimbal.coordinates)
    ball = Joint(
        gimbal.name, JointType.BALL, first.parent, third.child,
        xyz=first.xyz, rotation=first.rotation, damping=gimbal.damping,
    )  # fmt: skip
    joints = tuple(ball if j is first else j for j in system.joints if j.name not in (second.name, third.name))
    links = tuple(link for link in system.links if link.name not in (first.child, second.child))
    others = tuple(other for other in system.gimbals if other is not gimbal)
    return replace(system, joints=joints, links=links, gimbals=others)
