"""What peers say of the same cases: a parameter fit by ``mujoco.sysid``, greedy forward selection, sparse regression.

Each peer is given what a user would give it: the nominal model, the recordings, and the parameters that a user would free.
A peer *claims* an effect when the 95 % interval of its parameter leaves out the nominal value.
"""

from __future__ import annotations

import contextlib
import io
import json
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.signal import savgol_filter
from scipy.stats import norm

from harness.errors import missing_package
from harness.parallel import parallel_map
from harness.proof.concealments import CONCEALMENTS
from harness.proof.score import CaseScore

Array = NDArray[np.float64]
Z95 = float(norm.ppf(0.975))


def sysid_claims(folder: Path) -> dict[str, Any]:
    """Joint damping, quadratic damping and dry friction of every joint freed in ``mujoco.sysid``.

    Free runs from the first sample (position) and a fitted velocity cannot be given to it: it starts from the smoothed
    first velocity, as its examples do. Raises ImportError if the extra is not installed.
    """
    import mujoco
    from mujoco import sysid

    import harness
    from harness.system.write import write

    system = harness.load(folder / "model.toml")
    xml = folder / "model_for_sysid.xml"
    write(system, xml)
    spec = mujoco.MjSpec.from_file(str(xml))
    xml.unlink()
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    frames = [pd.read_csv(p) for p in sorted(folder.glob("run*.csv"))][:-1]
    step = float(np.median(np.diff(frames[0]["time"])))
    spec.option.timestep = min(step, 0.002)
    parameters = sysid.ParameterDict()
    for joint in system.joint_names:
        spec.add_sensor(
            name=f"{joint}_pos", type=mujoco.mjtSensor.mjSENS_JOINTPOS, objtype=mujoco.mjtObj.mjOBJ_JOINT, objname=joint
        )
        actuator = spec.add_actuator(name=f"{joint}_motor", target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        actuator.set_to_motor()
        j = system.joint(joint)
        scale = float(
            sum(link.mass for link in system.links) * 9.81 * max(np.linalg.norm(link.com) for link in system.links)
        )

        def damp(s: Any, p: Any, joint: str = joint) -> None:
            s.joint(joint).damping[0] = float(np.ravel(p.value)[0])

        def drag(s: Any, p: Any, joint: str = joint) -> None:
            s.joint(joint).damping[1] = float(np.ravel(p.value)[0])

        def rub(s: Any, p: Any, joint: str = joint) -> None:
            s.joint(joint).frictionloss = float(np.ravel(p.value)[0])

        # Its own advice: start off the bounds, or the optimizer stalls in that corner.
        parameters.add(sysid.Parameter(f"{joint}:viscous_damping", j.damping + 1e-4 * scale, 0.0, scale, modifier=damp))
        parameters.add(sysid.Parameter(f"{joint}:quadratic_drag", 1e-4 * scale, 0.0, scale, modifier=drag))
        parameters.add(sysid.Parameter(f"{joint}:coulomb_friction", 1e-4 * scale, 0.0, scale, modifier=rub))
    parameters.move_off_bounds()
    nominal = np.array([b for joint in system.joint_names for b in (system.joint(joint).damping, 0.0, 0.0)])
    model = spec.compile()
    names, states, controls, data = [], [], [], []
    for index, frame in enumerate(frames):
        time = np.arange(0.0, float(frame["time"].iloc[-1]), step)
        position = np.column_stack([np.interp(time, frame["time"], frame[f"{j}.position"]) for j in system.joint_names])
        effort = np.column_stack(
            [
                np.interp(time, frame["time"], frame[f"{j}.effort"]) if f"{j}.effort" in frame else np.zeros(len(time))
                for j in system.joint_names
            ]
        )
        window = min(21, len(time) // 2 * 2 - 1)
        velocity = savgol_filter(position, window, 3, deriv=1, delta=step, axis=0)[0]
        names.append(f"run{index}")
        states.append(sysid.create_initial_state(model, position[0], velocity))
        controls.append(sysid.TimeSeries.from_control_names(time, effort, model))
        data.append(sysid.TimeSeries.from_names(time, position, model, names=[f"{j}_pos" for j in system.joint_names]))
    sequences = sysid.ModelSequences("rig", spec, names, states, controls, data)
    residual = sysid.build_residual_fn(models_sequences=[sequences])
    with contextlib.redirect_stdout(io.StringIO()):
        fitted, result = sysid.optimize(parameters, residual, optimizer="mujoco", verbose=False)
    x = fitted.as_vector()
    jacobian = np.asarray(result.jac)
    r = np.asarray(result.fun if hasattr(result, "fun") else residual(x, fitted)[0]).ravel()
    variance = float(r @ r) / max(r.size - x.size, 1)
    covariance = np.linalg.pinv(jacobian.T @ jacobian) * variance
    std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    labels = list(fitted.parameters)
    claims = [
        label
        for label, value, base, s in zip(labels, x, nominal, std, strict=True)
        if s > 0.0 and abs(value - base) > Z95 * s and value > 0.0
    ]
    return {"claims": claims, "residual_rms": float(np.sqrt(variance))}


def regression_claims(folder: Path) -> dict[str, Any]:
    """Sparse regression (pysindy's sequentially thresholded least squares) on the residual torque along smoothed motion."""
    import pysindy

    import harness

    system = harness.load(folder / "model.toml")
    model = harness.Denoc(system)
    frame = pd.read_csv(sorted(folder.glob("run*.csv"))[0])
    time = frame["time"].to_numpy()
    step = float(np.median(np.diff(time)))
    window = max(7, int(0.1 / step) // 2 * 2 + 1)
    grid = np.arange(time[0], time[-1], step)
    q, v, a = (
        np.column_stack(
            [
                savgol_filter(np.interp(grid, time, frame[f"{j}.position"]), window, 4, deriv=d, delta=step)
                for j in system.joint_names
            ]
        )
        for d in (0, 1, 2)
    )
    torque = np.array([model.inverse_dynamics(*row) for row in zip(q, v, a, strict=True)])
    claims = []
    for k, joint in enumerate(system.joint_names):
        effort = np.interp(grid, time, frame[f"{joint}.effort"]) if f"{joint}.effort" in frame else 0.0
        y = effort - torque[:, k]
        terms = {
            "viscous_damping": v[:, k],
            "coulomb_friction": np.sign(v[:, k]),
            "quadratic_drag": v[:, k] * np.abs(v[:, k]),
            "constant_torque": np.ones(len(grid)),
            "joint_stiffness": q[:, k],
            "cubic_stiffness": q[:, k] ** 3,
            "inertia": a[:, k],
            "gravity": np.sin(q[:, k]),
        }
        library = np.column_stack(list(terms.values()))
        norms = np.linalg.norm(library, axis=0)
        optimizer = pysindy.STLSQ(threshold=0.1 * float(np.linalg.norm(y)), alpha=1e-6)
        with contextlib.redirect_stdout(io.StringIO()):
            optimizer.fit(library / norms, y.reshape(-1, 1))
        kept = np.abs(np.ravel(optimizer.coef_)) > 0.0
        claims += [f"{joint}:{name}" for name, keep in zip(terms, kept, strict=True) if keep]
    return {"claims": claims}


def greedy_claims(folder: Path) -> dict[str, Any]:
    """Greedy forward selection over the whole catalogue: the best effect is added as long as BIC falls, on training data alone.

    The usual recipe of identification: same simulator and likelihood as the diagnosis, but no backward step, no data held
    out, no test of what remains.
    """
    import harness
    from harness.diagnose.estimation.likelihood import Likelihood
    from harness.diagnose.prediction.predictor import Predictor
    from harness.diagnose.problem.candidates import candidates
    from harness.diagnose.problem.problem import pose
    from harness.diagnose.problem.windows import whole
    from harness.diagnose.selection.investigation import MOTION_HARMONICS, colours_from, crude_colours
    from harness.diagnose.selection.study import Study
    from harness.effects.scale import references
    from harness.recording import read_recordings

    system = harness.load(folder / "model.toml")
    recordings = read_recordings(sorted(folder.glob("run*.csv")), system=system)
    problem = pose(system, recordings)
    predictor = Predictor(problem)
    windows = whole(problem.runs, range(len(problem.train)))
    known = candidates(system, recordings)
    frequency = references(system, system.joint_names[0], recordings[0]).frequency / (2.0 * np.pi)
    likelihood = Likelihood(problem, crude_colours(problem), lead=0.0)
    first = Study(problem, predictor, likelihood, known, windows).empty()
    colours = colours_from(problem, likelihood, first, predictor, MOTION_HARMONICS * frequency)
    study = Study(problem, predictor, Likelihood(problem, colours, lead=0.0), known, windows, first_states=first.states)
    best = study.empty()
    log_n = float(np.log(study.samples))
    while len(best.hypothesis.members) < 5:
        ranked = study.ranked(best)
        if not ranked:
            break
        grown = study.extend(best, ranked[0])
        if best.score - grown.score < ranked[0].candidate.size * log_n:
            break
        best = grown
    return {"claims": [f"{m.site}:{m.effect.name}" for m in best.hypothesis.members]}


PEERS: dict[str, Callable[[Path], dict[str, Any]]] = {
    "mujoco.sysid": sysid_claims,
    "greedy forward selection": greedy_claims,
    "pysindy": regression_claims,
}


def ask(folder: Path, peer: str) -> dict[str, Any]:
    """One peer on one case; what goes wrong is an answer too."""
    try:
        return PEERS[peer](folder)
    except ImportError as error:
        return {"skipped": str(missing_package(error) or f"not installed: {error}")}
    except Exception as error:  # a peer may fail in any way; the proof says so and goes on
        return {"error": f"{type(error).__name__}: {error}"}


def to_ask(scores: Sequence[CaseScore], most: int) -> list[CaseScore]:
    """Cases that peers are asked about: clean ones, half of ``most`` at most, then single effects, tilted and late ones first.

    Tilts, late and shifted readings are what peers that fit damping and dry friction alone take for these. What a model states as
    an effect cannot be handed to them, nor can links that bend.
    """
    told = {"base_tilt": 0, "sensor_delay": 1, "sensor_offset": 2}
    scores = [s for s in scores if not s.name.startswith("flexible")]
    fit = [s for s in scores if s.kind == "single" and not CONCEALMENTS[s.planted[0][0]].stated]
    single = sorted(fit, key=lambda s: told.get(s.planted[0][0], len(told)))
    clean = [s for s in scores if s.kind == "clean"]
    kept = clean[: max(most // 2, most - len(single))]
    return kept + single[: most - len(kept)]


def compare_peers(
    out: Path,
    scores: Sequence[CaseScore],
    *,
    workers: int | None = None,
    dask: str | None = None,
    progress: Callable[[str, int, int], None] | None = None,
    most: int = 40,
) -> dict[str, Any]:
    """What each peer claims on clean cases and on those with one effect: shares right and wrong, and where.

    most: cases asked of each peer, see ``to_ask``.
    """
    chosen = to_ask(scores, most)
    result: dict[str, Any] = {}
    for peer in PEERS:
        saved = out / "peers" / f"{peer.replace(' ', '_')}.json"
        if saved.exists():
            answers = json.loads(saved.read_text(encoding="utf-8"))
        else:
            count = 0

            def tick(index: int, found: dict[str, Any], peer: str = peer) -> None:
                nonlocal count
                count += 1
                if progress is not None:
                    progress(peer, count, len(chosen))

            rows = parallel_map(
                partial(ask, peer=peer), [out / "cases" / s.name for s in chosen], workers=workers, dask=dask, done=tick
            )
            answers = {s.name: row for s, row in zip(chosen, rows, strict=True)}
            saved.parent.mkdir(parents=True, exist_ok=True)
            saved.write_text(json.dumps(answers, indent=1), encoding="utf-8")
        result[peer] = _tally(answers, {s.name: s for s in scores})
    return result


def _tally(answers: dict[str, dict[str, Any]], scores: dict[str, CaseScore]) -> dict[str, Any]:
    """Counts of a peer's claims against the answers."""
    clean = clean_false = single = named = false = failed = 0
    claimed: dict[str, dict[str, int]] = {}
    for name, answer in answers.items():
        if "claims" not in answer:
            failed += 1
            continue
        score = scores[name]
        effects = {claim.split(":", 1)[1] for claim in answer["claims"]}
        row = claimed.setdefault(score.planted[0][0] if score.planted else "nothing", {})
        for effect in effects or {"nothing"}:
            row[effect] = row.get(effect, 0) + 1
        if score.kind == "clean":
            clean += 1
            clean_false += bool(effects)
        else:
            single += 1
            true = {e for e, _ in score.planted}
            named += effects == true
            false += bool(effects - true)
    return {
        "asked": len(answers),
        "failed": failed,
        "clean_false": [clean_false, clean],
        "named_single": [named, single],
        "false_beside_single": [false, single],
        "claims": claimed,
    }
