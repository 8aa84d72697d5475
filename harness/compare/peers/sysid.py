"""``mujoco.sysid`` as its documentation and those who use it well run it; every choice has its source beside it.

What it is run on is the same for a proof and for real rigs. Sources, MuJoCo 4.0.0:

- its README and tutorial notebook, ``python/mujoco/sysid/README.md`` and ``sysid.ipynb``;
- its source, as installed: ``mujoco/sysid/_src``;
- its maintainers on a user's trouble with ``frictionloss``: github.com/google-deepmind/mujoco/issues/3284 and pull request 3287.

``tests/proof/test_sysid_peer.py`` runs its tutorial's first example to its own figure, and recovers a pendulum's
friction.
"""

from __future__ import annotations

import contextlib
import io
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.compare.peers.runs import Run, heldout_error, ways
from harness.system import Link, System
from harness.system.description import constant
from harness.system.write import write

Array = NDArray[np.float64]

STEP = (
    5e-3  # s at most; its examples take 2 ms with Euler, RK4 is a thousand times nearer at 5 ms for swings of a few Hz
)
# Where parameters of dissipation begin, in shares of their range. A maintainer in issue 3284: backends stall alike where friction
# or damping begins at 1e-8, and agree once it begins above; ``move_off_bounds`` puts what lies within 0.1 % of a bound at 5 %.
# On lightly damped swings 5 % of a range can be hundreds of times too much, so smaller ones are tried too, and nominal values.
STARTS: tuple[float | None, ...] = (None, 1e-4, 1.5e-3, 0.05)
DISSIPATION = ("viscous", "drag", "dry")
OFF_BOUND = 1e-4  # of a range: what pieces put at nothing goes on from there
# Two more starts are what pieces of that length [s] fit, from either end of ``STARTS``: its residual takes "trajectory chunks"
# (README, section 3), and users on recordings of robots cut them to half a second or one (issue 8 of
# github.com/iit-DLSLab/sim2real-robot-identification). Whole runs that come to rest have valleys that no start leads out of.
CHUNK = 0.5
# From each start, to tell which lies in the deepest valley; its own way to several starts is ``randomize``.
FIRST_ITERATIONS = 10
AWAY = 1e3  # spreads of what is measured: no residual is larger, of trials that run away least of all
ITERATIONS = 200  # from the best of them: the default of ``optimize``, and what the README's section 5 passes
# Mass and centre of mass, in shares of the stated ones: the default bounds of ``body_inertia_param`` for a mass; its centre may
# move half a metre either way there, which on small rigs is more.
SHARES = (0.1, 10.0)
MODELS_KEPT = 100  # those of one Jacobian, so that every run is asked of the same
# What is known within a tolerance. A free swing shows inertia over weight alone, which the centre of mass moves; a known effort
# shows both, and one number cannot say two.
FREE: tuple[tuple[str, ...], ...] = (("com",),)
DRIVEN: tuple[tuple[str, ...], ...] = (("com",), ("com", "mass"))
# The same of real rigs, of which many state no rotor; by whether they are driven.
REAL: Mapping[bool, tuple[tuple[str, ...], ...]] = {
    False: (("com",), ("armature",)),
    True: (("armature",), ("com", "armature"), ("com", "mass")),
}
ALPHA = 0.05  # of ``calculate_intervals``, and of its report
WHAT = {
    "viscous": "viscous_damping", "drag": "quadratic_drag", "dry": "coulomb_friction", "bias": "sensor_offset",
    "constant": "constant_torque",
}  # fmt: skip


@dataclass(frozen=True)
class Sysid:
    """What ``mujoco.sysid`` found.

    values, half: by ``joint:parameter`` (viscous, drag, dry, bias, constant, com, mass, armature), estimate and half its 95 %
    interval, SI; ``half`` is infinite where the data do not say. nominal: where the published model is. objective: half the sum
    of squares that is left, residuals in units of the channel's spread. rmse: positions of the free runs fitted [rad or
    m].
    """

    model: Any
    joints: tuple[str, ...]
    values: Mapping[str, float]
    half: Mapping[str, float]
    nominal: Mapping[str, float]
    objective: float
    rmse: float
    held: bool

    def beyond(self, factor: float = 1.0) -> list[str]:
        """Parameters of dissipation, zeros and constants whose interval, ``factor`` times as wide, leaves out the nominal
        value."""
        return [
            name
            for name, half in self.half.items()
            if name.split(":")[-1] in WHAT and 0.0 < factor * half < abs(self.values[name] - self.nominal[name])
        ]

    def free_run(self, state: Array, time: Array, tau: Array | None) -> Array:
        """Positions as they read (T, n) in MuJoCo from a state as it reads (2n,), at its own step, interpolated to
        ``time``."""
        import mujoco

        n = len(self.joints)
        bias = np.array([self.values.get(f"{j}:bias", 0.0) for j in self.joints])
        data = mujoco.MjData(self.model)
        data.qpos[:], data.qvel[:] = state[:n] - bias, state[n:]
        step = float(self.model.opt.timestep)
        grid = time[0] + step * np.arange(int(np.ceil((time[-1] - time[0]) / step)) + 2)
        control = np.zeros((len(grid), n)) if tau is None else _controls(grid, time, tau, self.held)
        out = np.empty((len(grid), n))
        for k in range(len(grid)):
            out[k] = data.qpos
            data.ctrl[:] = control[k]
            mujoco.mj_step(self.model, data)
        return np.stack([np.interp(time, grid, out[:, j]) for j in range(n)], axis=1) + bias

    def predicts(self, runs: Sequence[Run]) -> float:
        """Error of free runs over recordings, their first states fitted [rad or m]."""
        return heldout_error(self.free_run, runs)


def _controls(grid: Array, time: Array, tau: Array, held: bool) -> Array:
    """Efforts (G, n) that act from each instant of the grid to the next.

    ``model_residual`` resamples controls linearly to the step, and MuJoCo holds them over it: a command held by a
    controller becomes a ramp, one that is smooth is half a step late. So they are given on the grid: held ones as the
    sample before, smooth ones at the middle of each step.
    """
    if held:
        return tau[np.clip(np.searchsorted(time, grid + 1e-9, side="right") - 1, 0, len(time) - 1)]
    middle = grid + 0.5 * float(grid[1] - grid[0])
    return np.stack([np.interp(middle, time, u) for u in tau.T], axis=1)


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
    if length == 0.0:
        return system
    about = float(axis @ link.inertia @ axis) + link.mass * length**2
    reach = about / (link.mass * length)
    body = Link(link.name, link.mass * length / reach, constant(arm * (reach / length)), constant(1e-9 * np.eye(3)))
    return system.replace_link(body)


@dataclass(frozen=True)
class _Rig:
    """The nominal model as MuJoCo has it, and sizes that set bounds, each (n,).

    inertia: about each joint at zero [kg·m² or kg]; weight: the largest force by gravity; pull: by gravity or drive;
    fastest: speed; spread: of what is measured. driven: whether an effort is known.
    """

    system: System
    spec: Any
    inertia: Array
    weight: Array
    pull: Array
    fastest: Array
    spread: Array
    driven: bool

    @property
    def biased(self) -> NDArray[np.bool_]:
        """Joints whose zero shows, through gravity; elsewhere it only shifts the first state, (n,)."""
        return self.weight > 1e-6 * self.pull


def _rig(system: System, runs: Sequence[Run], step: float) -> _Rig:
    import mujoco

    system = _acceptable(system)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.xml"
        write(system, path)
        spec = mujoco.MjSpec.from_file(str(path))
    # The default Euler takes energy out of a swing that is then missing from the damping; RK4 is its documented remedy (Numerical
    # integration in the manual's chapter on computation).
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.timestep = step
    for joint in system.joint_names:
        spec.add_sensor(
            name=f"{joint}_pos", type=mujoco.mjtSensor.mjSENS_JOINTPOS, objtype=mujoco.mjtObj.mjOBJ_JOINT, objname=joint
        )
        spec.add_actuator(name=f"{joint}_motor", target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT).set_to_motor()
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    pull = np.zeros(model.nv)
    for angle in np.linspace(0.0, 2.0 * np.pi, 9)[:-1]:
        data.qpos[:] = angle
        mujoco.mj_forward(model, data)
        pull = np.maximum(pull, np.abs(data.qfrc_bias))
    weight = pull
    for run in runs:
        if run.efforts is not None:
            pull = np.maximum(pull, np.max(np.abs(run.efforts), axis=0))
    speeds = [np.abs(np.diff(r.thinned().positions, axis=0) / np.diff(r.thinned().time)[:, None]) for r in runs]
    fastest = np.maximum(np.max([np.quantile(s, 0.99, axis=0) for s in speeds], axis=0), 1e-6)
    spread = np.std(np.concatenate([r.positions for r in runs]), axis=0)
    driven = any(r.driven for r in runs)
    return _Rig(system, spec, np.diag(mass).copy(), weight, np.maximum(pull, 1e-9), fastest, spread, driven)


def _parameters(rig: _Rig, runs: int, inertial: Sequence[str]) -> tuple[Any, dict[str, float]]:
    """What is freed, and its nominal values.

    Damping, quadratic damping and dry friction of every joint, from nothing to what would swallow the whole force at full
    speed ("box constraints enforce physical plausibility", README; no figure is given for friction);
    the encoder's bias (the README's measurement parameters), of any size within the motion; where something drives, a constant
    force up to the largest ("anything settable on MjSpec can be identified", README; drives have an offset, which FIGAROH frees
    by default); centre of mass, mass or armature, since a model is known within a tolerance only and a period that is off would
    have to be made up for by friction (its own test frees armatures of 0.1 to 0.5 kg·m² between 0.001 and 1; here up to twice
    what the joint moves); the first state of every run, which its examples know exactly and a recording does not, within the
    spread and the speeds of the motion.
    """
    import mujoco
    from mujoco import sysid

    parameters = sysid.ParameterDict()
    nominal: dict[str, float] = {}
    for k, name in enumerate(rig.system.joint_names):
        joint = rig.system.joint(name)
        link = rig.system.link(joint.child)

        def damp(s: Any, p: Any, joint: str = name) -> None:
            s.joint(joint).damping[0] = float(np.ravel(p.value)[0])

        def drag(s: Any, p: Any, joint: str = name) -> None:
            s.joint(joint).damping[1] = float(np.ravel(p.value)[0])

        def rub(s: Any, p: Any, joint: str = name) -> None:
            s.joint(joint).frictionloss = float(np.ravel(p.value)[0])

        def rotor(s: Any, p: Any, joint: str = name) -> None:
            s.joint(joint).armature = float(np.ravel(p.value)[0])

        def push(s: Any, p: Any, motor: str = f"{name}_motor") -> None:
            s.actuator(motor).biastype = mujoco.mjtBias.mjBIAS_AFFINE
            s.actuator(motor).biasprm[0] = float(np.ravel(p.value)[0])

        def centre(s: Any, p: Any, body: str = link.name, com: Array = link.com) -> None:
            s.body(body).ipos[:] = com * float(np.ravel(p.value)[0])

        def weigh(s: Any, p: Any, body: str = link.name, mass: float = link.mass) -> None:
            # As its ``body_inertia_param`` of the kind Mass does, the inertia in proportion.
            factor, at = float(np.ravel(p.value)[0]), s.body(body)
            at.mass = mass * factor
            at.inertia[:] *= factor
            at.fullinertia[:] *= factor

        most = {"viscous": rig.pull[k] / rig.fastest[k], "drag": rig.pull[k] / rig.fastest[k] ** 2, "dry": rig.pull[k]}
        stated = {"viscous": joint.damping, "drag": 0.0, "dry": joint.friction}
        for what, modifier in (("viscous", damp), ("drag", drag), ("dry", rub)):
            top = max(float(most[what]), 2.0 * stated[what])
            parameters.add(sysid.Parameter(f"{name}:{what}", stated[what], 0.0, top, modifier=modifier))
            nominal[f"{name}:{what}"] = stated[what]
        if rig.biased[k]:
            parameters.add(sysid.Parameter(f"{name}:bias", 0.0, -rig.spread[k] or -0.1, rig.spread[k] or 0.1))
            nominal[f"{name}:bias"] = 0.0
        if rig.driven:
            parameters.add(sysid.Parameter(f"{name}:constant", 0.0, -rig.pull[k], rig.pull[k], modifier=push))
            nominal[f"{name}:constant"] = 0.0
        if "com" in inertial and np.any(link.com):
            parameters.add(sysid.Parameter(f"{name}:com", 1.0, *SHARES, modifier=centre))
            nominal[f"{name}:com"] = 1.0
        if "mass" in inertial:
            parameters.add(sysid.Parameter(f"{name}:mass", 1.0, *SHARES, modifier=weigh))
            nominal[f"{name}:mass"] = 1.0
        if "armature" in inertial:
            top = joint.armature + 2.0 * float(rig.inertia[k])
            parameters.add(sysid.Parameter(f"{name}:armature", joint.armature, 0.0, top, modifier=rotor))
            nominal[f"{name}:armature"] = joint.armature
    spread = np.maximum(rig.spread, 1e-6)
    for r in range(runs):
        n = len(rig.system.joint_names)
        parameters.add(sysid.Parameter(f"run{r}:position", np.zeros(n), -spread, spread))
        parameters.add(sysid.Parameter(f"run{r}:velocity", np.zeros(n), -rig.fastest, rig.fastest))
    return parameters, nominal


def _residual(rig: _Rig, runs: Sequence[Run], step: float, held: bool) -> Any:
    """Residuals over all runs, as ``optimize`` wants them: (x, parameters) -> (list of residuals, predictions,
    records).

    Built from ``build_residual_fn`` with the two overrides that its README names. ``custom_rollout`` starts each run
    where its first state's parameters say. ``modify_residual`` because (1) ``arrays2traj`` stamps MjSensor values with
    the time of the state that follows them ("sensordata times are shifted by one time step"), while positions out of
    the state have their own; (2) ``normalize_residual`` divides by the norm of what was measured: an angle that is far
    from zero counts less, one that stands still gives nan; here all are divided by the spread over all runs, still ones
    by one; (3) the bias is added. A run begins where its first reading is less the bias: a bias that moved the whole run against
    its first state would take both at once, in steps that no Gauss-Newton iteration finds.
    """
    from mujoco import sysid

    n = len(rig.system.joint_names)
    spread = np.where(rig.spread > 1e-9, rig.spread, 1.0)
    model = rig.spec.compile()
    compiled = _Compiled()
    parts = []

    def biases(p: Any) -> Array:
        named = zip(rig.system.joint_names, rig.biased, strict=True)
        return np.array([float(p[f"{j}:bias"].value[0]) if biased else 0.0 for j, biased in named])

    for r, run in enumerate(runs):
        time = run.time - run.time[0]
        grid: Array = np.arange(int(np.ceil(time[-1] / step - 1e-9)) + 2, dtype=np.float64) * step
        control = np.zeros((len(grid), n)) if run.efforts is None else _controls(grid, time, run.efforts, held)
        first = run.first_state()
        state = sysid.create_initial_state(model, first[:n], first[n:])
        names = [f"{j}_pos" for j in rig.system.joint_names]
        sequence = sysid.ModelSequences(
            "rig", rig.spec, f"run{r}", state, sysid.TimeSeries.from_control_names(grid, control, model),
            sysid.TimeSeries.from_names(time, run.positions, model, names=names),
        )  # fmt: skip

        def rollout(
            *,
            initial_states: Any,
            param_dicts: Any,
            models: Any,
            datas: Any,
            control_signal: Any,
            r: int = r,
            **mappings: Any,
        ) -> Any:
            begun = []
            for start, p in zip(initial_states, param_dicts, strict=True):
                moved = np.array(start, dtype=np.float64)
                moved[1 : 1 + n] += p[f"run{r}:position"].value - biases(p)
                moved[1 + n : 1 + 2 * n] += p[f"run{r}:velocity"].value
                begun.append(moved)
            return _rolled_out(begun, models, datas, control_signal, mappings)

        def differ(
            p: Any, predicted: Any, measured: Any, model: Any, everything: bool = False, *, state: Any, r: int = r,
            first: Array = first, **_: Any,
        ) -> Any:  # fmt: skip
            bias = biases(p)
            begin = first[:n] + p[f"run{r}:position"].value - bias
            times = np.r_[0.0, state[:, 0]]
            path = np.vstack([begin, state[:, 1 : 1 + n]])
            at = np.stack([np.interp(measured.times, times, x) for x in path.T], axis=1) + bias
            told = sysid.TimeSeries(measured.times, at, measured.signal_mapping)
            left = np.nan_to_num((at - measured.data) / spread, nan=AWAY, posinf=AWAY, neginf=-AWAY)
            return np.clip(left, -AWAY, AWAY), told, measured

        # One thread: results of its rollouts do not depend on their number, and a proof runs many at once.
        parts.append(
            sysid.build_residual_fn(
                models_sequences=[sequence],
                build_model=compiled,
                custom_rollout=rollout,
                modify_residual=differ,
                n_threads=1,
            )
        )

    def every(x: Array, parameters: Any) -> Any:
        found = [_apart(part, r, x, parameters) for r, part in enumerate(parts)]
        return [r for f in found for r in f[0]], [p for f in found for p in f[1]], [m for f in found for m in f[2]]

    return every


def _rolled_out(
    states: Sequence[Array], models: Any, datas: Any, controls: Any, mappings: Mapping[str, Any]
) -> list[Any]:
    """Runs from first states, one a model; of one that its step cannot follow there are no numbers.

    Such numbers are tried at times. MuJoCo's ``rollout`` repeats the last state from there on, its time too, which ``TimeSeries``
    refuses, and the whole fit would end with it. It is a bad trial among others.
    """
    from mujoco import sysid

    def run(some: slice) -> list[Any]:
        told = {"models": models[some], "control_signal": controls[some], "initial_states": states[some]}
        return list(sysid.sysid_rollout(datas=datas, **told, **mappings))

    try:
        return run(slice(None))
    except ValueError:
        if len(states) > 1:
            return [
                one
                for k in range(len(states))
                for one in _rolled_out(states[k : k + 1], models[k : k + 1], datas, controls[k : k + 1], mappings)
            ]
        nowhere = np.full((len(controls[0].times), len(states[0])), np.nan)
        nowhere[:, 0] = controls[0].times + float(models[0].opt.timestep)
        return [SimpleNamespace(state=SimpleNamespace(data=nowhere), sensordata=None)]


def _apart(part: Any, run: int, x: Array, parameters: Any) -> Any:
    """Residuals of one run, which is asked with its own parameters alone: of columns that differ in other runs' first states,
    one is simulated for all."""
    states = ("position", "velocity")
    own = {name: name.split(":")[-1] not in states or name.startswith(f"run{run}:") for name, _ in parameters.items()}
    rows = np.concatenate([np.full(p.size, own[name]) for name, p in parameters.items()])
    kept = type(parameters)({name: p for name, p in parameters.items() if own[name]})
    if x.ndim == 1 or x.shape[1] == 1:
        return part(x[rows], kept)
    _, first, same = np.unique(x[rows], axis=1, return_index=True, return_inverse=True)
    left, told, measured = part(x[np.ix_(rows, first)], kept)
    return [np.asarray(r)[:, np.ravel(same)] for r in left], told, measured


def _compiled(parameters: Any, spec: Any) -> Any:
    """The model with these parameters, of a copy: modifiers write into the spec that they are given, where what one set of
    parameters wrote (``apply_param_modifiers``) would stay for the next."""
    from mujoco import sysid

    return sysid.apply_param_modifiers(parameters, spec.copy())


class _Compiled:
    """The same, made once for all runs: they differ in their first states, which are no part of a model."""

    def __init__(self) -> None:
        self._made: dict[tuple[tuple[float, ...], ...], Any] = {}

    def __call__(self, parameters: Any, spec: Any) -> Any:
        key = tuple(tuple(np.ravel(p.value)) for _, p in parameters.items() if p.modifier is not None)
        if key not in self._made:
            if len(self._made) >= MODELS_KEPT:
                self._made.clear()
            self._made[key] = _compiled(parameters, spec)
        return self._made[key]


def _begun(parameters: Any, start: float | None) -> Any:
    """The parameters where a start of ``STARTS`` has them."""
    begun = parameters.copy()
    if start is not None:
        begun.move_off_bounds()
        for name, p in begun.items():
            if name.split(":")[-1] in DISSIPATION:
                p.update_from_vector(p.min_value + start * (p.max_value - p.min_value))
    return begun


def _as_in(parameters: Any, fitted: Any, names: Sequence[str]) -> Any:
    """The parameters with what a fit says of those named, dissipation a little off its bounds."""
    begun = parameters.copy()
    for name in names:
        low, high = begun[name].min_value, begun[name].max_value
        share = (fitted[name].as_vector() - low) / (high - low)
        if name.split(":")[-1] in DISSIPATION:
            share = np.maximum(share, OFF_BOUND)
        begun[name].update_from_vector(low + share * (high - low))
    return begun


def _optimized(parameters: Any, residual: Any, iterations: int) -> tuple[Any, Any, float]:
    """Fitted parameters, the optimizer's result, and half the sum of squares.

    The default optimizer of its examples. Parameters differ by many orders of magnitude: ``x_scale="jac"`` is what
    ``optimize`` itself advises for ill-conditioned problems.
    """
    from mujoco import sysid

    with contextlib.redirect_stdout(io.StringIO()):
        fitted, result = sysid.optimize(
            parameters, residual, optimizer="mujoco", verbose=False, max_iters=iterations, x_scale="jac"
        )
    left = np.concatenate([np.ravel(part) for part in residual(fitted.as_vector(), fitted)[0]])
    return fitted, result, 0.5 * float(left @ left)


def fit_sysid(
    system: System,
    recordings: Sequence[Run],
    *,
    window: float | None = None,
    left_out: Sequence[Sequence[tuple[float, float]]] = (),
    held: bool | None = None,
    inertial: Sequence[Sequence[str]] | None = None,
    starts: Sequence[float | None] = STARTS,
) -> Sysid:
    """A rig's dissipation fitted by ``mujoco.sysid`` to free runs over the recordings, or over windows of them.

    window [s]; left_out: stretches of each recording [s]. held: whether efforts stay from sample to sample; None: whichever
    fits better. inertial: sets out of ``com``, ``mass`` and ``armature``, tried in turn; the best fit is kept; None: ``FREE`` or
    ``DRIVEN``. starts: see ``STARTS``; from a single one, nothing else is tried. Raises ImportError where the package is not
    installed.
    """
    from absl import logging
    from mujoco import sysid

    logging.set_verbosity(logging.ERROR)
    gaps = left_out or [()] * len(recordings)
    runs, pieces = (
        [w.thinned() for r, g in zip(recordings, gaps, strict=True) for w in r.cut(length, g)]
        for length in (window, CHUNK if window is None else min(window, CHUNK))
    )
    # A step that the samples fall on, where they are even.
    interval = float(np.median(np.diff(runs[0].time)))
    step = interval / max(1, int(np.ceil(interval / STEP - 1e-6)))
    rig = _rig(system, runs, step)
    inertial = inertial or (DRIVEN if rig.driven else FREE)
    best: tuple[float, Any, dict[str, float], Any, bool] | None = None
    for freed in inertial:
        # The first set says whether efforts are held.
        for way in ways(runs, held if best is None else best[-1]):
            residual, in_pieces = (_residual(rig, some, step, way) for some in (runs, pieces))
            parameters, nominal = _parameters(rig, len(runs), freed)
            of_pieces, _ = _parameters(rig, len(pieces), freed)
            begins = [_begun(parameters, start) for start in starts]
            if len(starts) > 1 and len(pieces) > len(runs):
                for start in dict.fromkeys((starts[0], starts[-1])):
                    fitted, _, _ = _optimized(_begun(of_pieces, start), in_pieces, FIRST_ITERATIONS)
                    begins.append(_as_in(parameters, fitted, list(nominal)))
            for begun in begins:
                fitted, _, objective = _optimized(begun, residual, FIRST_ITERATIONS)
                if best is None or objective < best[0]:
                    best = objective, fitted, nominal, residual, way
    assert best is not None
    _, fitted, nominal, residual, way = best
    fitted, result, objective = _optimized(fitted, residual, ITERATIONS)
    left = residual(fitted.as_vector(), fitted)[0]
    with np.errstate(all="ignore"):
        _, half = sysid.calculate_intervals([np.ravel(x) for x in left], np.asarray(result.jac), alpha=ALPHA)
    values: dict[str, float] = {}
    halves: dict[str, float] = {}
    at = 0
    for name, p in fitted.items():
        if name in nominal:
            values[name], halves[name] = float(p.value[0]), float(half[at])
        at += p.size
    model = _compiled(fitted, rig.spec)
    n = len(system.joint_names)
    scaled = np.concatenate([np.reshape(x, (-1, n)) for x in left]) * np.where(rig.spread > 1e-9, rig.spread, 1.0)
    return Sysid(model, system.joint_names, values, halves, nominal, objective, float(np.sqrt(np.mean(scaled**2))), way)
