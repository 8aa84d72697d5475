"""The mechanism in motion: measured beside both models, of the recording shown first."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.diagnose.answer.curves import Curves
from harness.report.animation import Motion, scene
from harness.report.diagnosis.curves import shown
from harness.report.diagnosis.sections.figure import Document
from harness.report.figures.before_after import AFTER, BEFORE
from harness.system import System


@dataclass(frozen=True)
class Animation:
    curves: Curves | None
    system: System | None
    anchor: str = "animation"
    title: str = "In motion"
    template: str = "diagnosis_plots.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        if self.curves is None or self.system is None or not self.curves.residuals:
            return None
        rows, _ = shown(self.curves.residuals)
        first = rows[0]
        mine = {
            r.channel.removesuffix(".position"): r
            for r in rows
            if (r.recording, r.held_out) == (first.recording, first.held_out) and r.channel.endswith(".position")
        }
        # Of a mechanism that is measured in part, the rest would be invented.
        if set(mine) != set(self.system.joint_names):
            return None
        every = [(r.measured, r.measured - r.nominal, r.measured - r.augmented) for r in mine.values()]
        good = np.all([np.isfinite(v) for signals in every for v in signals], axis=0)
        if good.sum() < 2:
            return None
        motions = [
            Motion(label, colour, {joint: signals[k][good] for joint, signals in zip(mine, every, strict=True)})
            for k, label, colour in ((1, "nominal", BEFORE), (2, "augmented", AFTER), (0, "measured", "ink"))
        ]
        title = f"{first.recording}{' (held out)' if first.held_out else ''}, in its own time"
        return {"words": "", "plots": [scene(self.system, first.time[good], motions, title).html()], "pictures": []}
