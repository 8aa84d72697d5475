"""What a force that is left out looks like as a formula: the sparsest one over position and velocity, where it says most of it."""

from __future__ import annotations

from dataclasses import dataclass

from harness.diagnose.answer.constants import FORMULA_SHARE, MOST_FORMULA_TERMS
from harness.diagnose.answer.explain import percent
from harness.diagnose.claims.conclude import Conclusion
from harness.diagnose.criticism.check import Form, left_by
from harness.diagnose.criticism.checks.force_of_few_terms import sparsest
from harness.diagnose.selection.outcome import Outcome
from harness.recording.units import written
from harness.system import System


@dataclass(frozen=True)
class Formula:
    """form: the terms. share: of the squares above the noise that it would take. unit: of the force."""

    form: Form
    share: float
    unit: str

    @property
    def sentence(self) -> str:
        """In words; nothing where it takes too many terms to say much."""
        if len(self.form.terms) > MOST_FORMULA_TERMS:
            return ""
        return (
            f"As a formula over position q and velocity v it is about {self.form} {written(self.unit)} at {self.form.joint}, "
            f"which would take {percent(self.share)} of it."
        )


def form_text(form: Form, system: System) -> str:
    """A form with its joint and unit, for programs."""
    return f"at {form.joint}: {form} {written(system.joint(form.joint).force_unit)}"


def formula(outcome: Outcome, conclusion: Conclusion) -> Formula | None:
    """The formula of most of what is left beside the set that is told; None where no force is left out, or none says so much.

    By least squares of what the sensors read: it describes, and counts for nothing as evidence.
    """
    if outcome.force is None:
        return None
    study, best = outcome.study.unfitted(outcome.study.likelihood.of_sensors), conclusion.best
    fitted = study.fit(best.hypothesis, [best.x], best)
    left, above = left_by(study, fitted), fitted.cost - study.samples
    system = outcome.problem.system
    at_joints = [left.at_joint(joint) for joint in system.joint_names]
    forms = [sparsest(there) for there in at_joints if there is not None]
    form = max(forms, key=lambda own: own.gain, default=None)
    if form is None or not form.terms or above <= 0.0 or form.gain < FORMULA_SHARE * above:
        return None
    # A linear view may promise more than there is.
    return Formula(form, min(form.gain / above, 1.0), system.joint(form.joint).force_unit)
