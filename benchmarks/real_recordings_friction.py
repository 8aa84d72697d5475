"""Which joint of a free mechanism rubs, and how: the torque that the motion lacks, recording by recording.

In free motion, inverse dynamics of the published model along the smoothed motion leaves what dissipation takes. Unlike a free
run this does not diverge where motion is chaotic, and unlike a decay of energy it tells the joints apart. Dry friction takes the
same torque from fast and slow recordings; viscous damping takes a torque that grows with the speed.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.denoc.model import Denoc
from harness.diagnose.inverse.band import cutoff_for
from harness.diagnose.inverse.effort_motion import effort_run
from harness.effects.scale import references
from harness.recording import read_recordings
from harness.recording.recording import Channel
from harness.system import System

SLIDING = 0.02  # of a recording's greatest speed, over which dry friction changes its sign
PROBE = 1e-12  # N·m; efforts are asked for, and there are none


def residual_torque(folder: Path, rig: str, system: System) -> dict[str, list[dict[str, Any]]]:
    """By joint, for every recording in the order of its greatest speed: dry friction alone and viscous damping alone.

    Each is the least-squares coefficient of sign(v), or of v, in the torque that the frictionless published model lacks.
    """
    paths = sorted((folder / rig).glob("*.csv.gz"))
    names = system.joint_names
    smooth = system
    for joint in system.joints:
        if joint.movable:
            smooth = smooth.replace_joint(replace(joint, damping=0.0, friction=0.0))
    model = Denoc(smooth)
    swing = min(references(system, name).frequency for name in names) / (2.0 * np.pi)
    out: dict[str, list[dict[str, Any]]] = {name: [] for name in names}
    for recording in read_recordings(paths, system=system):
        silent = tuple(Channel(f"{n}.effort", n, "effort", "N*m", np.full(recording.samples, PROBE)) for n in names)
        asked = replace(recording, efforts=silent)
        run = effort_run(system, asked, cutoff_for(system, asked, swing))
        lacking = -run.smooth(model.inverse_dynamics_batch(run.q, run.qd, run.qdd))
        use = run.inner
        for j, name in enumerate(names):
            fast = float(np.abs(run.qd[use, j]).max())
            target = lacking[use, j]
            row: dict[str, Any] = {"recording": recording.name, "greatest_speed": fast}
            for kind, shape in (
                ("dry_Nm", np.tanh(run.qd[:, j] / (SLIDING * fast))),
                ("viscous_Nms", run.qd[:, j]),
            ):
                column = run.smooth(shape)[use]
                row[kind] = float(column @ target / (column @ column))
            out[name].append(row)
    return {name: sorted(rows, key=lambda row: -row["greatest_speed"]) for name, rows in out.items()}
