"""``diagnose``: from recordings and a nominal model to what the model left out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.denoc.compiling.pipeline import fewer_collections
from harness.diagnose.answer.answer import answer
from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.answer.nothing_fitted import crude_noise, nothing_fitted
from harness.diagnose.answer.provenance import provenance
from harness.diagnose.claims.conclude import conclude
from harness.diagnose.conditioning.conventions import conventional
from harness.diagnose.conditioning.free_motion import free_parts
from harness.diagnose.conditioning.held_start import released
from harness.diagnose.conditioning.poses import in_charts
from harness.diagnose.estimation import assemblies
from harness.diagnose.inverse.effort import diagnose_effort
from harness.diagnose.inverse.efforts_first import ByEfforts, by_efforts
from harness.diagnose.levels.differing_levels import differing_levels
from harness.diagnose.levels.disagreement import disagreement
from harness.diagnose.levels.known_error import worth_of_known_error
from harness.diagnose.problem.acting import acting, coupled
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.deadline import Deadline, Spared, TimeUp, deadline_of
from harness.diagnose.problem.payloads import one_each, payload
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.tolerances import Tolerance, with_tolerances
from harness.diagnose.selection import effort_hold
from harness.diagnose.selection.beam_search import Effort
from harness.diagnose.selection.investigation import investigate
from harness.diagnose.transmission.second_encoders import parted
from harness.diagnose.transmission.transmission import as_of_one_body, links_apart, with_second_encoders
from harness.effects.catalogue import register
from harness.effects.effect import Effect
from harness.effects.scale import swing
from harness.effects.user import load_user_effects
from harness.engines.attached import check_attached
from harness.errors import InputError, UnsupportedError, not_of_the_input
from harness.parallel import one_blas_thread
from harness.recording import Recording, read_recordings
from harness.system import System, load
from harness.system.charted import turning
from harness.system.followers import screws_apart
from harness.system.loop import explicit
from harness.system.lowering import freed, one_degree

Progress = Callable[[int, int, str], None]
BENDING = ("link_flexibility",)
APART = ("whether each recording is explained by itself", "recordings may be of different rigs, which is not told")
LEVELS = ("whether friction differs from recording to recording", "its size may be a mean of several")


@one_blas_thread()
@fewer_collections()
def diagnose(
    recordings: Sequence[str | Path | Recording],
    model: str | Path | System | Sequence[str | Path | System],
    *,
    holdout: str | Path | Recording | None = None,
    mapping: str | Sequence[str] | None = (),
    tolerance: Tolerance | None = None,
    fit_effort: bool = False,
    effects: Sequence[str | Path | Effect] = (),
    only: Sequence[str] = (),
    effort: Effort | None = None,
    progress: Progress | None = None,
    time_limit: float | Deadline | None = None,
    actuators: bool = True,
    limits: bool = True,
) -> Diagnosis:
    """Locate where a model leaves recordings, name the physics it left out, and judge the improvement on data held out.

    recordings: files or ``Recording``; the last of several is held out, or the last 30 % of a single one. model: file or System; or
    one for each recording, the one held out last, which differ in what rigid links carry: laws are then those of all, and the
    augmented model is the first one's.
    holdout: recording to judge on instead. mapping: rules for foreign columns. tolerance: relative 1σ of the nominal masses,
    lengths, inertias and stiffnesses, overriding the model's; or of single ones (``{"servo.armature": 0.2}``). fit_effort:
    efforts are measurements to fit, not known inputs (see ``diagnose_effort``). effects: effects of the user's own. only:
    restricts the catalogue to these names. progress: called with (done, total, what). time_limit: after so long [s] the best
    answer so far is given, with what was not tried; a ``Deadline`` can be interrupted, too. actuators: whether those of an MJCF
    act where no effort is recorded, by their recorded commands (``<joint>.command``) or held at 0. limits: whether its joints'
    limits act where a recording meets them.
    Raises InputError for recordings, models or time limits that cannot be used.
    """
    deadline = deadline_of(time_limit)
    if isinstance(recordings, (str, Path, Recording)):
        recordings = [recordings]
    models = [model] if isinstance(model, (str, Path, System)) else list(model)
    if not models:
        raise InputError("no model given", mend="name the model of the rig")
    stated = [screws_apart(one if isinstance(one, System) else load(one, physical=False)) for one in models]
    if fit_effort and len(stated) > 1:
        raise InputError(
            "efforts are fitted to one model", mend="diagnose the recordings of each payload by themselves"
        )
    in_space = bool(turning(stated[0]))
    if fit_effort and (in_space or stated[0].loops):
        raise _no_tree(stated[0])
    if in_space and len(stated) > 1:
        raise UnsupportedError("models of several payloads have no balls or free joints here", mend="give one model")
    as_read = _read(recordings, holdout, mapping, stated[0] if in_space else _nominal(stated[0], tolerance))
    if in_space:
        one, as_read = in_charts(stated[0], as_read)
        stated = [one]
    systems = [_nominal(one, tolerance) for one in stated]
    ready = []
    for mechanism, one in zip(stated, systems, strict=True):
        following, read = coupled(mechanism, one, as_read)
        ready.append(acting(_led(following, read), read, actuators=actuators, limits=limits))
    system, read = ready[0]
    if fit_effort and system.loops:
        raise _no_tree(system)
    notes = tuple(dict.fromkeys(note for one, _ in ready for note in one.notes))
    every_system = one_each([one for one, _ in ready], len(as_read))
    payloads = [payload(system, one) for one in every_system]
    if not system.drives:
        # What these look for is the motion of a mechanism that nothing holds.
        read = _conditioned(every_system, read)
    read, second = parted(read)
    held = read.pop() if holdout is not None else None
    made_from = provenance(system, models, read, held)
    steps = 0

    def tell(what: str) -> None:
        nonlocal steps
        steps += 1
        if progress is not None:
            progress(steps, max(40, steps + 5), what)

    tell("reading")
    further = [e for item in effects for e in ([item] if isinstance(item, Effect) else load_user_effects(item))]
    register(further)
    for mechanism in stated:
        check_attached(mechanism)
    second = links_apart(system, read, held, second)
    if fit_effort:
        rigid, last = as_of_one_body(system, read, held, second)
        by_effort = diagnose_effort(system, rigid, last, only=only, further=further, tell=tell, deadline=deadline)
        by_effort = with_second_encoders(by_effort, system, read, held, second)
        return replace(by_effort, provenance=made_from, notes=notes)
    efforts = ByEfforts(None, deadline, deadline)
    if not further and not any(payloads):
        efforts = by_efforts(system, read, held, only=only, tell=tell, deadline=deadline)
        deadline = efforts.motion
    problem = pose(system, read, heldout=held, payloads=payloads)
    every = [*read, *([held] if held is not None else [])]
    carrying = {link for change in payloads for link in change}
    # A link that bends carries its payload elsewhere than a rigid one's origin.
    known = [
        c for c in candidates(system, every, only=only, further=further)
        if not (c.effect.name in BENDING and c.site in carrying)
    ]  # fmt: skip
    frequency = swing(system, read[0]) / (2.0 * np.pi)
    # A user's own law can refuse what it is given.
    with nullcontext() if further else not_of_the_input():
        try:
            outcome = investigate(
                problem,
                known,
                frequency,
                effort=effort,
                progress=tell,
                structure=worth_of_known_error,
                laws=efforts.laws,
                deadline=deadline,
            )
            tell("weighing what was found")
            conclusion = conclude(outcome)
        except TimeUp:
            nothing = efforts.instead(None) or nothing_fitted(crude_noise(problem), every, deadline)
            return replace(nothing, provenance=made_from, notes=notes)
        train, judged = (read, [held]) if held is not None else (read[:-1], read[-1:])
        levels = deadline.attempt(*LEVELS, lambda: differing_levels(outcome, conclusion, train, judged), lambda: None)
        apart = deadline.attempt(*APART, lambda: None if levels else disagreement(outcome, conclusion), lambda: None)
        tell("telling")
        notes += assemblies.told(outcome.predictor, outcome.problem.runs)
        with deadline.spared(Spared.TO_ITS_END):
            # What takes long in it is an attempt, with an end of its own.
            found = answer(outcome, conclusion, effort_hold.told(outcome.problem, every), levels, apart)
    found = with_second_encoders(efforts.instead(found) or found, system, read, held, second)
    return replace(found, provenance=made_from, notes=notes)


def _no_tree(system: System) -> UnsupportedError:
    return UnsupportedError(
        "efforts are fitted to trees of joints of one degree of freedom, none of which follows another",
        mend="leave out --fit-effort: recorded efforts then drive the model",
        source=system.source,
    )


def _nominal(system: System, tolerance: Tolerance | None) -> System:
    # Joints that are polynomials of others are left to ``coupled``, as those are that mimic others.
    loops = () if explicit(system.loops) else system.loops
    system = replace(one_degree(freed(replace(system, loops=())), "a diagnosis"), loops=loops)
    return system if tolerance is None else with_tolerances(system, tolerance)


def _led(system: System, recordings: Sequence[Recording]) -> System:
    """The system with the recorded joints leading, where loops let them tell the others."""
    if not system.loops:
        return system
    recorded = {c.site for recording in recordings for c in recording.channels if c.quantity == "position"}
    return replace(system, leading=tuple(name for name in system.joint_names if name in recorded))


def _conditioned(systems: Sequence[System], recordings: Sequence[Recording]) -> list[Recording]:
    """Recordings counted from their models' zeros, without what is held or carried at their ends."""
    alike: dict[int, list[int]] = {}
    for k, system in enumerate(systems):
        alike.setdefault(id(system), []).append(k)
    stated = list(recordings)
    for places in alike.values():
        for k, one in zip(places, conventional(systems[places[0]], [recordings[k] for k in places]), strict=True):
            stated[k] = one
    let_go = released(stated)
    out = list(let_go)
    for places in alike.values():
        for k, one in zip(places, free_parts(systems[places[0]], [let_go[k] for k in places]), strict=True):
            out[k] = one
    return out


def _read(
    recordings: Sequence[str | Path | Recording],
    holdout: str | Path | Recording | None,
    mapping: str | Sequence[str] | None,
    system: System,
) -> list[Recording]:
    items = [*recordings, *([holdout] if holdout is not None else [])]
    paths = [item for item in items if not isinstance(item, Recording)]
    from_files = iter(read_recordings(paths, mapping=mapping, system=system)) if paths else iter(())
    found = [item if isinstance(item, Recording) else next(from_files) for item in items]
    if not found:
        raise InputError("no recording given", mend="name at least one recording file")
    return found
