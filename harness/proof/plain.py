"""A rig with nothing concealed, by the native lanes: many copies at once, to measure how much of an effect nuisances could make.

Nothing is concealed or judged with it. What is concealed comes from other code; this only says how visible it came out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from harness.effects.lanes import lane_model, lane_row
from harness.proof.model_file import model_file
from harness.proof.rigs import Rig
from harness.proof.scene import FINE_STEP, Run, Sensor
from harness.proof.visibility import RELATIVE_STEP, Moves, whiten
from harness.system import System, load
from harness.system.description import constant

Array = NDArray[np.float64]


class PlainRig:
    """Whitened samples of a rig's recordings as a function of its nuisances, all runs in a row as ``observe`` gives them."""

    def __init__(self, rig: Rig, runs: Sequence[Run], sensor: Sensor, moves: Moves) -> None:
        self.rig, self.runs, self.sensor, self.moves = rig, runs, sensor, moves
        with model_file(rig.toml()) as path:
            self._system = load(path)
        self._model = lane_model(self._system)

    def simulate(self, numbers: Array) -> Array:
        """Samples at vectors of nuisances (K, k): (K, samples)."""
        system_rows = []
        known: dict[bytes, Array] = {}
        cut = len(self.moves.segments)
        for z in numbers:
            key = z[:cut].tobytes()
            if key not in known:
                known[key] = lane_row(self._model, _with_data(self._system, self.moves.moved(self.rig, z)))
            system_rows.append(known[key])
        rows = np.array(system_rows)
        pieces = []
        for index, run in enumerate(self.runs):
            instants = np.arange(0.0, run.duration, 1.0 / self.sensor.rate)
            parts = max(1, int(np.ceil(1.0 / (self.sensor.rate * FINE_STEP) - 1e-9)))
            time = np.arange((len(instants) - 1) * parts + 1) / (self.sensor.rate * parts)
            state = np.array([self.moves.released(run, index, z, self.rig.joints) for z in numbers])
            n = len(self.rig.joints)
            tau = None
            if run.drive:
                tau = np.zeros((len(time), n))
                tau[:, 0] = run.effort(time)
            q, _, _ = self._model.simulate(rows, state[:, :n], state[:, n:], time, tau=tau)
            pieces += [whiten(q[:, ::parts, j], self.sensor) for j in range(n)]
        return np.concatenate(pieces, axis=1)

    def sensitivities(self, z: Array) -> Array:
        """Changes of the samples with each nuisance at ``z`` (k,): (samples, k)."""
        moved = self.simulate(np.vstack([z, z + RELATIVE_STEP * np.eye(len(z))]))
        return np.asarray((moved[1:] - moved[0]).T / RELATIVE_STEP)


def _with_data(system: System, rig: Rig) -> System:
    """The system with the data of a rig of the same shape."""
    joints, links = [], []
    below = 0.0
    for joint, link, s in zip(system.joints, system.links, rig.segments, strict=True):
        joints.append(replace(joint, xyz=constant([0.0, 0.0, below]), damping=s.damping, armature=s.armature))
        links.append(
            replace(link, mass=s.mass, com=constant([0.0, 0.0, -s.com]), inertia=constant(s.inertia * np.eye(3)))
        )
        below = -s.length
    return replace(system, joints=tuple(joints), links=tuple(links))
