"""Where and when the nominal model needs another effort than was recorded, and the curves of what it and the best set leave."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.diagnose.answer.curves import Curves, ForceMap, Residuals
from harness.diagnose.criticism.constants import LOCATED_PIECES
from harness.diagnose.criticism.locate import band_of
from harness.diagnose.inverse.effort_fit import EffortFit
from harness.diagnose.inverse.effort_search import EffortStudy
from harness.diagnose.inverse.effort_tests import root_mean_square
from harness.system import System

POINTS = 4000  # of a curve


def channel(system: System, joint: int) -> str:
    """The name of a joint's effort as a channel."""
    return f"{system.joint_names[joint]}.effort"


def unit(system: System, joint: int) -> str:
    """The unit of a joint's effort."""
    return system.joint(system.joint_names[joint]).force_unit


def mismatch(system: System, study: EffortStudy, nominal: EffortFit, best: EffortFit) -> list[dict[str, Any]]:
    """A row a joint whose recorded effort the nominal model leaves; it is attributed to the first member of the best set."""
    member = next(iter(best.hypothesis.members), None)
    side, site = (member.effect.side, member.site) if member else ("input", system.joint_names[0])
    residuals = study.data.model.residuals(nominal.hypothesis, nominal.x)
    out = []
    for j in study.data.joints:
        floor = study.data.noises[j].std
        times, powers, q, v = [], [], [], []
        for run, residual in zip(study.data.model.runs, residuals, strict=True):
            for index in np.array_split(np.arange(len(run.time)), LOCATED_PIECES):
                part = index[run.usable[index]]
                if len(part) and float(np.sqrt(np.mean(residual[part, j] ** 2))) > 2.0 * floor:
                    times.append((float(run.time[part[0]]), float(run.time[part[-1]])))
                    q.append(run.q[part, j])
                    v.append(run.qd[part, j])
            powers.append(np.where(run.usable, residual[:, j], 0.0))
        if not times:
            continue
        step = float(study.data.model.runs[0].time[1])
        density = np.abs(np.fft.rfft(powers[0] * np.hanning(len(powers[0])))) ** 2
        positions, velocities = np.concatenate(q), np.concatenate(v)
        severity = root_mean_square(study.data, nominal, j) / floor
        out.append(
            {
                "channel": channel(system, j), "side": side, "site": site, "time": [list(t) for t in _joined(times)],
                "frequency_hz": list(band_of(np.asarray(np.fft.rfftfreq(len(powers[0]), step), dtype=np.float64), density)),
                "region": {
                    "position": [float(positions.min()), float(positions.max())],
                    "velocity": [float(velocities.min()), float(velocities.max())],
                },
                "severity": severity,
                "what": "the motion needs another effort than was recorded",
            }
        )  # fmt: skip
    return out


def curves(system: System, study: EffortStudy, nominal: EffortFit, best: EffortFit) -> Curves:
    """Residuals of every recording before and after, and the force that the nominal model lacks over each joint's state."""
    residuals, forces = [], []
    for part, held in ((study.data, False), (study.held, True)):
        before = part.model.residuals(nominal.hypothesis, nominal.x)
        after = part.model.residuals(best.hypothesis, best.x)
        for j in study.data.joints:
            for run, a, b in zip(part.model.runs, before, after, strict=True):
                if not run.driven[j]:
                    continue
                pick = slice(None, None, max(1, len(run.time) // POINTS))
                blank = np.where(run.usable, 1.0, np.nan)[pick]
                residuals.append(
                    Residuals(
                        channel(system, j), unit(system, j), run.name, held, study.data.noises[j].std, run.time[pick],
                        run.effort[pick, j], a[pick, j] * blank, b[pick, j] * blank,
                    )
                )  # fmt: skip
                if not held:
                    use = np.flatnonzero(run.usable)[:: max(1, int(run.usable.sum()) // 1000)]
                    forces.append((j, run.q[use, j], run.qd[use, j], a[use, j]))
    maps = [
        ForceMap(
            system.joint_names[j],
            (system.joint(system.joint_names[j]).position_unit, unit(system, j)),
            *(np.concatenate([row[k] for row in forces if row[0] == j]) for k in (1, 2, 3)),
        )
        for j in study.data.joints
    ]
    return Curves(tuple(residuals), (), tuple(maps), ())


def _joined(intervals: list[tuple[float, float]]) -> list[tuple[float, float]]:
    joined: list[tuple[float, float]] = []
    for low, high in sorted(intervals):
        if joined and low <= joined[-1][1] + 0.15 * (high - low):
            joined[-1] = (joined[-1][0], max(high, joined[-1][1]))
        else:
            joined.append((low, high))
    return [(round(a, 3), round(b, 3)) for a, b in joined]
