"""What an answer was made from: model, recordings, version and day, so that it can be made again."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from harness.engines.registry import engine
from harness.recording import Recording
from harness.system import System


def provenance(
    system: System, models: Sequence[str | Path | System], recordings: Sequence[Recording], held: Recording | None
) -> dict[str, Any]:
    """Plain data; models: one for all recordings or one each.

    ``role`` of a recording: "training", "held out", or "both" where the end of a single one is held out.
    """
    every = [*recordings, *([held] if held is not None else [])]
    last = len(every) - 1
    roles = ["both"] if last == 0 else ["training"] * last + ["held out"]
    return {
        "version": engine("denoc").version(),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "model": {"name": system.name, "file": _file(models[0])},
        "recordings": [
            {
                "recording": recording.name,
                "file": recording.source,
                "samples": recording.samples,
                "duration": recording.duration,
                "interval": recording.interval,
                "role": role,
                **({"model": _file(models[k])} if len(models) > 1 else {}),
            }
            for k, (recording, role) in enumerate(zip(every, roles, strict=True))
        ],
    }


def _file(model: str | Path | System) -> str:
    return str(model.source or "") if isinstance(model, System) else str(model)
