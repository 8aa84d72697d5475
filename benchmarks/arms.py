"""Arms of six and seven joints with one effect concealed at one of them: is it named, at the right joint, and how fast?

    python benchmarks/arms.py draw --seed N --out DIR        # conceal, seal, publish digests
    python benchmarks/arms.py run DIR --way fit-effort       # or unstated, motion; one process a case, resumed where it was stopped
    python benchmarks/arms.py grow --out DIR                 # time over joints, samples and recordings
    python benchmarks/arms.py table DIR                      # into reference/arms.json and docs/performance.md

Recordings are MuJoCo's of published arms (package example-robot-data): positions and torques, 30 s at 250 Hz, two of them, dry
and viscous friction at every joint, which the nominal model states but for the way "unstated", where all of it is to be named as
well. Torques are held between samples; both have noise.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import secrets
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray
from pages import put

from harness.cases.robots import files
from harness.proof.seal import digest, unseal
from harness.system import JointType, System, load
from harness.system.write import write

Array = NDArray[np.float64]
ROOT = Path(__file__).parents[1]
REFERENCE, PAGE = ROOT / "reference" / "arms.json", ROOT / "docs" / "performance.md"

# File, how many joints of the arm move, and the middle of their motion [rad].
ARMS: dict[str, tuple[str, tuple[float, ...]]] = {
    "ur5": ("ur_description/urdf/ur5_robot.urdf", (0.0, -1.2, 1.4, -0.8, 1.2, 0.0)),
    "z1": ("z1_description/urdf/z1.urdf", (0.0, 1.5, -1.4, 0.0, 0.0, 0.0)),
    "panda": ("panda_description/urdf/panda.urdf", (0.0, 0.0, 0.0, -1.6, 0.0, 1.8, 0.0)),
    "xarm7": ("xarm_description/urdf/xarm7.urdf", (0.0, 0.0, 0.0, 1.5, 0.0, 0.8, 0.0)),
}
DURATION, RATE, STEP = 30.0, 250.0, 5e-4
SWING, HARMONICS, BASE = 0.6, 5, 0.1  # rad, number, Hz: of the Fourier series that joints follow (Swevers et al. 1997)
ENCODER, TORQUE = 5e-5, 0.01  # rad; share of a joint's RMS torque: noise
HOLD = 30.0  # 1/s: feedback of the position over a joint's stated damping
FRICTION, DAMPING = 0.05, 0.05  # share of a joint's RMS torque, dry and (at its RMS speed) viscous, stated by the model
# What is concealed makes up so much of a joint's RMS torque.
LEAST, MOST = 0.06, 0.2
EFFECTS = (
    "coulomb_friction", "viscous_damping", "quadratic_drag", "joint_stiffness", "constant_torque", "cogging_torque",
    "added_inertia", "actuator_gain",
)  # fmt: skip
LIMIT = 60.0  # s, for a diagnosis of the motion
WAYS = {
    "fit-effort": ("--fit-effort", "--time-limit", "inf"),
    "unstated": ("--fit-effort", "--time-limit", "inf"),
    "motion": ("--time-limit", f"{LIMIT:g}"),
}


@dataclass(frozen=True)
class Hidden:
    """What is concealed, in the catalogue's words and SI."""

    effect: str
    joint: int
    parameters: dict[str, float]

    def torque(self, q: Array, v: Array, a: Array, effort: Array) -> Array:
        """Torque on the joint, of the joint's motion and of what is recorded as its effort."""
        p, e = self.parameters, self.effect
        if e == "coulomb_friction":
            return -p["torque"] * np.sign(v)
        if e == "viscous_damping":
            return -p["coefficient"] * v
        if e == "quadratic_drag":
            return -p["coefficient"] * v * np.abs(v)
        if e == "joint_stiffness":
            return -p["stiffness"] * (q - p["rest_angle"])
        if e == "constant_torque":
            return np.full_like(q, p["torque"])
        if e == "cogging_torque":
            return p["amplitude"] * np.sin(p["periods"] * q + p["phase"])
        if e == "added_inertia":
            return -p["inertia"] * a
        return (p["gain"] - 1.0) * effort


def arm(name: str, joints: int | None = None) -> System:
    """The published arm, its fingers and what is beyond ``joints`` of it held still, without limits."""
    file, middle = ARMS[name]
    system = load(files()[file], physical=False)
    moving = system.joint_names[: len(middle) if joints is None else joints]
    held = {"type": JointType.FIXED, "damping": 0.0, "friction": 0.0, "mimic": None}
    free = {"lower": -np.inf, "upper": np.inf}
    parts = [
        j if j.type is JointType.FIXED else replace(j, **(free if j.name in moving else held)) for j in system.joints
    ]
    return replace(system, joints=tuple(parts), name=name)


def compiled(model: Path) -> mujoco.MjModel:
    """MuJoCo's reading of a URDF, at this benchmark's step."""
    spec = mujoco.MjSpec.from_file(str(model))
    spec.option.timestep = STEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    made: mujoco.MjModel = spec.compile()
    # As nearly dry as this step allows: by default MuJoCo's friction gives way, by some tenths of a radian a second where a joint
    # carries little inertia, which would be a second effect that no model states.
    made.dof_solref[:] = 2.0 * STEP, 1.0
    made.dof_solimp[:, :2] = 0.999
    return made


def wanted(rng: np.random.Generator, middle: Array, time_: Array) -> tuple[Array, Array, Array]:
    """Positions, velocities, accelerations (T, n) of a Fourier series for each joint, which begins at its middle at rest."""
    n = len(middle)
    q, v, a = (np.zeros((len(time_), n)) for _ in range(3))
    for k in range(1, HARMONICS + 1):
        w = 2.0 * np.pi * BASE * k
        size, phase = SWING * rng.uniform(0.3, 1.0, n) / HARMONICS, rng.uniform(0.0, 2.0 * np.pi, n)
        q += size * np.sin(w * time_[:, None] + phase)
        v += size * w * np.cos(w * time_[:, None] + phase)
        a -= size * w**2 * np.sin(w * time_[:, None] + phase)
    # Let in over two seconds; the derivatives of what lets it in are in them.
    s = np.clip(time_ / 2.0, 0.0, 1.0)[:, None]
    f, df, ddf = s**3 * (10 - 15 * s + 6 * s**2), 15.0 * s**2 * (1 - s) ** 2, 15.0 * s * (1 - s) * (1 - 2 * s)
    return middle + f * q, f * v + df * q, f * a + 2 * df * v + ddf * q


def run(model: mujoco.MjModel, rng: np.random.Generator, middle: Array, hidden: Hidden | None, duration: float) -> Any:
    """Time, positions, velocities, accelerations and held torques of one recording under a computed-torque controller."""
    data = mujoco.MjData(model)
    times = np.arange(0.0, duration, 1.0 / RATE)
    q, v, a = wanted(rng, middle, times)
    data.qpos[:], data.qvel[:] = q[0], 0.0
    inside = round(1.0 / (RATE * STEP))
    out_q, out_v, out_a, out_tau = (np.zeros_like(q) for _ in range(4))
    torque = np.zeros(model.nv)
    for k in range(len(times)):
        mujoco.mj_forward(model, data)
        mujoco.mj_mulM(model, data, torque, a[k] + 100.0 * (q[k] - data.qpos) + 20.0 * (v[k] - data.qvel))
        # A joint that carries next to nothing is held against its friction, or what is concealed there would take it away.
        torque += HOLD * model.dof_damping * (q[k] - data.qpos)
        tau = torque + data.qfrc_bias - data.qfrc_passive + model.dof_frictionloss * np.tanh(v[k] / 0.02)
        # MuJoCo's steps are a leapfrog: a torque set here acts from half a step ago, when the joints were half a step's way back.
        out_q[k] = data.qpos - 0.5 * STEP * data.qvel
        out_v[k], out_a[k], out_tau[k] = data.qvel, data.qacc, tau
        for _ in range(inside):
            data.qfrc_applied[:] = tau
            if hidden is not None and hidden.effect not in IN_MODEL:
                j = hidden.joint
                one = [np.array(x) for x in (data.qpos[j], data.qvel[j], 0.0, tau[j])]
                data.qfrc_applied[j] += float(hidden.torque(*one))
            mujoco.mj_step(model, data)
    return times, out_q, out_v, out_a, out_tau


IN_MODEL = ("coulomb_friction", "viscous_damping", "added_inertia")  # which MuJoCo has words for


def with_hidden(model: mujoco.MjModel, hidden: Hidden) -> mujoco.MjModel:
    """The model with what MuJoCo has words for."""
    for effect, name, place in zip(IN_MODEL, ("torque", "coefficient", "inertia"),
                                   (model.dof_frictionloss, model.dof_damping, model.dof_armature), strict=True):  # fmt: skip
        if hidden.effect == effect:
            place[hidden.joint] += hidden.parameters[name]
    return model


def drawn(rng: np.random.Generator, effect: str, j: int, motion: Any, size: float) -> Hidden:
    """An effect whose torque over a motion is of a given RMS [N·m]."""
    _, q, v, a, tau = motion
    unit = {
        "coulomb_friction": {"torque": 1.0}, "viscous_damping": {"coefficient": 1.0}, "quadratic_drag": {"coefficient": 1.0},
        "joint_stiffness": {"stiffness": 1.0, "rest_angle": float(q[:, j].mean() + rng.uniform(-0.3, 0.3))},
        "constant_torque": {"torque": 1.0}, "added_inertia": {"inertia": 1.0}, "actuator_gain": {"gain": 2.0},
        "cogging_torque": {"amplitude": 1.0, "periods": float(rng.integers(6, 13)), "phase": float(rng.uniform(-3.0, 3.0))},
    }[effect]  # fmt: skip
    one = Hidden(effect, j, unit)
    factor = size / float(np.sqrt(np.mean(one.torque(q[:, j], v[:, j], a[:, j], tau[:, j]) ** 2)))
    first = next(iter(unit))
    value = 1.0 + rng.choice([-1.0, 1.0]) * min(factor, 0.3) if effect == "actuator_gain" else factor
    return Hidden(effect, j, {**unit, first: float(value)})


def record(folder: Path, name: str, rng: np.random.Generator, effect: str, *, joints: int | None = None,
           duration: float = DURATION, recordings: int = 2, torques: dict[str, Array] | None = None) -> Hidden:  # fmt: skip
    """Write ``model.urdf`` and ``run*.csv`` into a folder; what is concealed in them."""
    folder.mkdir(parents=True, exist_ok=True)
    middle = np.array(ARMS[name][1][:joints])
    system = arm(name, joints)
    write(system, folder / "model.urdf")
    plain = run(compiled(folder / "model.urdf"), rng, middle, None, 10.0)
    load_, speed = (np.sqrt(np.mean(plain[k] ** 2, axis=0)) for k in (4, 2))
    # A joint that carries next to nothing (the last one, about its own axis) has friction all the same.
    load_ = np.maximum(load_, 0.02 * load_.max())
    moving = iter(range(len(middle)))
    stated = []
    for joint in system.joints:
        if joint.name in system.joint_names:
            j = next(moving)
            stated.append(replace(joint, friction=float(f"{FRICTION * load_[j]:.4g}"),
                                  damping=float(f"{DAMPING * load_[j] / speed[j]:.4g}")))  # fmt: skip
        else:
            stated.append(joint)
    system = replace(system, joints=tuple(stated))
    write(system, folder / "model.urdf")
    j = int(rng.integers(len(middle)))
    hidden = drawn(rng, effect, j, plain, load_[j] * rng.uniform(LEAST, MOST))
    model = with_hidden(compiled(folder / "model.urdf"), hidden)
    for k in range(recordings):
        times, q, _, _, tau = run(model, rng, middle, hidden, duration)
        q = q + ENCODER * rng.standard_normal(q.shape)
        tau = tau + TORQUE * load_ * rng.standard_normal(tau.shape)
        heads = ["time", *(f"{n}.position" for n in system.joint_names), *(f"{n}.effort" for n in system.joint_names)]
        np.savetxt(
            folder / f"run{k + 1}.csv",
            np.column_stack([times, q, tau]),
            "%.8g",
            ",",
            header=",".join(heads),
            comments="",
        )
    return hidden


def draw(out: Path, seed: int, count: int) -> None:
    """Conceal and seal ``count`` cases; digests are published before anything is diagnosed."""
    digests = {}
    for k in range(count):
        name, effect = list(ARMS)[k % len(ARMS)], EFFECTS[(k + k // len(EFFECTS)) % len(EFFECTS)]
        rng = np.random.default_rng([seed, k])
        case = f"{k:02d}-{name}"
        hidden = record(out / "cases" / case, name, rng, effect)
        site = load(out / "cases" / case / "model.urdf", physical=False).joint_names[hidden.joint]
        text = json.dumps(
            {"salt": secrets.token_hex(16), "effect": hidden.effect, "site": site, "parameters": hidden.parameters}
        )
        (out / "sealed").mkdir(parents=True, exist_ok=True)
        (out / "sealed" / f"{case}.json").write_text(text, encoding="utf-8")
        digests[case] = digest(text)
        print(case, digests[case], flush=True)
    (out / "digests.json").write_text(json.dumps({"seed": seed, "digests": digests}, indent=1), encoding="utf-8")


def without_friction(folder: Path) -> Path:
    """The case's model as published: nothing rubs."""
    system = load(folder / "model.urdf", physical=False)
    bare = [replace(joint, damping=0.0, friction=0.0) for joint in system.joints]
    write(replace(system, joints=tuple(bare)), folder / "bare.urdf")
    return folder / "bare.urdf"


def asked(folder: Path, options: tuple[str, ...], file: Path, model: Path) -> dict[str, Any]:
    """A diagnosis in a process of its own, as a user runs it; wall-clock and processor seconds."""
    runs = sorted(map(str, folder.glob("run*.csv")))
    command = [
        sys.executable,
        "-m",
        "harness",
        "diagnose",
        *runs,
        "--model",
        str(model),
        *options,
        "--json",
        str(file),
    ]
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    seconds, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if done.returncode not in (0, 1):
        return {"error": done.stderr.strip()[-300:], "seconds": seconds, "cpu": cpu}
    found = json.loads(file.read_text(encoding="utf-8"))
    return {"found": found, "seconds": seconds, "cpu": cpu}


def run_all(out: Path, way: str, most: int) -> None:
    """Diagnose what has no answer yet."""
    digests = json.loads((out / "digests.json").read_text(encoding="utf-8"))["digests"]
    place = out / f"found-{way}"
    place.mkdir(exist_ok=True)
    for case in list(digests)[:most]:
        kept = place / f"{case}.json"
        if kept.exists():
            continue
        folder = out / "cases" / case
        model = without_friction(folder) if way == "unstated" else folder / "model.urdf"
        told = asked(folder, WAYS[way], place / f".{case}.partial", model)
        kept.write_text(json.dumps(told), encoding="utf-8")
        said = [(f["effect"], f["site"], f.get("grade")) for f in told.get("found", {}).get("findings", [])]
        print(case, f"{told['seconds']:.1f} s, processor {told['cpu']:.1f} s", told.get("error") or said, flush=True)


def scored(out: Path, way: str) -> list[dict[str, Any]]:
    """What was named against what was concealed, unsealed now."""
    digests = json.loads((out / "digests.json").read_text(encoding="utf-8"))["digests"]
    rows = []
    for case, published in digests.items():
        kept = out / f"found-{way}" / f"{case}.json"
        if not kept.exists():
            continue
        answer, told = unseal(case, out / "sealed", published), json.loads(kept.read_text(encoding="utf-8"))
        findings = [f for f in told.get("found", {}).get("findings", []) if f.get("grade") != "possible"]
        key = (answer["effect"], answer["site"])
        mine = [f for f in findings if (f["effect"], f["site"]) == key]
        rivals = [f for f in findings if (key[0] in f["indistinguishable_from"] and f["site"] == key[1])
                  or "@".join(key) in f["indistinguishable_from"]]  # fmt: skip
        first = next(iter(answer["parameters"]))
        joints = load(out / "cases" / case / "model.urdf", physical=False).joint_names if way == "unstated" else ()
        rubs = {(effect, joint) for effect in ("viscous_damping", "coulomb_friction") for joint in joints}
        rubbing = {(f["effect"], f["site"]) for f in findings} & rubs
        rows.append({
            "case": case, "effect": key[0], "site": key[1], "named": bool(mine), "as_rival": bool(rivals and not mine),
            "beside": [f"{f['effect']}@{f['site']}" for f in findings
                       if f not in mine and f not in rivals and (f["effect"], f["site"]) not in rubs],
            "friction": [len(rubbing), len(rubs)],
            "value": answer["parameters"][first], "found": mine[0]["parameters"][first]["value"] if mine else None,
            "verdict": told.get("found", {}).get("verdict", told.get("error")),
            "seconds": round(told["seconds"], 1), "cpu": round(told["cpu"], 1),
        })  # fmt: skip
    return rows


def grow(out: Path) -> None:
    """Processor time of the way by efforts over joints, samples and recordings, one at a time from a common case."""
    common = {"joints": 4, "duration": 15.0, "recordings": 2}
    steps = {"joints": (2, 3, 4, 5, 6, 7), "duration": (7.5, 15.0, 30.0, 60.0), "recordings": (2, 3, 5)}
    kept = out / "grow.json"
    rows = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else []
    for what, values in steps.items():
        for value in values:
            if any(row["what"] == what and row["value"] == value for row in rows):
                continue
            options: dict[str, Any] = {**common, what: value}
            folder = out / f"grow-{what}-{value:g}"
            record(folder, "panda", np.random.default_rng(5), "viscous_damping", **options)
            told = asked(folder, WAYS["fit-effort"], out / ".grow.partial", folder / "model.urdf")
            rows.append(
                {
                    "what": what,
                    "value": value,
                    "seconds": told["seconds"],
                    "cpu": told["cpu"],
                    "error": told.get("error"),
                }
            )
            kept.write_text(json.dumps(rows, indent=1), encoding="utf-8")
            print(rows[-1], flush=True)


def exponent(rows: list[dict[str, Any]], what: str) -> float:
    """Slope of log processor time over log size."""
    own = [row for row in rows if row["what"] == what]
    return float(np.polyfit(np.log([r["value"] for r in own]), np.log([r["cpu"] for r in own]), 1)[0])


def table(out: Path) -> None:
    """Scores and times into reference/ and onto the page."""
    seed = json.loads((out / "digests.json").read_text(encoding="utf-8"))["seed"]
    found = {way: scored(out, way) for way in WAYS}
    kept = json.loads(REFERENCE.read_text(encoding="utf-8"))["growth"] if REFERENCE.exists() else []
    growth = json.loads((out / "grow.json").read_text(encoding="utf-8")) if (out / "grow.json").exists() else kept
    slopes = {what: exponent(growth, what) for what in dict.fromkeys(row["what"] for row in growth)}
    digests = json.loads((out / "digests.json").read_text(encoding="utf-8"))["digests"]
    document = {"seed": seed, "digests": digests, "cases": found, "growth": growth, "exponents": slopes}
    REFERENCE.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    put(PAGE, "<!-- arms -->", "<!-- end of arms -->", "\n".join(lines(document)))


def lines(document: dict[str, Any]) -> list[str]:
    """The tables in Markdown."""
    words = {
        "fit-effort": "`--fit-effort`",
        "unstated": "`--fit-effort`, the model without any friction",
        "motion": f"motion, `--time-limit {LIMIT:g}`",
    }
    out = ["| way | right effect at the right joint | only among what it cannot be told from | claimed beside it "
           "| friction of the joints | wall clock, median (longest) [s] | processor, median (longest) [s] |",
           "| -- | -- | -- | -- | -- | -- | -- |"]  # fmt: skip
    for way, rows in document["cases"].items():
        if not rows:
            continue
        wall, cpu = ([row[key] for row in rows] for key in ("seconds", "cpu"))
        counts = [
            sum(row["named"] for row in rows),
            sum(row["as_rival"] for row in rows),
            sum(bool(row["beside"]) for row in rows),
        ]
        rubs, of = (sum(row.get("friction", (0, 0))[k] for row in rows) for k in (0, 1))
        out.append(f"| {words[way]} | " + " | ".join(f"{count} of {len(rows)}" for count in counts)
                   + f" | {f'{rubs} of {of} named' if of else 'stated'}"
                   + "".join(f" | {np.median(x):.1f} ({max(x):.1f})" for x in (wall, cpu)) + " |")  # fmt: skip
    if document["growth"]:
        out += ["", "| `--fit-effort`, processor [s] over | exponent | measured |", "| -- | -- | -- |"]
        for what, slope in document["exponents"].items():
            own = [row for row in document["growth"] if row["what"] == what]
            out.append(f"| {'seconds recorded' if what == 'duration' else what} | {slope:.2f} | "
                       + ", ".join(f"{row['value']:g}: {row['cpu']:.1f}" for row in own) + " |")  # fmt: skip
    return out


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    for verb in ("draw", "run", "grow", "table"):
        one = verbs.add_parser(verb)
        one.add_argument("folder", nargs="?", type=Path)
        one.add_argument("--out", type=Path)
        one.add_argument("--seed", type=int, default=None)
        one.add_argument("--cases", type=int, default=20)
        one.add_argument("--way", choices=list(WAYS), default="fit-effort")
    given = parser.parse_args()
    out = given.folder or given.out or Path("arms")
    os.environ["PYTHONPATH"] = str(ROOT)
    if given.verb == "draw":
        draw(out, secrets.randbelow(2**31) if given.seed is None else given.seed, given.cases)
    elif given.verb == "run":
        run_all(out, given.way, given.cases)
    elif given.verb == "grow":
        grow(out)
    else:
        table(out)


if __name__ == "__main__":
    main()
