"""Recordings: read, map, check; noise; sensors as measurement models.

The names below are imported when first used: a process that reads one foreign file needs no statistics.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

_HOME = {
    "Channel": "recording",
    "NoiseEstimate": "noise",
    "QualityNote": "recording",
    "Recording": "recording",
    "estimate_noise": "noise",
    "quality_table": "quality",
    "read_recording": "read",
    "read_recordings": "read",
    "recording_noise": "noise",
}
__all__ = [
    "Channel",
    "NoiseEstimate",
    "QualityNote",
    "Recording",
    "estimate_noise",
    "quality_table",
    "read_recording",
    "read_recordings",
    "recording_noise",
]

if TYPE_CHECKING:
    from harness.recording.noise import NoiseEstimate, estimate_noise, recording_noise
    from harness.recording.quality import quality_table
    from harness.recording.read import read_recording, read_recordings
    from harness.recording.recording import Channel, QualityNote, Recording


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
