"""Recordings: read, map, check; noise; sensors as measurement models."""

from harness.recording.noise import NoiseEstimate, estimate_noise, recording_noise
from harness.recording.quality import quality_table
from harness.recording.read import read_recording, read_recordings
from harness.recording.recording import Channel, QualityNote, Recording

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
