"""What was found in a recording, as a short table."""

from __future__ import annotations

import numpy as np

from harness.recording.noise import estimate_noise
from harness.recording.recording import Recording
from harness.recording.units import written


def quality_table(recording: Recording) -> list[dict[str, str]]:
    """Rows of ``channel``, ``finding``, ``done``: one of facts for each channel, then one for each quality note.

    Rendering is for others; every value is text.
    """
    rows = [
        {
            "channel": "time",
            "finding": f"{recording.samples} samples over {recording.duration:.4g} s, {1.0 / recording.interval:.5g} Hz",
            "done": f"counted from the first sample (in the file: {recording.start:.10g} s)" if recording.start else "",
        }
    ]
    for channel in recording.channels:
        finite = channel.values[np.isfinite(channel.values)]
        noise = estimate_noise(recording.time, channel.values, unit=channel.unit, channel=channel.name)
        rows.append(
            {
                "channel": channel.name,
                "finding": f"from {finite.min():.4g} to {finite.max():.4g} {channel.unit}; {noise.words()}",
                "done": f"from column {channel.column!r}" if channel.column not in ("", channel.name) else "",
            }
        )
    rows += [
        {
            "channel": effort.name,
            "finding": f"applied, from {effort.values.min():.4g} to {effort.values.max():.4g} {effort.unit}",
            "done": "taken as known",
        }
        for effort in recording.efforts
    ]
    rows += [
        {
            "channel": command.name,
            "finding": f"commanded, from {command.values.min():.4g} to {command.values.max():.4g} {written(command.unit)}".rstrip(),
            "done": "its actuator acts by it",
        }
        for command in recording.commands
    ]
    rows += [
        {"channel": note.channel, "finding": f"{note.kind.replace('_', ' ')}: {note.what}", "done": note.done}
        for note in recording.quality
    ]
    return rows
