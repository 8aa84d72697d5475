"""FIGAROH, inverse-dynamics identification as its own workflow runs it; for one joint that is driven.

thanhndv212/figaroh-plus, 1.0: ``figaroh/identification/base_identification.py`` and its unified configuration.

- It regresses the effort on base parameters along filtered motion, so that an effort has to be known: a free swing is the
  null vector of its regression.
- Motion: positions through a zero-phase Butterworth filter of order 4 at ten times the fastest swing or more (Gautier,
  Venture, ICRA 2013: well above the dynamics, well below Nyquist), whichever predicts best, central differences, the borders
  of the filter cut. Done before it is handed over: its own filter leaves its borders in.
- Commands that a controller holds are on average what was and what comes at a sample; a recording does not say whether they
  are, so that both are tried, and whichever predicts better stays.
- Effort and regressor go through one low-pass and are thinned together, its ``decimate`` ("parallel filtering").
- Viscous and dry friction, the rotor's inertia and an offset of the effort freed, as its defaults are; least squares.
- The physically consistent fit (linear matrix inequalities, CVXOPT) is asked for beside it (``physical_fit``).
- Its "prediction" on data held out is of the effort along the measured motion; "execution" says only that numbers came out.
  Here it also runs freely, with J, gravity, friction and offset read off its regressor, as every other model is judged.

On EMPS it finds what was published of these recordings (docs/peers.md).
"""

from __future__ import annotations

import contextlib
import io
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, filtfilt

from harness.compare.peers.runs import NotForIt, Run, heldout_error, pushed, ways
from harness.compare.peers.servo_friction import swing_of_one_joint
from harness.system import JointType, System
from harness.system.write import write

Array = NDArray[np.float64]

ABOVE = (10.0, 30.0, 100.0)  # times the fastest swing, where positions are filtered
ORDER = 4
MOST_DECIMATED = 10  # its default
BORDER = 0.25  # s cut at either end, that the filter spoils
FREED = {"fv": "viscous", "fs": "dry", "off": "offset"}


@dataclass(frozen=True)
class Identified:
    """What it found. values, std: of base parameters by its own names [SI]. effort_rmse: left of the effort it was
    fitted to; prediction: of the effort held out [N·m or N]; physical: whether its physically consistent fit was
    feasible.

    inertia J, gravity's torque a cos q + b sin q + c, viscous, dry: of the free run; held: whether efforts stay from sample to
    sample.
    """

    values: Mapping[str, float]
    std: Mapping[str, float]
    effort_rmse: float
    prediction: float
    physical: bool
    inertia: float
    gravity: tuple[float, float, float]
    viscous: float
    dry: float
    held: bool

    def free_run(self, state: Array, time: Array, tau: Array | None) -> Array:
        """Positions (T, 1) from a state (2,)."""
        a, b, c = self.gravity
        out = swing_of_one_joint(
            state, time, pushed(time, tau, self.held) - c, self.inertia, a, b, self.viscous, self.dry
        )
        return out[:, None]


def fit_figaroh(
    system: System, train: Sequence[Run], heldout: Sequence[Run], frequency: float, held: bool | None = None
) -> Identified:
    """Base parameters of a rig of one joint from driven recordings, filtered where free runs over these are best.

    frequency: of its fastest swing [Hz]; where nothing pulls back, one hertz stands for it. held: whether efforts stay from
    sample to sample; None: whichever predicts better. Raises ImportError where
    FIGAROH is not installed, NotForIt where no effort is known or the joint is not alone.
    """
    if len(system.joint_names) != 1:
        raise NotForIt("it is asked about rigs of one joint")
    if not any(run.driven for run in train) or any(run.efforts is None for run in (*train, *heldout)):
        raise NotForIt("it needs a known effort: a free swing is the null vector of its regression")
    joint = system.movable_joints[0]
    if joint.type is JointType.CONTINUOUS:
        # Pinocchio has cosine and sine of such a joint as positions, FIGAROH one column a joint.
        system = system.replace_joint(replace(joint, type=JointType.REVOLUTE))
    found = []
    for way in ways(train, held):
        known, judged = ([run.at_samples(way) for run in some] for some in (train, heldout))
        found += [replace(_fitted(system, known, judged, above * frequency), held=way) for above in ABOVE]
    return min(found, key=lambda one: heldout_error(one.free_run, train))


def _fitted(system: System, train: Sequence[Run], heldout: Sequence[Run], cutoff: float) -> Identified:
    """The same, filtered at ``cutoff`` [Hz]."""
    from figaroh.identification.base_identification import BaseIdentification
    from figaroh.tools.load_robot import load_robot
    from figaroh.tools.regressor import build_regressor_basic, build_regressor_reduced

    fitted_to, judged_on = (_motion(runs, cutoff) for runs in (train, heldout))

    class OneRig(BaseIdentification):
        def load_trajectory_data(self, data_source: str | None = None) -> dict[str, Array]:
            return judged_on if data_source else fitted_to

        def process_kinematics_data(self, filter_config: Any = None) -> None:
            names = ("timestamps", "positions", "velocities", "accelerations")
            self.processed_data = {name: self.raw_data[name] for name in names}

    (name,) = system.joint_names
    step = float(np.median(np.diff(train[0].time)))
    factor = int(np.clip(0.5 / (cutoff * step), 1, MOST_DECIMATED))
    with (
        tempfile.TemporaryDirectory() as folder,
        contextlib.redirect_stdout(io.StringIO()),
        warnings.catch_warnings(),
    ):
        warnings.simplefilter("ignore")
        config = Path(folder) / "rig.yaml"
        config.write_text(_configuration(name), encoding="utf-8")
        model = Path(folder) / "rig.urdf"
        write(system, model)
        robot = load_robot(str(model), loader="figaroh")
        rig = OneRig(robot, str(config))
        # Not made by its configuration; the examples that come with it set them by hand, too.
        rig.identif_config |= {"act_idxq": [0], "act_idxv": [0]}
        rig.initialize()
        phi = rig.solve(decimate=True, decimation_factor=factor, plotting=False, save_results=False)
        labels = list(rig.result["base parameters names"])
        relative = np.asarray(rig.result["std dev of estimated param"], dtype=np.float64)

        def effort(q: Sequence[float], v: Sequence[float], a: Sequence[float]) -> Array:
            motion = [np.array(x, dtype=np.float64)[:, None] for x in (q, v, a)]
            whole = build_regressor_basic(robot, *motion, rig.identif_config)
            return np.asarray(build_regressor_reduced(whole, rig._idx_eliminated)[:, rig._base_indices] @ phi)

        # At rest at three angles, and accelerated: what its regressor makes of them is linear in J, a, b, c.
        rest = effort([0.0, 0.5 * np.pi, np.pi], [0.0] * 3, [0.0] * 3)
        inertia = float(effort([0.0], [0.0], [1.0])[0] - rest[0])
    slides = system.movable_joints[0].prismatic
    level = rest[0] if slides else 0.5 * (rest[0] + rest[2])
    a, b = (0.0, 0.0) if slides else (0.5 * (rest[0] - rest[2]), rest[1] - level)
    values = dict(zip(labels, map(float, phi), strict=True))
    std = {k: abs(v) * float(r) / 100.0 for (k, v), r in zip(values.items(), relative, strict=True)}
    told = rig.result.get("validation_metrics") or {}
    physical = any(s["stage"] == "physical" and s["status"] == "ok" for s in rig.result["stages"])
    return Identified(
        values, std, float(rig.result["effort rmse"]), float(told.get("rmse_identified", np.nan)), physical, inertia,
        (float(a), float(b), float(level)), values.get(f"fv_{name}", 0.0), values.get(f"fs_{name}", 0.0),
        held=False,
    )  # fmt: skip


def _motion(runs: Sequence[Run], cutoff: float) -> dict[str, Array]:
    """Recordings one after the other at an even step, their borders cut; those that are hardly more than borders left out."""
    pieces: list[tuple[Array, ...]] = []
    for run in runs:
        assert run.efforts is not None
        if run.time[-1] - run.time[0] < 4.0 * BORDER:
            continue
        step = float(np.median(np.diff(run.time)))
        time = np.arange(run.time[0], run.time[-1], step)
        q = np.interp(time, run.time, run.positions[:, 0])
        share = min(2.0 * cutoff * step, 0.8)
        q = filtfilt(*butter(ORDER, share), q)
        v = np.gradient(q, step)
        a = np.gradient(v, step)
        tau = np.interp(time, run.time, run.efforts[:, 0])
        cut = slice(round(BORDER / step), len(time) - round(BORDER / step))
        pieces.append((time[cut], q[cut], v[cut], a[cut], tau[cut]))
    t, q, v, a, tau = (np.concatenate(parts) for parts in zip(*pieces, strict=True))
    columns = {"positions": q, "velocities": v, "accelerations": a, "torques": tau}
    return {"timestamps": t, **{name: values[:, None] for name, values in columns.items()}}


def _configuration(joint: str) -> str:
    return f"""robot: {{name: rig}}
tasks:
  identification:
    enabled: true
    joints: {{active_joints: [{joint}]}}
    mechanics:
      friction_coefficients: {{viscous: [0.0], static: [0.0]}}
      actuator_inertias: [0.0]
      joint_offsets: [0.0]
      reduction_ratios: {{{joint}: 1.0}}
    coupling: {{has_coupled_wrist: false}}
    problem:
      model_components: {{friction: true, actuator_inertia: true, joint_offset: true}}
    signal_processing: {{sampling_frequency: 1000.0, cutoff_frequency: 100.0}}
    physical_fit: {{enabled: true}}
    data: {{validation_data_file: heldout}}
"""
