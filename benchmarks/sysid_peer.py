"""The peer: damping, quadratic damping and dry friction of every joint freed in ``mujoco.sysid``, on recordings."""

from __future__ import annotations

import contextlib
import io
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.recording import Recording
from harness.system import Link, System
from harness.system.description import constant
from harness.system.write import write

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Peer:
    """What ``mujoco.sysid`` found: its model, and values with standard deviations by ``joint:parameter``."""

    model: Any
    joints: tuple[str, ...]
    values: dict[str, float]
    std: dict[str, float]

    def free_run(self, state: Array, time: Array, tau: Array | None) -> Array:
        """Positions (T, n) in MuJoCo from a state (2n,), at its own step, interpolated to ``time``."""
        import mujoco

        n = len(self.joints)
        data = mujoco.MjData(self.model)
        data.qpos[:], data.qvel[:] = state[:n], state[n:]
        step = float(self.model.opt.timestep)
        count = int(np.ceil((time[-1] - time[0]) / step)) + 2
        grid = time[0] + step * np.arange(count)
        control = np.zeros((count, n))
        if tau is not None:
            for j in range(n):
                control[:, j] = np.interp(grid, time, tau[:, j])
        out = np.empty((count, n))
        for k in range(count):
            out[k] = data.qpos
            data.ctrl[:] = control[k]
            mujoco.mj_step(self.model, data)
        return np.stack([np.interp(time, grid, out[:, j]) for j in range(n)], axis=1)


def _acceptable(system: System) -> System:
    """A pendulum whose stated inertia no body can have, as the point mass with the same moments about its joint.

    MuJoCo refuses the former; the joint feels no difference.
    """
    if not system.notes or len(system.joint_names) != 1:
        return system
    joint = system.movable_joints[0]
    link = system.link(joint.child)
    axis, com = joint.axis, link.com
    arm = com - axis * float(axis @ com)
    length = float(np.linalg.norm(arm))
    about = float(axis @ link.inertia @ axis) + link.mass * length**2
    reach = about / (link.mass * length)
    body = Link(link.name, link.mass * length / reach, constant(arm * (reach / length)), constant(1e-9 * np.eye(3)))
    return system.replace_link(body)


def fit_sysid(system: System, recordings: Sequence[Recording], measured: Any, first_state: Any) -> Peer:
    """Fit in ``mujoco.sysid`` as its examples do: free runs over the whole recordings from a smoothed first state.

    measured: (system, recording) -> positions and efforts (T, n); first_state: (system, time, positions) ->
    (2n,). Raises ImportError where the package is not installed.
    """
    import mujoco
    from mujoco import sysid

    system = _acceptable(system)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.xml"
        write(system, path)
        spec = mujoco.MjSpec.from_file(str(path))
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    step = min(0.004, max(0.001, min(r.interval for r in recordings)))
    spec.option.timestep = step
    parameters = sysid.ParameterDict()
    scale = float(sum(k.mass for k in system.links) * 9.81 * max(float(np.linalg.norm(k.com)) for k in system.links))
    for joint in system.joint_names:
        spec.add_sensor(
            name=f"{joint}_pos", type=mujoco.mjtSensor.mjSENS_JOINTPOS, objtype=mujoco.mjtObj.mjOBJ_JOINT, objname=joint
        )
        spec.add_actuator(name=f"{joint}_motor", target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT).set_to_motor()

        def damp(s: Any, p: Any, joint: str = joint) -> None:
            s.joint(joint).damping[0] = float(np.ravel(p.value)[0])

        def drag(s: Any, p: Any, joint: str = joint) -> None:
            s.joint(joint).damping[1] = float(np.ravel(p.value)[0])

        def rub(s: Any, p: Any, joint: str = joint) -> None:
            s.joint(joint).frictionloss = float(np.ravel(p.value)[0])

        start = max(system.joint(joint).damping, 1e-4 * scale)
        parameters.add(sysid.Parameter(f"{joint}:damping", start, 0.0, scale, modifier=damp))
        parameters.add(sysid.Parameter(f"{joint}:quadratic damping", 1e-4 * scale, 0.0, scale, modifier=drag))
        parameters.add(sysid.Parameter(f"{joint}:frictionloss", 1e-3 * scale, 0.0, scale, modifier=rub))
    parameters.move_off_bounds()
    model = spec.compile()
    names, states, controls, data = [], [], [], []
    n = len(system.joint_names)
    for index, recording in enumerate(recordings):
        time = np.arange(0.0, recording.duration, step)
        recorded, tau = measured(system, recording)
        position = np.stack([np.interp(time, recording.time, p) for p in recorded.T], axis=1)
        effort = np.zeros((len(time), n))
        if tau is not None:
            effort = np.stack([np.interp(time, recording.time, u) for u in tau.T], axis=1)
        state = first_state(system, recording.time, recorded)
        names.append(f"run{index}")
        states.append(sysid.create_initial_state(model, state[:n], state[n:]))
        controls.append(sysid.TimeSeries.from_control_names(time, effort, model))
        data.append(sysid.TimeSeries.from_names(time, position, model, names=[f"{j}_pos" for j in system.joint_names]))
    sequences = sysid.ModelSequences("rig", spec, names, states, controls, data)
    residual = sysid.build_residual_fn(models_sequences=[sequences])
    with contextlib.redirect_stdout(io.StringIO()):
        fitted, result = sysid.optimize(parameters, residual, optimizer="mujoco", verbose=False)
    x = fitted.as_vector()
    jacobian = np.asarray(result.jac)
    left = np.concatenate([np.ravel(part) for part in residual(x, fitted)[0]])
    covariance = np.linalg.pinv(jacobian.T @ jacobian) * float(left @ left) / max(left.size - x.size, 1)
    labels = list(fitted.parameters)
    for label, value in zip(labels, x, strict=True):
        joint, what = label.split(":")
        if what == "frictionloss":
            spec.joint(joint).frictionloss = float(value)
        else:
            spec.joint(joint).damping[0 if what == "damping" else 1] = float(value)
    std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return Peer(
        spec.compile(),
        system.joint_names,
        dict(zip(labels, map(float, x), strict=True)),
        dict(zip(labels, map(float, std), strict=True)),
    )
