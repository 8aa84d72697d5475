"""A mode that the model leaves out rings at one frequency, and so does hum on the sensor's cable.

Exudyn's finite elements of undamped spring steel ring on for as long as they are recorded. That was once told as hum, with the
frequency of the missing mode to four digits and no word of the link. The truth is what was concealed.
"""

from __future__ import annotations

from pathlib import Path

from harness.proof.run import EFFECTS_BY_KIND, Task, _shuffled, conceal, diagnose_folder
from harness.proof.seal import unseal

SEED = 70213


def test_a_ringing_mode_is_not_told_as_hum_alone(tmp_path: Path) -> None:
    kind = "flexible single"
    (task,) = (t for t in (Task(kind, 0, e) for e in EFFECTS_BY_KIND[kind]) if _shuffled(t, SEED) == "higher_mode")
    name, digest = conceal(task, SEED, tmp_path, short=False)
    found = diagnose_folder(tmp_path / "cases" / name)
    assert [p["effect"] for p in unseal(name, tmp_path / "sealed", digest)["planted"]] == ["higher_mode"]
    assert found["verdict"] == "explained"
    (told,) = found["findings"]
    assert "higher_mode@strip" in (f"{told['effect']}@{told['site']}", *told["indistinguishable_from"])
