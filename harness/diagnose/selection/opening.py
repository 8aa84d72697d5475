"""What an opening of a search is: sets for whole runs to begin with, found where free runs have fewer wrong valleys.

An opening is a file of ``openings/`` that says ``OPENING = Opening(go)``, and its name stands in ``openings/catalogue.py``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.beam_search import Effort
from harness.diagnose.selection.constants.starts import NONLINEAR_COST_RATIO
from harness.diagnose.selection.model_error import Laws, Structure
from harness.diagnose.selection.short_window_starts import very_short
from harness.diagnose.selection.study import Study


@dataclass(eq=False)
class Opened:
    """How far a search has been opened; an opening adds to it.

    short: the study of short windows, and ``first`` the nominal model in it; groups: the windows joined, of which ``long`` is the
    study. seeds: fits of the long study to grow from, the nominal model first. shorter: sets found on the short windows.
    answer: what ends the search at once. reached: every study that was begun.
    """

    short: Study
    first: Fit
    groups: tuple[Window, ...]
    effort: Effort
    progress: Callable[[str], None]
    structure: Structure
    laws: Laws
    reached: list[Study]
    shorter: list[Fit] = field(default_factory=list)
    answer: tuple[Study, list[Fit]] | None = None
    _fine: Study | None = None

    def __post_init__(self) -> None:
        self.lengthen(self.short)

    def lengthen(self, short: Study) -> None:
        """The study of joined windows with the efforts of a short one, and its nominal model as the only seed."""
        self.long = Study(
            short.problem, short.predictor, short.likelihood, short.candidates, self.groups,
            first_states=self.first.states, swing=short.swing, hints=short.tests,
        )  # fmt: skip
        self.empty = self.long.fit(Hypothesis(), [self.first.x], self.first.beginning(self.groups))
        self.seeds = [self.empty]
        self.reached.append(self.long)

    def restart(self, short: Study) -> None:
        """The same with the efforts of another study of the same short windows."""
        self.short, self.first, self._fine = short, short.known(Hypothesis()) or short.empty(), None
        self.reached.append(short)
        self.lengthen(short)

    @property
    def lost(self) -> bool:
        """Whether free runs of the nominal model say little about what is missing."""
        return self.empty.score > NONLINEAR_COST_RATIO * self.long.samples

    @property
    def fine(self) -> Study:
        """The study of very short windows."""
        if self._fine is None:
            self._fine = very_short(self.short)
        return self._fine


@dataclass(frozen=True, eq=False)
class Opening:
    """One opening. go: adds to a search, where it has something to add."""

    go: Callable[[Opened], None]
