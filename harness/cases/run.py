"""Running cases over engines: each case in a process of its own, rows in the order of the suite."""

from __future__ import annotations

import platform
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from time import perf_counter
from traceback import extract_tb
from typing import Any

from harness.cases.case import NATIVE, Bench, Case, Doubt, Row, Series
from harness.cases.checks.as_read import told
from harness.cases.discover import built_in, select
from harness.cases.results import Results, from_dict
from harness.compare.descriptions import TOLERANCE
from harness.engines import registry
from harness.engines.protocol import Engine, EngineModel
from harness.engines.readers.register import floating_among
from harness.errors import EngineUnavailableError, InputError, UnsupportedError
from harness.journal import Journal
from harness.parallel import parallel_map
from harness.system import System
from harness.system.suggest import did_you_mean

# Engines for a special kind of mechanism: that they refuse all others is no news.
SPECIAL = ("analytic", "exudyn_ancf", "exudyn_ffrf")

# Answers of engines, one of which was asked for where a check breaks.
ANSWERS = (
    "forward_dynamics", "inverse_dynamics", "mass_matrix", "bias", "gravity", "energy", "frequencies", "simulate",
)  # fmt: skip

Progress = Callable[[int, int, str], None]


@dataclass(frozen=True)
class Outcome:
    """What one case gave: rows, data for plots, wall time [s], and of a user's model what is doubtful and what reading left out."""

    case: str
    title: str
    rows: tuple[Row, ...]
    series: tuple[Series, ...]
    seconds: float
    doubts: tuple[Doubt, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Other:
    """The second of two models that are held against one another: the names of both, its file, whether its root is let float."""

    first: str
    second: str
    path: Path
    floating: bool = False


@dataclass(frozen=True)
class Task:
    """One case for a worker: by name if built in, by path if it is a user's model.

    against: where two descriptions are compared within ``tolerance``, the second.
    """

    case: str
    engines: tuple[str, ...]
    model: Path | None = None
    physical: bool = True
    against: Other | None = None
    tolerance: float = TOLERANCE
    allow: tuple[Path, ...] = ()
    floating: bool = False


def validate(
    models: Sequence[str | Path] | str | Path | None = None,
    *,
    cases: Sequence[str] | None = None,
    engines: Sequence[str] | None = None,
    workers: int | None = None,
    dask: str | None = None,
    physical: bool = True,
    tolerance: float = TOLERANCE,
    separate: bool = False,
    allow: Sequence[str | Path] = (),
    floating: bool = False,
    progress: Progress | None = None,
    journal: Journal | None = None,
) -> Results:
    """Compare the native dynamics with the other engines: on the built-in suite, or on models of the user's own.

    models: URDF, MJCF or TOML files; None runs the suite. cases: names of the suite's cases (``chain*`` takes all that
    start so). engines: by name, default all. workers: processes, default all cores. dask: address of a scheduler.
    physical: refuse models with inertia that no body can have; False compares them all the same.
    tolerance: relative difference (angles: rad) allowed between two descriptions of one mechanism. separate: models are of
    different mechanisms, and are not held against one another.
    allow: folders beside a model's own that it may name includes and meshes in.
    floating: let the root links of URDF models float on a free joint; InputError where no model is one.
    progress: called with (done, total, name of the case that ended). journal: where each case is kept as it ends; cases that
    it has already are not run again.
    Raises InputError for an unreadable model and an unknown case or engine.
    """
    if models is None:
        # Engines of other packages have no accepted figures here: they take part in the suite only where they are named.
        chosen = engine_names(engines or [name for name in registry.names() if name not in registry.own_names()])
        return run([Task(case.name, chosen) for case in select(cases)], workers, dask, progress, journal)
    paths = [Path(models)] if isinstance(models, str | Path) else [Path(model) for model in models]
    if not paths:
        raise InputError("the list of models is empty", mend="name at least one model, or pass None for the suite")
    if cases:
        raise InputError("cases are of the built-in suite and do not go with models", mend="give the one or the other")
    from harness.cases.users import names_of, read

    if not tolerance >= 0.0:
        raise InputError(f"tolerance {tolerance:g} is no relative difference", mend="0.001 is a tenth of a per cent")
    folders = tuple(Path(folder).resolve() for folder in allow)
    # What cannot be read is said before anything runs.
    files = names_of(paths)
    afloat = floating_among(files.values()) if floating else set()
    floats = {name: path in afloat for name, path in files.items()}
    systems = {
        name: read(path, physical=physical, allow=folders, floating=floats[name]) for name, path in files.items()
    }
    tasks = [
        Task(name, engine_names(engines), path.resolve(), physical, allow=folders, floating=floats[name])
        for name, path in files.items()
    ]
    if not separate:
        from harness.cases.descriptions import pairs_of

        tasks += [
            Task(
                f"{a} against {b}",
                (),
                files[a].resolve(),
                physical,
                Other(a, b, files[b].resolve(), floats[b]),
                tolerance,
                folders,
                floats[a],
            )
            for a, b in pairs_of(systems)
        ]
    return run(tasks, workers, dask, progress, journal)


def engine_names(chosen: Sequence[str] | None) -> tuple[str, ...]:
    """Names of the registry, native first; InputError for an unknown one."""
    known = registry.names()
    for name in chosen or ():
        if name not in known:
            raise InputError(f"no engine is named {name!r}", mend=did_you_mean(name, known))
    wanted = [name for name in known if chosen is None or len(chosen) == 0 or name in chosen or name == NATIVE]
    return tuple(sorted(wanted, key=lambda name: name != NATIVE))


def run(
    tasks: Sequence[Task],
    workers: int | None = None,
    dask: str | None = None,
    progress: Progress | None = None,
    journal: Journal | None = None,
) -> Results:
    """Run tasks in parallel; rows come in the order of the tasks, whatever the number of workers; journal: as in ``validate``."""
    start = perf_counter()
    known = {} if journal is None else journal.found
    ended = {k: kept_outcome(known[task.case], journal) for k, task in enumerate(tasks) if task.case in known}
    # The longest first, so that no core ends alone on a long one; the order of the rows stays that of the tasks.
    order = sorted((k for k in range(len(tasks)) if k not in ended), key=lambda k: -_cost(tasks[k]))
    count = len(ended)

    def done(index: int, outcome: Outcome) -> None:
        nonlocal count
        count += 1
        if journal is not None:
            journal.add(outcome.case, outcome_as_dict(outcome))
        if progress is not None:
            progress(count, len(tasks), outcome.case)

    ran = parallel_map(run_task, [tasks[k] for k in order], workers=workers, dask=dask, done=done)
    ended |= dict(zip(order, ran, strict=True))
    outcomes = [ended[k] for k in range(len(tasks))]
    return Results(
        rows=tuple(row for outcome in outcomes for row in outcome.rows),
        series=tuple(series for outcome in outcomes for series in outcome.series),
        versions=versions(),
        titles={outcome.case: outcome.title for outcome in outcomes},
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        seconds=perf_counter() - start,
        case_seconds={outcome.case: outcome.seconds for outcome in outcomes},
        doubts=tuple(doubt for outcome in outcomes for doubt in outcome.doubts),
        notes={outcome.case: outcome.notes for outcome in outcomes if outcome.notes},
    )


def outcome_as_dict(outcome: Outcome) -> dict[str, Any]:
    """An outcome as the document ``denoc.results/1``, which has all that it holds."""
    return Results(
        outcome.rows,
        outcome.series,
        titles={outcome.case: outcome.title},
        case_seconds={outcome.case: outcome.seconds},
        doubts=outcome.doubts,
        notes={outcome.case: outcome.notes},
    ).to_json()


def kept_outcome(document: object, journal: Journal | None) -> Outcome:
    """The same read again."""
    results = from_dict(document, None if journal is None else journal.path)
    (case,) = results.titles
    return Outcome(
        case,
        results.titles[case],
        results.rows,
        results.series,
        results.case_seconds.get(case, 0.0),
        results.doubts,
        results.notes.get(case, ()),
    )


def _cost(task: Task) -> float:
    return 1.0 if task.model is not None else built_in()[task.case].cost


def run_task(task: Task) -> Outcome:
    """One task in this process."""
    if task.model is not None:
        from harness.cases.users import case_of, read

        if task.against is not None:
            from harness.cases.descriptions import case_of_two

            other = task.against
            systems = (
                read(task.model, physical=task.physical, allow=task.allow, floating=task.floating),
                read(other.path, physical=task.physical, allow=task.allow, floating=other.floating),
            )
            case = case_of_two((other.first, other.second), systems, task.tolerance)
        else:
            from harness.cases.users import doubts

            case = case_of(task.case, task.model, physical=task.physical, allow=task.allow, floating=task.floating)
            outcome = run_case(case, {name: registry.engine(name) for name in task.engines})
            return replace(outcome, doubts=doubts(task.case, task.model, allow=task.allow, floating=task.floating))
    else:
        case = built_in()[task.case]
    return run_case(case, {name: registry.engine(name) for name in task.engines})


def run_case(case: Case, engines: Mapping[str, Engine]) -> Outcome:
    """One case over the given engines, native first."""
    start = perf_counter()
    rows: list[Row] = []
    series: list[Series] = []
    try:
        system = case.system()
    except UnsupportedError as error:
        bench = Bench(case, System(case.name, (), ()), {})
        said = " ".join(filter(None, [error.what, error.mend and f"({error.mend})"]))
        rows.append(bench.skipped("all", (NATIVE,), said))
        return Outcome(case.name, case.title, tuple(rows), (), perf_counter() - start)
    except Exception as error:
        # What the suite's own reader refuses has passed before: a failure of this case, and none of the others'.
        bench = Bench(case, System(case.name, (), ()), {})
        row = _broken(bench, "all", (NATIVE,), error)
        if isinstance(error, InputError):
            note = f"the readers refuse this case's own model: {row.note}"
            row = replace(row, note=note, first_divergence={"term": "refused"} | _owner(row.note))
        rows.append(row)
        return Outcome(case.name, case.title, tuple(rows), (), perf_counter() - start)
    models: dict[str, EngineModel] = {}
    refusals: dict[str, str] = {}
    reason: str | None
    for name, engine in engines.items():
        if case.engines is not None and name not in case.engines:
            continue
        bench = Bench(case, system, {})
        try:
            engine.version()
            reason = engine.refuses(system)
            if reason is None:
                models[name] = engine.build(system)
                continue
        except UnsupportedError as error:
            reason = error.what  # the file is the case's own, and named in its source
        except EngineUnavailableError as error:
            reason = str(error)
        except Exception as error:
            rows.append(_broken(bench, "all", (name,), error))
            continue
        refusals[name] = reason
        if name in SPECIAL and not system.flexible:
            continue
        rows.append(bench.skipped("all", (NATIVE, name) if name != NATIVE else (NATIVE,), reason))
    bench = Bench(case, system, models, refusals)
    for check in case.checks:
        begun, found = perf_counter(), len(rows)
        try:
            for item in check.run(bench):
                if isinstance(item, Row):
                    rows.append(item)
                else:
                    series.append(item)
        except Exception as error:
            # One broken engine or check must not take the other rows with it, and must not pass either.
            rows.append(_broken(bench, check.quantity, tuple(models) or (NATIVE,), error))
        if len(rows) > found:
            share = (perf_counter() - begun) / (len(rows) - found)
            rows[found:] = [replace(row, seconds=share) for row in rows[found:]]
    rows.sort(key=lambda row: row.verdict == "skipped")
    notes = (*system.notes, *told(rows))
    return Outcome(case.name, case.title, tuple(rows), tuple(series), perf_counter() - start, notes=notes)


def _broken(bench: Bench, quantity: str, engines: tuple[str, ...], error: Exception) -> Row:
    text = " ".join(str(error).split()) or "no message"
    asked = [frame.name for frame in extract_tb(error.__traceback__) if frame.name in ANSWERS]
    place = {"term": asked[0]} if asked else None
    row = bench.skipped(quantity, engines, f"{type(error).__name__}: {text}")
    return replace(row, verdict="fail", first_divergence=place)


def _owner(said: str) -> dict[str, object]:
    """The first link or joint that a refusal names."""
    found = re.search(r"\b(link|joint) '([^']+)'", said)
    return {} if found is None else {found[1]: found[2]}


def versions() -> dict[str, str]:
    """Versions of Python, this package, and every engine of the registry (or why it is missing)."""
    found = {"python": platform.python_version(), "platform": f"{platform.system()} {platform.machine()}"}
    for name in ("denoc-harness", "numpy", "scipy", "numba"):
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "not installed as a package"
    for name in registry.names():
        if name == NATIVE:
            continue
        try:
            found[name] = registry.engine(name).version()
        except EngineUnavailableError as error:
            found[name] = str(error)
    return found
