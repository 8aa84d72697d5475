"""Where joints and masses are: frames, axes, centres of mass, inertia; compared in the pose of zero."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from harness.compare.descriptions.bodies import Body, Part
from harness.compare.descriptions.fields import Change, Difference, against, relative, vector
from harness.system.description import Array
from harness.system.inertia import combine

# Frames that agree to this are the same; what remains is the rounding of printed angles.
_SAME = 1e-9


@dataclass(frozen=True, eq=False)
class Move:
    """A rigid motion x → turn · x + shift, from the second description's base coordinates to the first's."""

    turn: Array
    shift: Array

    def point(self, x: Array) -> Array:
        return np.asarray(self.turn @ x + self.shift)

    def body(self, body: Body) -> Body:
        """The body moved."""
        parts = tuple(Part(p.name, p.mass, self.point(p.com), self.turn @ p.inertia @ self.turn.T) for p in body.parts)
        return replace(
            body, point=self.point(body.point), turn=self.turn @ body.turn, axis=self.turn @ body.axis, parts=parts
        )


STILL = Move(np.eye(3), np.zeros(3))


def angle(rotation: Array) -> float:
    """Angle [rad] by which a rotation matrix turns."""
    skew = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])
    return float(np.arctan2(np.linalg.norm(skew), np.trace(rotation) - 1.0))


def between(a: Array, b: Array) -> float:
    """Angle [rad] between two unit vectors."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


def aside(a: Body, b: Body) -> float:
    """How far b's axis passes from a's origin [m]; of a joint that slides, nothing: only its direction counts."""
    if a.joint.prismatic:
        return 0.0
    shift = b.point - a.point
    return float(np.linalg.norm(shift - b.axis * (b.axis @ shift)))


def placed(k: int, a: Body, b: Body, move: Move, reach: float) -> tuple[Move, list[Difference]]:
    """The motion that brings body b, and what hangs on it, onto a, and by how much joint and frame are misplaced.

    move: the same for their parents. reach: longest link [m], to which misplacement is held.
    """
    here = move.body(b)
    turned, shifted = angle(a.turn @ here.turn.T), float(np.linalg.norm(a.point - here.point))
    if turned > _SAME or shifted > _SAME * reach:
        turn = a.turn @ b.turn.T
        moved = Move(turn, a.point - turn @ b.point)
        as_it_is, with_the_frame = _misfit(a, here, reach), _misfit(a, moved.body(b), reach)
        if as_it_is > 1e-6 and with_the_frame < as_it_is:
            back = Move(here.turn @ a.turn.T, here.point - here.turn @ a.turn.T @ a.point)
            found = [
                Difference(
                    "frame", a.joint.name, shifted / reach, "1", f"its origin is {shifted:.3g} m away", _moved(k, back)
                ),
                Difference(
                    "frame's direction", a.joint.name, turned, "rad", f"its axes are turned by {turned:.3g} rad"
                ),
            ]
            # Both are one change: a joint frame that is elsewhere carries all that hangs on it.
            if found[0].size < found[1].size:
                found[1] = replace(found[1], change=found[0].change)
                found[0] = replace(found[0], change=None)
            return moved, found
    return move, list(_axis_place(k, a, here, reach))


def _axis_place(k: int, a: Body, b: Body, reach: float) -> Iterator[Difference]:
    """An axis that passes elsewhere through a body that stays where it is."""
    if a.joint.movable and b.joint.movable:
        off = aside(a, b)

        def change(bodies: list[Body]) -> list[Body]:
            bodies[k] = replace(bodies[k], point=b.point)
            return bodies

        yield Difference("frame", a.joint.name, off / reach, "1", f"its axis passes {off:.3g} m away", change)


def _misfit(a: Body, b: Body, reach: float) -> float:
    """How badly axis and mass of two bodies agree where they are, as a sum of relative differences."""
    found = 0.0
    if a.joint.movable and b.joint.movable:
        found += between(a.axis, b.axis) + aside(a, b) / reach
    if a.parts and b.parts:
        x, y = (combine(*((p.mass, p.com, p.inertia) for p in body.parts)) for body in (a, b))
        found += float(np.linalg.norm(x[1] - y[1])) / max(a.size, 1e-12) + _spread(x[2], y[2])
    return found


def _spread(a: Array, b: Array) -> float:
    largest = max(float(np.linalg.norm(a, 2)), float(np.linalg.norm(b, 2)))
    return float(np.linalg.norm(a - b, 2)) / largest if largest > 0.0 else 0.0


def _moved(k: int, move: Move) -> Change:
    def change(bodies: list[Body]) -> list[Body]:
        carried = {k}
        for index, body in enumerate(bodies):
            if body.parent in carried:
                carried.add(index)
        return [move.body(body) if index in carried else body for index, body in enumerate(bodies)]

    return change


def axes(k: int, a: Body, b: Body) -> Iterator[Difference]:
    """Directions of the joints' axes; b: already moved onto a."""
    if not (a.joint.movable and b.joint.movable):
        return
    turned = between(a.axis, b.axis)
    x, y = (vector(a.turn.T @ axis) for axis in (a.axis, b.axis))

    def change(bodies: list[Body]) -> list[Body]:
        bodies[k] = replace(bodies[k], axis=b.axis)
        return bodies

    yield Difference("axis", a.joint.name, turned, "rad", f"{x} against {y}", change)


def masses(k: int, a: Body, b: Body) -> Iterator[Difference]:
    """Mass, centre of mass and inertia; link by link where both weld the same links together. b: already moved onto a."""
    if {p.name for p in a.parts} == {p.name for p in b.parts} and len(a.parts) > 1:
        pairs = [(p, next(other for other in b.parts if other.name == p.name)) for p in a.parts]
    else:
        pairs = [(_whole(a), _whole(b))]
    for x, y in pairs:
        yield Difference(
            "mass", x.name, relative(x.mass, y.mass), "1", against(x.mass, y.mass, "kg"), _part(k, x, "mass", y)
        )
        if x.mass > 0.0 and y.mass > 0.0:
            p, q = (vector(a.turn.T @ (part.com - a.point)) for part in (x, y))
            gyration = float(np.sqrt(max(np.linalg.eigvalsh(x.inertia)[-1], 0.0) / x.mass))
            reach = max(float(np.linalg.norm(x.com - a.point)), gyration, 1e-12)
            off = float(np.linalg.norm(x.com - y.com))
            yield Difference(
                "com", x.name, off / reach, "1", f"{off:.3g} m apart: {p} against {q} m", _part(k, x, "com", y)
            )
        yield Difference(
            "inertia", x.name, _spread(x.inertia, y.inertia), "1", _entries(a.turn, x, y), _part(k, x, "inertia", y)
        )


def _whole(body: Body) -> Part:
    if len(body.parts) == 1:
        return replace(body.parts[0], name=body.name)
    mass, com, inertia = combine(*((p.mass, p.com, p.inertia) for p in body.parts))
    names = [p.name for p in body.parts if p.name != body.name]
    return Part(" + ".join([body.name, *names]), mass, com if body.parts else body.point, inertia)


def _part(k: int, part: Part, field: str, other: Part) -> Change:
    def change(bodies: list[Body]) -> list[Body]:
        body = bodies[k]
        mine = next((p for p in body.parts if p.name == part.name), None)
        if mine is None:
            # Welded links that the other file does not tell apart: they change as one.
            mine = _whole(body)
            body = replace(body, parts=(mine,))
        new = replace(mine, **{field: getattr(other, field)})
        bodies[k] = replace(body, parts=tuple(new if p is mine else p for p in body.parts) or (new,))
        return bodies

    return change


def _entries(turn: Array, x: Part, y: Part) -> str:
    """The entries of the inertia tensors that differ, in the axes of the first's link."""
    a, b = (turn.T @ part.inertia @ turn for part in (x, y))
    apart = np.abs(a - b)
    told = [
        f"i{'xyz'[i]}{'xyz'[j]} {against(float(a[i, j]), float(b[i, j]), '')}"
        for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
        if apart[i, j] > 0.1 * apart.max()
    ]
    return ", ".join(told) + " kg·m²" if told else "the same"
