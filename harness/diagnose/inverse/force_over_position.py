"""Whether a force over a joint's position that nobody has named does what several named effects do together.

A body redrawn in two ways that make up for one another, or a spring beside one, can stand for a force of any shape: of a balancing
spring, of a cable. Such effects are held against a smooth force over the position (cubic splines; de Boor, A Practical Guide to
Splines, 2001) that pays for every number that it has.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from harness.diagnose.inverse.constants import POSITION_SHAPES
from harness.diagnose.inverse.effort_fit import EffortFit
from harness.diagnose.inverse.effort_grades import estimates, waves_seen
from harness.diagnose.inverse.effort_search import EffortStudy
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.diagnose.selection.constants.weighing import FEWEST_WAVES
from harness.effects.effect import Family, SiteKind

Array = NDArray[np.float64]


def of_any_shape(study: EffortStudy, best: EffortFit) -> frozenset[int]:
    """Members of a set, several at a joint, that a force over its position would do for as well: a law by itself has a shape."""
    out: set[int] = set()
    for joint in study.data.joints:
        group = [k for k, m in enumerate(best.hypothesis.members) if _over_position(study, m, joint)]
        if len(group) > 1 and (_bent(study, best, group) or _as_well(study, best, joint, group)):
            out.update(group)
    return frozenset(out)


def _over_position(study: EffortStudy, member: Candidate, joint: int) -> bool:
    """Whether a member is a spring at a joint, or of the body that it carries."""
    system, name = study.data.model.system, study.data.model.system.joint_names[joint]
    if member.effect.family not in (Family.INERTIA, Family.STIFFNESS):
        return False
    site = system.carrier(member.site).name if member.effect.site is SiteKind.LINK else member.site
    return site == name


def _bent(study: EffortStudy, best: EffortFit, group: Sequence[int]) -> bool:
    """Whether one of them is less than whole waves over the position, which bends another to whatever shape there is."""
    members = best.hypothesis.members
    seen = [waves_seen(study.data, members[k], estimates(best, study.nominal, k)) for k in group]
    return any(0.0 < waves < FEWEST_WAVES for waves in seen)


def _as_well(study: EffortStudy, best: EffortFit, joint: int, group: list[int]) -> bool:
    """Whether the set without a group of its members, a force over the position in their place, is likelier."""
    data, nominal = study.data, study.nominal
    kept = [k for k in range(len(best.hypothesis.members)) if k not in group]
    less = Hypothesis(tuple(best.hypothesis.members[k] for k in kept))
    spans = [best.hypothesis.span(k) for k in kept]
    x = np.concatenate([best.x[:nominal], *(best.x[nominal + s.start : nominal + s.stop] for s in spans)])
    here = data.rows(less, x)
    size = data.size(data.rows(best.hypothesis, best.x))
    columns = [data.nominal_slopes(less, x)] if nominal else []
    for span, member in zip(data.model.spans(less), less.members, strict=True):
        steps = zip(range(span.start, span.stop), 1e-4 * member.scales, strict=True)
        columns += [data.slope(less, x, k, float(step), here)[:, None] for k, step in steps]
    prior = study.price(best.hypothesis) + study.surprise(best) - study.price(less)
    most = best.cost + prior
    return any(
        _cost(study, np.hstack([*columns, shapes]), here, size, x) < most - paid
        for shapes, paid in _shapes(study, joint)
    )


def _cost(study: EffortStudy, design: Array, here: Array, size: Array, x: Array) -> float:
    """Cost of the best linear combination of columns beside rows; the nominal quantities come first, and have a prior."""
    nominal = study.nominal
    prior = np.eye(nominal, design.shape[1])
    right = -np.concatenate([here / size, x[:nominal]])
    found = np.linalg.lstsq(np.vstack([design / size[:, None], prior]), right, rcond=1e-10)[0]
    bent = x[:nominal] + found[:nominal]
    return study.data.misfit(here + design @ found) + float(bent @ bent)


def _shapes(study: EffortStudy, joint: int) -> Iterator[tuple[Array, float]]:
    """What forces over a joint's position add to the rows, (rows, k), and what so many numbers have to bring."""
    ways = [float(np.ptp(run.q[:, joint])) for run in study.data.model.runs]
    for count in POSITION_SHAPES if max(ways) > 0.0 else ():
        splines = _splines(study, joint, count)
        shapes = np.stack([-study.data.whitened.of_force(joint, own) for own in splines], axis=1)
        yield shapes, count * float(np.log(study.data.samples))


def _splines(study: EffortStudy, joint: int, count: int) -> list[list[Array]]:
    """So many splines over the whole of a joint's way, each of every run, (T,)."""
    runs = study.data.model.runs
    low, high = (float(f([f(run.q[:, joint]) for run in runs])) for f in (np.min, np.max))
    inner = np.linspace(low, high, count - 2)
    knots = np.concatenate([[low] * 3, inner, [high] * 3])
    tables = [BSpline.design_matrix(np.clip(run.q[:, joint], low, high), knots, 3).toarray() for run in runs]
    return [[table[:, k] for table in tables] for k in range(count)]
