"""What the parameters of a hypothesis stand for: a system, the mechanism compiled for it, and its rows of parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.denoc.lanes.model import LaneModel
from harness.diagnose.prediction.constants import FARTHEST_NOMINAL
from harness.diagnose.prediction.coordinates import from_internal, start_vector, to_internal
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis, Nominal, nominal_quantities, scaled, tolerances
from harness.diagnose.problem.windows import Window
from harness.effects.catalogue import effect
from harness.effects.directions import sideways
from harness.effects.effect import UserLaw
from harness.effects.lanes import lane_model, lane_row, write_attachment
from harness.effects.room import STATED
from harness.system import Attachment, System

Array = NDArray[np.float64]

CLEARANCE = "gap"  # the slot of a loop that opens it
MOST_KEPT = 4000  # rows, with the systems that they were made of


@dataclass(frozen=True, eq=False)
class Mechanism:
    """A system compiled for lanes, with the places of the original coordinates among its own."""

    model: LaneModel
    names: tuple[str, ...]


class Mechanisms:
    """Systems, mechanisms and rows of hypotheses about one nominal system; what is compiled or made is kept."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.nominal: tuple[Nominal, ...] = nominal_quantities(system)
        self._shaking = sideways(system)
        self._mechanisms: dict[tuple[tuple[str, UserLaw | None], ...], Mechanism] = {}
        self._made: dict[tuple[tuple[str, ...], bytes], tuple[Array, System]] = {}

    def size(self, hypothesis: Hypothesis) -> int:
        """Number of parameters that all windows share: nominal quantities, then those of the effects."""
        return len(self.nominal) + hypothesis.size

    def state_size(self, hypothesis: Hypothesis) -> int:
        return 2 * len(self.mechanism(hypothesis).names)

    def closed(self, state: Array) -> Array:
        """A state (2n,) of the nominal mechanism with its loops closed, as it is where they cannot be."""
        model = self.mechanism(Hypothesis()).model
        found = model.closed(lane_row(model, self.system)[None], state[None])[0]
        return found if np.isfinite(found).all() else state

    def following(self, hypothesis: Hypothesis) -> NDArray[np.bool_]:
        """Which initial positions and velocities follow others by loops, (2n,): steps of the others tell them.

        A step of theirs would do nothing, but from zero loops would close in another way. Within the clearance of a loop its frames
        go free of each other; what else the loops hold follows all the same.
        """
        mechanism = self.mechanism(hypothesis)
        acting = [(member.effect, member.site) for member in hypothesis.members]
        acting += [(effect(own.effect), own.site) for own in self.system.attachments]
        parted = {site for own, site in acting if own.law is not None and CLEARANCE in own.law.slots}
        follow = mechanism.model.following(parted)
        return np.tile(np.array([name in follow for name in mechanism.names], dtype=bool), 2)

    def with_followers(self, hypothesis: Hypothesis, x: Array, states: Mapping[Window, Array]) -> dict[Window, Array]:
        """States (2n,) of windows with what follows by loops where the others have moved to, as far as it can be."""
        model = self.mechanism(hypothesis).model
        if not model.dependent:
            return dict(states)
        own = np.array(list(states.values()))
        found = model.closed(np.repeat(self.row(hypothesis, x)[None], len(own), axis=0), own)
        lost = np.logical_not(np.isfinite(found).all(axis=1, keepdims=True))
        return dict(zip(states, np.where(lost, own, found), strict=True))

    def effect_values(self, hypothesis: Hypothesis, k: int, x: Array) -> Array:
        """SI values of member k's parameters from the parameter vector (or vectors, last axis)."""
        span = hypothesis.span(k)
        offset = len(self.nominal)
        return from_internal(hypothesis.members[k], x[..., offset + span.start : offset + span.stop])

    def with_values(self, hypothesis: Hypothesis, k: int, x: Array, values: Array) -> Array:
        """The parameter vector with SI values in the place of member k's parameters: the inverse of ``effect_values``."""
        span = hypothesis.span(k)
        offset = len(self.nominal)
        out = x.copy()
        out[offset + span.start : offset + span.stop] = to_internal(hypothesis.members[k], values)
        return out

    def without(self, hypothesis: Hypothesis, k: int, x: Array) -> Array:
        """The parameter vector without those of member k."""
        span, offset = hypothesis.span(k), len(self.nominal)
        return np.delete(x, np.arange(offset + span.start, offset + span.stop))

    def takes_back(self, hypothesis: Hypothesis, k: int, x: Array) -> bool:
        """Whether member k takes away some of the dissipation that the model states."""
        return hypothesis.members[k].effect.name in STATED and bool(self.effect_values(hypothesis, k, x)[0] < 0.0)

    def altered(self, hypothesis: Hypothesis, x: Array) -> System:
        """The system with nominal factors and reshaping effects applied (joint laws are left to the rows)."""
        # A step that is tried may be absurd; its run is followed no more than its numbers can be held.
        factors = np.exp(
            np.clip(tolerances(self.nominal) * x[: len(self.nominal)], -FARTHEST_NOMINAL, FARTHEST_NOMINAL)
        ).tolist()
        system = scaled(self.system, self.nominal, factors)
        reshaping = [(k, m.effect.reshape, m) for k, m in enumerate(hypothesis.members) if m.effect.reshape is not None]
        # What adds coordinates comes first: its directions are those of the upright system.
        for k, reshape, member in sorted(reshaping, key=lambda item: not item[2].effect.adds_coordinates):
            values = self.effect_values(hypothesis, k, x)
            system = reshape.change(system, member.site, member.effect.named(values))
        return system

    def mechanism(self, hypothesis: Hypothesis) -> Mechanism:
        """The compiled system of the hypothesis' topology."""
        compiled = [m for m in hypothesis.members if m.effect.user or m.effect.adds_coordinates]
        # Laws of one name may be tables with other numbers.
        key = tuple(sorted(((m.key, m.effect.user) for m in compiled), key=lambda own: own[0]))
        if key not in self._mechanisms:
            start = np.concatenate([np.zeros(len(self.nominal)), *(start_vector(m) for m in hypothesis.members)])
            system = self.altered(hypothesis, start)
            own = [m.effect for m in hypothesis.members if m.effect.user is not None]
            self._mechanisms[key] = Mechanism(lane_model(system, own), system.coordinate_names)
        return self._mechanisms[key]

    def row(self, hypothesis: Hypothesis, x: Array) -> Array:
        """Parameter row of one lane."""
        return self.rows(hypothesis, x[None])[0]

    def rows(self, hypothesis: Hypothesis, x: Array) -> Array:
        """Parameter rows of lanes with parameter vectors ``x``, shape (K, size)."""
        return self.made(hypothesis, x)[0]

    def made(self, hypothesis: Hypothesis, x: Array) -> tuple[Array, tuple[System, ...]]:
        """Parameter rows (K, P) and the systems that they were made of, one and the same where nothing of them differs."""
        mechanism = self.mechanism(hypothesis)
        model = mechanism.model
        values = [self.effect_values(hypothesis, k, x) for k in range(len(hypothesis.members))]
        structural = tuple(m.key for m in hypothesis.members if m.effect.reshape is not None)
        shaping = [v for m, v in zip(hypothesis.members, values, strict=True) if m.effect.reshape is not None]
        shapes = np.ascontiguousarray(np.concatenate([x[:, : len(self.nominal)], *shaping], axis=1))
        rows = np.empty((len(x), model.P))
        systems = []
        for place, shape in enumerate(shapes):
            key = (structural, shape.tobytes())
            found = self._made.get(key)
            if found is None:
                system = self.altered(hypothesis, x[place])
                found = lane_row(model, system), system
                if len(self._made) > MOST_KEPT:
                    self._made.clear()
                self._made[key] = found
            rows[place], system = found
            systems.append(system)
        first = model.slot("base", "excitation_x")
        rows[:, first : first + 3] = self._shaking
        for member, own in zip(hypothesis.members, values, strict=True):
            if member.effect.law is not None:
                write_law(rows, model, member, own)
            elif member.effect.user is not None:
                for row, one in zip(rows, own, strict=True):
                    attached = Attachment(member.effect.name, member.site, member.effect.named(one))
                    write_attachment(row, model, attached, {member.effect.name: member.effect})
        return rows, tuple(systems)


def write_law(rows: Array, model: LaneModel, candidate: Candidate, values: Array) -> None:
    """Put a joint law's parameters (K, k) into rows (K, P); what the nominal model has in the same slot is added to, not
    replaced."""
    law = candidate.effect.law
    assert law is not None
    added = [
        model.slot(candidate.site, slot)
        for slot, parameter in zip(law.slots, candidate.effect.parameters, strict=True)
        if parameter.neutral == 0.0
    ]
    before = rows[:, added]
    law.write(rows, model, candidate.site, values)
    rows[:, added] += before
    if candidate.effect.name in STATED:
        # What is stated is uncertain too: less than stated may be all of it, but never more, or friction would drive.
        rows[:, added] = np.maximum(rows[:, added], np.minimum(before, 0.0))
