"""Greedy forward selection, the usual recipe of identification, over the whole catalogue."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np


def greedy_claims(folder: Path) -> dict[str, Any]:
    """Greedy forward selection over the whole catalogue: the best effect is added as long as BIC falls, on training
    data alone.

    The usual recipe of identification: same simulator and likelihood as the diagnosis, but no backward step, no data
    held out, no test of what remains.
    """
    import harness
    from harness.diagnose.estimation.likelihood import Likelihood
    from harness.diagnose.estimation.scatter import crude_colours
    from harness.diagnose.prediction.predictor import Predictor
    from harness.diagnose.problem.candidates import candidates
    from harness.diagnose.problem.problem import pose
    from harness.diagnose.problem.windows import whole
    from harness.diagnose.selection.constants.starts import MOTION_HARMONICS
    from harness.diagnose.selection.noise_behind import colours_from
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
    return {"findings": [{"effect": m.effect.name, "site": m.site} for m in best.hypothesis.members]}
