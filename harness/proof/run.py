"""Runs a proof: conceal, publish digests, diagnose without the answers, unseal, score."""

from __future__ import annotations

import json
import secrets
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np

from harness.errors import InputError, MissingPackageError
from harness.json_text import json_text
from harness.parallel import one_blas_thread, parallel_map
from harness.proof.apart import predictions
from harness.proof.concealments import CONCEALMENTS
from harness.proof.draw import Case, UnseenError, draw_case
from harness.proof.flexible import EFFECTS, draw_flexible
from harness.proof.kept import found_file, of_found, read_digests, read_found, read_plan
from harness.proof.outside import OUTSIDE
from harness.proof.score import CaseScore, Summary, score_case, summarise
from harness.proof.seal import digest, seal, unseal
from harness.proof.sharpness import sharpness
from harness.proof.sites import refuse_strange
from harness.proof.truth import NoSolutionError
from harness.proof.visibility import DETECTION_LIMIT
from harness.proof.write import write_case
from harness.whole_files import write_whole

# Without flexible rigs, which take minutes each.
QUICK = {"single": 16, "pair": 5, "triple": 1, "clean": 10, "outside": 8}
FULL = {
    "single": 180, "pair": 44, "triple": 12, "clean": 104, "outside": 60, "flexible single": 21, "flexible clean": 6,
}  # fmt: skip

SLOWEST_FIRST = ("triple", "pair", "flexible-single", "outside", "single", "flexible-clean", "clean")
EFFECTS_BY_KIND = {"single": tuple(CONCEALMENTS), "outside": tuple(OUTSIDE), "flexible single": EFFECTS}
# A strip whose model has one mode lacks others, and one that does not stiffen lacks that: whoever reads the model knows.
GIVEN_AWAY = ("higher_mode", "geometric_stiffening")

REDRAWS, REDRAW_STRIDE = 20, 100_000

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Task:
    """One case to draw: kind, number within the kind, and the effect it must conceal (empty: drawn)."""

    kind: str
    index: int
    effect: str = ""

    @property
    def name(self) -> str:
        """Of the case."""
        return f"{self.kind}-{self.index}".replace(" ", "-")


@dataclass(frozen=True)
class Proof:
    """A proof. sealed: how many cases there are, of which an unfinished one has scored fewer."""

    seed: int
    sealed: int
    scores: tuple[CaseScore, ...]
    summary: Summary
    peers: Mapping[str, Any]

    def to_json(self) -> dict[str, Any]:
        """The proof as ``denoc.proof/1``."""
        s = self.summary

        def pair(name: str) -> list[int]:
            share = getattr(s, name)
            return [share.hits, share.of]

        shares = (
            "named_single", "named_single_exactly", "named_pairs", "named_triples", "clean_false", "outside_told",
            "outside_apart_told", "told_in_vain", "at_floor", "side_right", "site_right", "false_anywhere", "failed",
        )  # fmt: skip
        return {
            "schema": "denoc.proof/1",
            "seed": self.seed,
            "cases": len(self.scores),
            "sealed": self.sealed,
            **{name: pair(name) for name in shares},
            "coverage95": s.coverage95.value if s.coverage95.of else None,
            "coverage95_count": pair("coverage95"),
            **sharpness(self.scores),
            "wilson95": {name: list(getattr(s, name).interval) for name in (*shares, "coverage95")},
            "confusion": s.confusion,
            "confusion_right": s.confusion_right,
            "parameter_error": s.parameter_error,
            "detection": {k: [[d, hit] for d, hit in v] for k, v in s.detection.items()},
            "peers": dict(self.peers),
            "scores": [{**asdict(score), "right": score.right} for score in self.scores],
        }


def effects_of(kind: str, disguised: bool = False) -> list[str]:
    """What cases of a kind conceal in turn; disguised: without what no model can do without giving it away."""
    return [
        e
        for e in EFFECTS_BY_KIND.get(kind, ("",))
        if not (disguised and kind.startswith("flexible") and e in GIVEN_AWAY)
    ]


def tasks(counts: Mapping[str, int], disguised: bool = False) -> list[Task]:
    """The cases of a proof; singles and outside kinds go round robin over all effects, so that none is left out."""
    rows: list[Task] = []
    for kind, count in counts.items():
        names = effects_of(kind, disguised)
        rows += [Task(kind, i, names[i % len(names)]) for i in range(count)]
    return rows


def scaled(cases: int) -> dict[str, int]:
    """The full proof's mix, scaled to a number of cases."""
    total = sum(FULL.values())
    return {kind: max(1, round(count * cases / total)) for kind, count in FULL.items()}


@one_blas_thread()
def conceal(task: Task, seed: int, out: Path, short: bool = False, disguised: bool = False) -> tuple[str, str]:
    """Draw a case, write what diagnosis may see, seal the answer; (name, digest). What is sealed already is left as it is.

    On one thread of linear algebra, for several add up in another order, and a seed stands for the same recordings to the last
    digit wherever they are made.
    """
    sealed = out / "sealed" / f"{task.name}.json"
    if sealed.exists():
        # The answer is sealed last, so that all the rest is there.
        return task.name, digest(sealed.read_text(encoding="utf-8"))
    effect = _shuffled(task, seed, disguised)
    for attempt in range(REDRAWS):
        index = task.index + attempt * REDRAW_STRIDE
        # A rig whose dry friction has no solution (Painlevé's paradox), found at the draw or at the recording, is drawn again, and
        # so is one on which what is concealed does not show.
        try:
            case = replace(_draw(task.kind, seed, index, effect, short, disguised), name=task.name)
            rng = np.random.default_rng([seed, index, crc32(task.kind.encode())])
            noise_free = write_case(case, out / "cases" / case.name, rng)
        except (NoSolutionError, UnseenError):
            continue
        return case.name, seal(case, out / "sealed", noise_free if task.kind == "outside" else None)
    raise NoSolutionError(f"no rig was found on which {effect or task.kind} has a solution and shows")


def _draw(kind: str, seed: int, index: int, effect: str, short: bool, disguised: bool) -> Case:
    if kind.startswith("flexible"):
        return draw_flexible(kind.removeprefix("flexible "), seed, index, effect)
    return draw_case(kind, seed, index, effects=(effect,) if effect else (), short=short, disguised=disguised)


def _shuffled(task: Task, seed: int, disguised: bool = False) -> str:
    """Round robin from a place that the seed chooses, so that a quick proof tries other effects each time."""
    if not task.effect:
        return ""
    names = effects_of(task.kind, disguised)
    order = np.random.default_rng([seed, len(names)]).permutation(len(names))
    return names[int(order[names.index(task.effect)])]


def diagnose_folder(folder: Path) -> dict[str, Any]:
    """What diagnosis says of a folder that holds a model and recordings, and what the model that it tells predicts.

    An error is an answer too.
    """
    import harness

    start = time.perf_counter()
    runs = sorted(folder.glob("run*.csv"))
    try:
        told = harness.diagnose([str(r) for r in runs], model=str(folder / "model.toml"))
        found = {**told.to_json(), "predicted": predictions(told)}
    except (InputError, ArithmeticError, ValueError, RuntimeError) as error:
        found = {"error": f"{type(error).__name__}: {error}"}
    found["seconds"] = time.perf_counter() - start
    return found


def can_ask() -> bool:
    """Whether the packages are there by which other methods are asked; each of the methods may still be missing."""
    try:
        import pandas  # noqa: F401
    except ImportError:
        return False
    return True


def conceal_all(
    out: Path,
    *,
    seed: int | None = None,
    counts: Mapping[str, int] = QUICK,
    short: bool = True,
    disguised: bool = False,
    workers: int | None = None,
    dask: str | None = None,
    progress: Progress | None = None,
) -> tuple[int, dict[str, str]]:
    """Plan a proof, or take up the plan that is there, and seal its cases; its seed and digests. See ``prove``.

    disguised: so that no model tells what is concealed in it (``draw_case``), for entrants who know how cases are drawn.
    """
    plan_file = out / "plan.json"
    if plan_file.exists():
        plan = read_plan(out)
        if seed is not None and seed != plan.seed:
            raise InputError(
                f"holds a proof with seed {plan.seed}, not {seed}",
                source=out,
                mend="give another --out or no --seed",
            )
        seed, counts, short, disguised = plan.seed, plan.counts, plan.short, plan.disguised
    else:
        seed = secrets.randbelow(2**31) if seed is None else seed
        out.mkdir(parents=True, exist_ok=True)
        _write(plan_file, {"seed": seed, "counts": dict(counts), "short": short, "disguised": disguised})
    todo = tasks(counts, disguised)
    digests_file = out / "digests.json"
    if not digests_file.exists():
        ticks = _ticker(progress, "conceal", len(todo))
        named = parallel_map(
            partial(conceal, seed=seed, out=out, short=short, disguised=disguised),
            todo,
            workers=workers,
            dask=dask,
            done=lambda i, r: ticks(),
        )
        _write(digests_file, dict(named))
    return seed, read_digests(out)


def prove(
    out: Path,
    *,
    seed: int | None = None,
    counts: Mapping[str, int] = QUICK,
    short: bool = True,
    workers: int | None = None,
    dask: str | None = None,
    peers: bool | None = None,
    progress: Progress | None = None,
) -> Proof:
    """The blind proof.

    out: folder of the proof; one that holds an interrupted proof is resumed (with its own seed and mix).
    seed: fresh if None. counts: number of cases by kind. short: whether rigid rigs are recorded but twice, for at most 6 s and at
    250 Hz, as befits a quick proof. peers: whether other methods are asked; None: unless short, where their
    packages are installed.
    progress: called with (stage, done, of).
    Raises InputError if ``out`` holds another proof or tampered answers, MissingPackageError if peers cannot be asked.
    """
    if peers and not can_ask():
        raise MissingPackageError("pandas", "peers", what="asking other methods")
    out = Path(out)
    seed, digests = conceal_all(
        out, seed=seed, counts=counts, short=short, workers=workers, dask=dask, progress=progress
    )
    short = read_plan(out).short
    found_folder = out / "found"
    found_folder.mkdir(exist_ok=True)
    # What takes longest goes first, so that no worker is left with it at the end.
    missing = sorted((name for name in digests if not (found_folder / f"{name}.json").exists()), key=_place_by_length)
    ticks = _ticker(progress, "diagnose", len(digests), len(digests) - len(missing))

    def save(index: int, found: dict[str, Any]) -> None:
        _write(found_folder / f"{missing[index]}.json", found)
        ticks()

    parallel_map(diagnose_folder, [out / "cases" / name for name in missing], workers=workers, dask=dask, done=save)
    scores = _scored(out, digests)
    versus: dict[str, Any] = {}
    if (not short and can_ask()) if peers is None else peers:
        from harness.proof.peers import compare_peers

        versus = compare_peers(out, scores, workers=workers, dask=dask, progress=progress)
    proof = Proof(seed, len(digests), tuple(scores), summarise(scores, DETECTION_LIMIT), versus)
    write_whole(out / "proof.json", json_text(proof.to_json()))
    return proof


def score_so_far(out: Path) -> Proof:
    """What the cases that have been diagnosed say of a proof that is not finished; nothing is concealed, diagnosed or asked.

    Raises InputError where nothing has been diagnosed, or if answers were tampered with.
    """
    digests = read_digests(out) if (out / "digests.json").exists() else {}
    done = {name: published for name, published in digests.items() if found_file(out, name).exists()}
    if not done:
        raise InputError("holds no diagnosed case", source=out, mend=f"let it go on first: denoc prove --resume {out}")
    scores = _scored(out, done)
    seed = read_plan(out).seed
    return Proof(seed, len(digests), tuple(scores), summarise(scores, DETECTION_LIMIT), {})


def score_of_claims(out: Path, file: Path) -> Proof:
    """What another tool claims of the cases of a proof, under their exported names or the proof's own, scored as a diagnosis is.

    Raises InputError where the file is no ``denoc.claims/1``, names cases or sites that are not in the proof, or answers were
    tampered with.
    """
    from harness.proof.claims import OWN, read_claims, score_claims, tally
    from harness.proof.export import answers as sealed

    claims = read_claims(file)
    answers, shown = sealed(out)
    cases = {shown.get(name, name): name for name in answers} | {name: name for name in answers}
    strange = [name for name in claims.cases if name not in cases]
    if strange:
        raise InputError(
            f"claims something of {strange[0]}, which is not in {out}",
            source=file,
            mend="give the folder that these cases came from",
        )
    said: dict[str, Mapping[str, Any]] = {}
    for name, what in claims.cases.items():
        if cases[name] in said:
            raise InputError(f"claims something of {name} under two names", source=file, mend="give each case once")
        refuse_strange(what, name, out / "cases" / cases[name], file)
        # What else stands there is the entrant's own; that a case was passed by is not for an entrant to say.
        said[cases[name]] = {key: what[key] for key in OWN if key in what}
    scores = score_claims(said, answers)
    seed = read_plan(out).seed
    entry = {claims.entrant: tally(scores, said, answers)}
    return Proof(seed, len(answers), tuple(scores), summarise(scores, DETECTION_LIMIT), entry)


def _scored(out: Path, digests: Mapping[str, str]) -> list[CaseScore]:
    """What was found against the answers, unsealed now."""
    scores = []
    for name, published in digests.items():
        answer = unseal(name, out / "sealed", published)
        found = read_found(out, name)
        scores.append(of_found(found_file(out, name), partial(score_case, name, answer, found)))
    return scores


def _place_by_length(name: str) -> int:
    """Place of a case among those that take longest to diagnose, by its kind."""
    return SLOWEST_FIRST.index(name.rpartition("-")[0])


def _ticker(progress: Progress | None, stage: str, of: int, done: int = 0) -> Callable[[], None]:
    count = done

    def tick() -> None:
        nonlocal count
        count += 1
        if progress is not None:
            progress(stage, count, of)

    return tick


def _write(path: Path, data: Any) -> None:
    write_whole(path, json.dumps(data, indent=1, allow_nan=True))
