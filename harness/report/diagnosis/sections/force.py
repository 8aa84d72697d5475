"""What the nominal model lacks as a force over the motion, as energy by half-swing, and by frequency."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from harness.diagnose.answer.curves import Curves
from harness.effects.force_table import NAME, ForceTable
from harness.report.diagnosis.curves import energy, forces, phase, spectra, unnamed
from harness.report.diagnosis.sections.figure import Document


@dataclass(frozen=True)
class MissingForce:
    curves: Curves | None
    anchor: str = "force"
    title: str = "What the nominal model lacks"
    template: str = "diagnosis_plots.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        if self.curves is None:
            return None
        pictures = [(f"{f.joint}: missing force over the phase plane", phase(f)) for f in self.curves.forces]
        pictures += [
            (f"{e.joint}: energy lost per half-swing against amplitude", energy(e)) for e in self.curves.energy
        ]
        plots = [*forces(self.curves), *spectra(self.curves.spectra)]
        if not pictures and not plots:
            return None
        words = (
            "Missing force: the generalized force that inverse dynamics of the nominal model asks for along the smoothed motion "
            "of the training recordings, less what was applied. Below, the spectrum of what each model leaves of them."
        )
        return {
            "words": words if self.curves.forces else "Spectrum of what each model leaves of the training recordings.",
            "plots": [plot.html() for plot in plots],
            "pictures": [(caption, Markup(svg)) for caption, svg in pictures],
        }


@dataclass(frozen=True)
class UnnamedForce:
    curves: Curves | None
    table: ForceTable | None
    anchor: str = "unnamed-force"
    title: str = "A force that nobody has named"
    template: str = "diagnosis_plots.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        if self.table is None or self.curves is None:
            return None
        laws = [key for key in document["predictive"]["effects"] if not key.startswith(f"{NAME}@")]
        beside = f"Beside {' + '.join(laws)}" if laws else "Beside the nominal model"
        known = [f for f in self.curves.forces if f.joint in self.table.joints]
        return {
            "words": f"{beside}, this force on the joint predicts best by the training recordings, whose motion is dotted: it acts "
            "wherever a motion passes the same position at the same velocity. Away from the dots it fades, and is a guess. "
            "predictive.toml has it; denoc simulate predictive.toml --effects predictive_force.py runs it.",
            "plots": [],
            "pictures": [
                (f"{f.joint}: force in predictive.toml over the phase plane", Markup(unnamed(f, self.table)))
                for f in known
            ],
        }
