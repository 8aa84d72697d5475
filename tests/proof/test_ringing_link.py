"""A mode that the model leaves out rings at one frequency, and so does hum on the sensor's cable.

Exudyn's finite elements of undamped spring steel ring on for as long as they are recorded. That was once told as hum, with the
frequency of the missing mode to four digits and no word of the link. The truth is what was concealed.
"""

from __future__ import annotations

from pathlib import Path

from one_concealed import told_of

SEED = 70213


def test_a_ringing_mode_is_not_told_as_hum_alone(tmp_path: Path) -> None:
    found = told_of("higher_mode", "flexible single", SEED, tmp_path)
    assert found["verdict"] == "explained"
    (told,) = found["findings"]
    assert "higher_mode@strip" in (f"{told['effect']}@{told['site']}", *told["indistinguishable_from"])
