"""What would act in MuJoCo and is not part of a system, one line each, by name."""

from __future__ import annotations

from collections.abc import Container, Iterator
from typing import Any

import numpy as np

_MOST_NAMED = 4


def disabled(model: Any, what: str) -> bool:
    """Whether the model switches a kind of force off, by MuJoCo's word for it."""
    import mujoco

    return bool(model.opt.disableflags & int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{what}")))


def rubs(model: Any) -> bool:
    """Whether the file lets dry friction act."""
    return not (disabled(model, "FRICTIONLOSS") or disabled(model, "CONSTRAINT"))


def left_out(model: Any, kept: Container[int] = ()) -> list[str]:
    """Constraints (but equalities ``kept``), tendons, contacts, compensation and the fluid; joints and actuators tell their own."""
    constrained = not disabled(model, "CONSTRAINT")
    notes: list[str] = []
    if constrained and not disabled(model, "EQUALITY"):
        notes += _equalities(model, kept)
    notes += _tendons(model)
    for count, what in (
        (model.nflex, "flexible mesh(es)"),
        (model.nplugin, "plugin(s)"),
        (model.nmocap, "mocap bodies taken as fixed; their motion is"),
    ):
        if count:
            notes.append(f"{count} {what} left out")
    if constrained and not disabled(model, "CONTACT"):
        moving = [g for g in range(model.ngeom) if model.geom_contype[g] or model.geom_conaffinity[g]]
        if len(moving) > 1:
            notes.append(f"contacts between {len(moving)} geom(s) left out")
        if model.npair:
            notes.append(f"contacts of {model.npair} pair(s) of geoms that the file names left out")
    notes += _compensation(model)
    if model.opt.density != 0.0 or model.opt.viscosity != 0.0:
        notes.append(
            f"forces of the surrounding fluid (density {model.opt.density:g}, viscosity {model.opt.viscosity:g}) left out"
        )
    return notes


def _equalities(model: Any, kept: Container[int]) -> Iterator[str]:
    import mujoco

    for i in range(model.neq):
        if not model.eq_active0[i] or i in kept:
            continue
        kind = mujoco.mjtEq(int(model.eq_type[i]))
        name = model.equality(i).name
        called = f"equality {name!r}" if name else f"equality constraint {i + 1}"
        first, second = int(model.eq_obj1id[i]), int(model.eq_obj2id[i])
        if kind == mujoco.mjtEq.mjEQ_JOINT:
            other = f"{model.joint(second).name!r}" if second >= 0 else "a constant"
            terms = ", ".join(f"{c:g}" for c in model.eq_data[i, :5])
            yield (
                f"{called} left out: joint {model.joint(first).name!r} as a polynomial ({terms}) of {other}; "
                "both move independently here"
            )
        else:
            yield f"{called} left out ({kind.name.removeprefix('mjEQ_').lower()})"


def _tendons(model: Any) -> Iterator[str]:
    idle = 0
    for i in range(model.ntendon):
        does = [
            f"{word} {values[i]:g}"
            for word, values in (
                ("stiffness", model.tendon_stiffness),
                ("damping", model.tendon_damping),
                ("dry friction", model.tendon_frictionloss),
                ("armature", model.tendon_armature),
            )
            if values[i] != 0.0
        ]
        if np.any(model.tendon_stiffnesspoly[i]) or np.any(model.tendon_dampingpoly[i]):
            does.append("stiffness or damping beyond linear")
        if model.tendon_limited[i] and not (disabled(model, "LIMIT") or disabled(model, "CONSTRAINT")):
            does.append("limits of its length")
        if does:
            yield f"tendon {model.tendon(i).name or i + 1!r} left out: {', '.join(does)}"
        else:
            idle += 1
    if idle:
        yield f"{idle} tendon(s) left out that do nothing by themselves"


def _compensation(model: Any) -> Iterator[str]:
    if not np.any(model.body_gravcomp != 0.0) or disabled(model, "GRAVITY") or not np.any(model.opt.gravity):
        return
    share = uniform_compensation(model)
    if share:
        yield f"gravity compensation (gravcomp {share:g} on all that moves) is kept as gravity times {1.0 - share:g}"
        return
    by_body = [
        f"{model.body(b).name or b!r} {model.body_gravcomp[b]:g}"
        for b in range(1, model.nbody)
        if model.body_gravcomp[b] and _moves(model, b)
    ]
    if by_body:
        more = f" and {len(by_body) - _MOST_NAMED} more" if len(by_body) > _MOST_NAMED else ""
        yield (
            f"gravity compensation differs by body (gravcomp of {', '.join(by_body[:_MOST_NAMED])}{more}): it acts in "
            "`denoc validate` and `denoc simulate`, `denoc diagnose` refuses it"
        )
    for k in range(model.njnt):
        if model.jnt_actgravcomp[k] and model.jnt_actfrclimited[k]:
            yield (
                f"joint {model.joint(k).name or k!r}: its gravity compensation acts whole, though the file has it come of "
                "actuators with a range of force"
            )


def compensation(model: Any, body: int) -> float:
    """The share of a body's weight that is carried, where that is not the same for all that moves."""
    if disabled(model, "GRAVITY") or uniform_compensation(model) or not _moves(model, body):
        return 0.0
    return float(model.body_gravcomp[body])


def uniform_compensation(model: Any) -> float:
    """The one share of gravity that is compensated on every body that moves and has mass; 0 where it differs.

    Then, and only then, scaled gravity has the same effect: the compensating force acts at each body's centre of mass.
    """
    moving = [b for b in range(1, model.nbody) if model.body_mass[b] > 0.0 and _moves(model, b)]
    shares = {float(model.body_gravcomp[b]) for b in moving}
    return shares.pop() if len(shares) == 1 else 0.0


def _moves(model: Any, body: int) -> bool:
    while body > 0:
        if model.body_jntnum[body]:
            return True
        body = int(model.body_parentid[body])
    return False
