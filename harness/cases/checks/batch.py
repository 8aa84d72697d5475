"""Many states in one call against other engines, one state at a time; and what a batch of equal rows has otherwise."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Row, Series
from harness.cases.checks.states import States, difference_of, evaluate, random_states, where
from harness.compare.answers import Completed, Few
from harness.compare.attribution import attribute
from harness.compare.single_answer import blame_answer
from harness.denoc import Denoc
from harness.engines.protocol import EngineError, EngineModel
from harness.errors import UnsupportedError

BATCH, FEW = "the batch", 8
# What a batch method answers, and the arguments it takes, of the members of ``States``.
BATCHES = {
    "acceleration": ("forward_dynamics_batch", ("q", "qd", "tau")),
    "inverse_dynamics": ("inverse_dynamics_batch", ("q", "qd", "qdd")),
    "mass_matrix": ("mass_matrix_batch", ("q",)),
}


@dataclass(frozen=True)
class BatchAgreement:
    """Largest relative difference between a ``*_batch`` method of the native dynamics and each other engine.

    of: a key of ``BATCHES``. allowed, why: as in ``StateAgreement``. states: not a multiple of eight, so that a group of
    eight that is not full is among them. elastic: 1σ of elastic coordinates.
    """

    of: str
    allowed: float
    why: str
    states: int = 19
    elastic: float = 0.0

    @property
    def quantity(self) -> str:
        return BATCHES[self.of][0]

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        method, arguments = BATCHES[self.of]
        states = random_states(bench, self.states, 1.0, 1.0, self.elastic)
        native = Denoc(bench.system)
        ours = getattr(native, method)(*(getattr(states, name) for name in arguments))
        ours = np.asarray(ours).reshape(self.states, -1)
        for name, model in bench.peers():
            try:
                theirs = evaluate(self.of, model, states)
                mass = np.array([model.mass_matrix(q) for q in states.q])
            except UnsupportedError as error:
                yield bench.skipped(self.quantity, (NATIVE, name), str(error))
                continue
            apart = difference_of(self.of, mass, ours, theirs)
            worst = int(np.argmax(apart))
            place, note = None, f"{self.states} states in one call"
            if not apart[worst] <= self.allowed:
                said, site = in_rows(bench, self.of, native, name, states)
                place = where(bench.system, self.of, worst, ours[worst], theirs[worst]) | site
                note = "; ".join(filter(None, [note, said]))
            yield bench.row(
                self.quantity,
                (NATIVE, name),
                float(apart[worst]),
                self.allowed,
                why=self.why,
                first_divergence=place,
                note=note,
            )


def in_rows(bench: Bench, of: str, native: Denoc, name: str, states: States) -> tuple[str, dict[str, object]]:
    """The term in which a batch of equal rows is otherwise than an engine, and where; or that it is how rows stand together."""
    if bench.system.loops:
        return "", {}
    method, _ = BATCHES[of]

    def row(*one: Array) -> Array:
        # As many as were asked, for few rows may go another way.
        return np.asarray(getattr(native, method)(*(np.tile(x, (len(states.q), 1)) for x in one))[-1])

    return of_row(of, row, name, bench.models[name], states.q[:FEW], states.qd[:FEW], states.tau[:FEW])


def of_row(
    of: str, row: Callable[..., Array], name: str, model: EngineModel, q: Array, qd: Array, tau: Array
) -> tuple[str, dict[str, object]]:
    """The term in which what a batch gives for a state is otherwise than an engine's, at some states (B, n), and where.

    of: a key of ``BATCHES``; row: what a batch of equal rows gives, of the arguments of that method. Where it is right at all of
    them, it is how different rows stand together.
    """
    batch = Few(model.names, **{"forward_dynamics" if of == "acceleration" else of: row})
    try:
        if of == "acceleration":
            found = attribute(model, Completed(batch, model), q, qd, tau, called=(name, BATCH), derived=True)
            blame, said = found.culprit, found.sentence()
        else:
            blame = blame_answer(of, model, batch, q, qd)
            said = "" if blame is None else blame.words
    except (UnsupportedError, EngineError, np.linalg.LinAlgError):
        return "", {}
    if blame is None:
        return "equal rows are right, so it is how different ones stand together", {"term": "rows"}
    return said, {"term": blame.term, "at": blame.coordinate}
