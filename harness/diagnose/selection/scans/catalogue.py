"""All effects that are scanned by the linear response; one file of this package each, with the effect's name."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.scan import Scan
from harness.registered import registered

NAMES = ("cogging_torque", "base_excitation", "end_stop")


@cache
def scans() -> Mapping[str, Scan]:
    """Every scan by the name of its effect."""
    return registered(__package__, NAMES, Scan)


def scanned(candidate: Candidate) -> bool:
    """Whether the candidate is a force over angle or time that is to be tried at many places, by the linear response alone."""
    return candidate.effect.name in scans()
