"""What every unit of a fleet is asked, the same for all of them."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.diagnose.problem.tolerances import Tolerance
from harness.errors import InputError


@dataclass(frozen=True)
class Question:
    """Options of each unit's diagnosis, as ``diagnose`` takes them. model: of units without one of their own."""

    model: str | None
    mapping: tuple[str, ...] = ()
    tolerance: Tolerance | None = None
    fit_effort: bool = False
    effects: tuple[str, ...] = ()
    time_limit: float | None = None
    actuators: bool = True
    limits: bool = True
    allow: tuple[str, ...] = ()
    floating: bool = False

    def plain(self) -> dict[str, Any]:
        """What must be the same for answers to stand in one table; files by their content."""
        return {
            "model": None if self.model is None else _digest(self.model),
            "mapping": list(self.mapping),
            "tolerance": self.tolerance,
            "fit_effort": self.fit_effort,
            "effects": [_digest(path) for path in self.effects],
            "time_limit": self.time_limit,
            "actuators": self.actuators,
            "limits": self.limits,
            "floating": self.floating,
        }


def _digest(path: str) -> str:
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()
    except OSError as error:
        raise InputError(
            f"cannot be read: {error.strerror}", source=path, mend="check the path and its rights"
        ) from None
