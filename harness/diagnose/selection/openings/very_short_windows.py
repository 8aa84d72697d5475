"""Sets found on windows so short that a wrong force has no time to lead far away, where the nominal model is altogether off."""

from __future__ import annotations

from harness.diagnose.selection.opening import Opened, Opening
from harness.diagnose.selection.short_window_starts import begun, far_off


def _go(opened: Opened) -> None:
    if not opened.shorter:
        if not far_off(opened.short, opened.first):
            return
        opened.shorter = begun(opened.short, opened.fine, opened.effort, opened.progress)
    if opened.groups == opened.short.windows:
        opened.seeds += opened.shorter


OPENING = Opening(_go)
