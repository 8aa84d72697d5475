"""Effects told beside a force that no law of the catalogue describes: what is found, and what is found that is not there.

``python benchmarks/beside_random_forces.py [--cases N] [--seed S] [--wander SHARE] [--work DIR]``

Every case is an arm on one joint, dropped from several heights or driven by a recorded effort, with a force over angle and
speed that is a draw of a Gaussian process (random waves; Rahimi and Recht, NIPS 20 (2007) 1177), of its own size and lengths,
less what smooth plain laws (a weight, a spring, a constant, damping) say of it.
With --wander, friction of every recording, dry and viscous alike, is another one by about that share, as of bearings that warm up.
In two of five nothing else differs from the model; in the others it carries a weight, rubs more, or is damped more. SciPy
integrates. Answers already in the work folder are used again; the table counts findings that are told for more than possible.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import harness
from harness.recording import Channel, Recording
from harness.system.description import constant
from harness.whole_files import write_whole

WAVES = 40
MASS, COM, REACH, ABOUT = 0.55, 0.14, 0.15, 0.0218  # kg, m, m; kg·m² about the joint with the rotor, without a weight
DAMPING, FRICTION, SHARPNESS = 0.05, 0.02, 1e-5  # N·m·s/rad, N·m, rad/s

MODEL = f"""
name = "arm"
gravity = [0.0, 0.0, -9.81]
tolerance = 0.01
[[joint]]
name = "servo"
type = "revolute"
parent = "base"
child = "arm"
axis = [0, 1, 0]
armature = 0.01
damping = {DAMPING}
friction = {FRICTION}
[[link]]
name = "arm"
mass = {MASS}
com = [0.0, 0.0, {-COM}]
inertia = [1.02e-3, 1.02e-3, 1e-3, 0, 0, 0]
end = [0.0, 0.0, {-REACH}]
"""
EFFECTS = {"payload_mass": "mass", "coulomb_friction": "torque", "viscous_damping": "coefficient"}


@dataclass(frozen=True)
class Case:
    """What differs from the model: the force's standard deviation [N·m] and lengths [rad, rad/s], and one effect of a size; and by
    which share friction differs between recordings."""

    number: int
    driven: bool
    force: float
    lengths: tuple[float, float]
    noise: float
    effect: str
    size: float
    seed: int
    wander: float = 0.0


def drawn(number: int, seed: int, wander: float = 0.0) -> Case:
    """One case; the size of what is added is one that an engineer would look for."""
    random = np.random.default_rng([seed, number])
    effect = ("", "payload_mass", "", "coulomb_friction", "viscous_damping")[number % 5]
    size = {"": 0.0, "payload_mass": random.uniform(0.08, 0.4)}.get(effect)
    if size is None:
        size = float(random.uniform(0.02, 0.06)) * (1.0 if effect == "coulomb_friction" else 0.5)
    return Case(
        number, bool(random.random() < 0.4), float(np.exp(random.uniform(np.log(0.005), np.log(0.05)))),
        (float(random.uniform(0.3, 1.0)), float(random.uniform(1.5, 5.0))), float(10 ** random.uniform(-4.0, -2.7)),
        effect, float(size), int(random.integers(2**31)), wander,
    )  # fmt: skip


def _waved(state: np.ndarray, waves: np.ndarray, phases: np.ndarray) -> np.ndarray:
    return np.sqrt(2.0 / WAVES) * np.sum(np.cos(waves @ state + phases[:, None]), axis=0)


def _plain(state: np.ndarray) -> np.ndarray:
    """What smooth plain laws make of angle and speed (2, N): (N, 5).

    Dry friction is none of them: taken out of a smooth draw it would leave a jump at rest, which is dry friction indeed.
    """
    q, qd = state
    return np.array([np.ones_like(q), q, np.sin(q), np.cos(q), qd]).T


def recorded(case: Case) -> list[Recording]:
    """Four recordings of a case."""
    random = np.random.default_rng(case.seed)
    added = {case.effect: case.size}
    mass = added.get("payload_mass", 0.0)
    about, weight = ABOUT + mass * REACH**2, 9.81 * (MASS * COM + mass * REACH)
    damping = DAMPING + added.get("viscous_damping", 0.0)
    friction = FRICTION + added.get("coulomb_friction", 0.0)
    waves, phases = random.normal(size=(WAVES, 2)) / np.array(case.lengths), random.uniform(0.0, 2.0 * np.pi, WAVES)
    # What of the draw a plain law says is taken out: a weight would otherwise be told that is not there, and rightly.
    region = np.array([a.ravel() for a in np.meshgrid(np.linspace(-1.5, 1.5, 31), np.linspace(-8.0, 8.0, 31))])
    named = np.linalg.lstsq(_plain(region), _waved(region, waves, phases), rcond=None)[0]
    levels = np.exp(case.wander * np.random.default_rng([case.seed, 1]).normal(size=4))
    time_ = np.arange(0.0, 6.0 if case.driven else 2.5, 0.01)
    out = []
    for k in range(4):
        frequencies, sizes = random.uniform(0.2, 1.2, 3), random.uniform(0.1, 0.4, 3) * case.driven
        starts = random.uniform(0.0, 2.0 * np.pi, 3)
        start = 0.0 if case.driven else -float(random.uniform(0.5, 1.5))
        effort = np.sum(sizes[:, None] * np.sin(2.0 * np.pi * frequencies[:, None] * time_ + starts[:, None]), axis=0)

        def slope(
            t: float, y: np.ndarray, effort: np.ndarray = effort, level: float = levels[k]
        ) -> tuple[float, float]:
            force = case.force * float((_waved(y[:, None], waves, phases) - _plain(y[:, None]) @ named)[0])
            rubbing = level * (friction * np.tanh(y[1] / SHARPNESS) + damping * y[1])
            acting = np.interp(t, time_, effort) + force
            return y[1], float((acting - weight * np.sin(y[0]) - rubbing) / about)

        found = solve_ivp(slope, (0.0, time_[-1]), (start, 0.0), t_eval=time_, method="LSODA", rtol=1e-8, atol=1e-10)
        read = found.y[0] + case.noise * random.normal(size=len(time_))
        channels = [Channel("servo.position", "servo", "position", "rad", constant(read))]
        if case.driven:
            channels.append(Channel("servo.effort", "servo", "effort", "N*m", constant(effort)))
        out.append(Recording(f"run{k}", f"run{k}", constant(time_), tuple(channels)))
    return out


def answered(case: Case, model: Path) -> dict[str, Any]:
    """The answer of ``denoc diagnose`` to a case, beside the truth."""
    began = time.perf_counter()
    found = harness.diagnose(recorded(case), model)
    told = [
        {
            "effect": f["effect"], "grade": f["grade"], "parameters": f["parameters"], "evidence": f["evidence"],
            "cannot_be_told_from": [str(other) for other in f.get("indistinguishable_from", [])],
        }
        for f in found.findings
    ]  # fmt: skip
    return {"case": asdict(case), "verdict": found.verdict, "findings": told, "seconds": time.perf_counter() - began}


def scored(row: dict[str, Any]) -> dict[str, Any]:
    """Whether the truth is told, with an interval that holds it, and what else is told for more than possible."""
    effect, size = row["case"]["effect"], row["case"]["size"]
    firm = [f for f in row["findings"] if f["grade"] != "possible"]
    right = [f for f in row["findings"] if f["effect"] == effect]
    low, high = right[0]["parameters"][EFFECTS[effect]]["ci95"] if right else (np.inf, -np.inf)
    false = [
        f["effect"]
        for f in firm
        if f["effect"] != effect and not (effect and any(effect in other for other in f["cannot_be_told_from"]))
    ]
    grade = right[0]["grade"] if right else ""
    return {"named": grade, "holds": bool(low <= size <= high), "false": false}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--wander", type=float, default=0.0)
    parser.add_argument("--work", type=Path, default=Path("beside_random_forces"))
    asked = parser.parse_args()
    asked.work.mkdir(parents=True, exist_ok=True)
    model = asked.work / "arm.toml"
    model.write_text(MODEL, encoding="utf-8")
    rows = []
    for number in range(asked.cases):
        kept = asked.work / f"{asked.seed}-{number}{f'-{asked.wander:g}' if asked.wander else ''}.json"
        if not kept.exists():
            write_whole(kept, json.dumps(answered(drawn(number, asked.seed, asked.wander), model), indent=1))
        row = json.loads(kept.read_text(encoding="utf-8"))
        score = scored(row)
        rows.append((row, score))
        case = row["case"]
        added = f"{case['effect']} {case['size']:.3g}" if case["effect"] else "nothing"
        told = ", ".join(f"{f['effect']} ({f['grade']})" for f in row["findings"]) or "–"
        print(
            f"{number:3} {'driven' if case['driven'] else 'dropped':8} force {case['force']:.3f} N·m  {added:24} "
            f"{row['seconds']:4.0f} s  {'holds' if score['holds'] else '':6} {told}"
            + (f"  FALSE: {', '.join(score['false'])}" if score["false"] else ""),
            flush=True,
        )
    there = [(r, s) for r, s in rows if r["case"]["effect"]]
    named = [s for _, s in there if s["named"]]
    print(f"cases with a false headline: {sum(bool(s['false']) for _, s in rows)} of {len(rows)}")
    print(
        f"named: {len(named)} of {len(there)}, {sum(s['named'] != 'possible' for s in named)} for more than possible; "
        f"intervals that hold the truth: {sum(s['holds'] for s in named)} of {len(named)}"
    )
    print(
        f"median {np.median([r['seconds'] for r, _ in rows]):.0f} s, longest {max(r['seconds'] for r, _ in rows):.0f} s"
    )


if __name__ == "__main__":
    main()
