"""A weight at the end of a strip, which the mounting's armature and the strip's length imitate with a sensor's wrong gain.

The recordings are those of a proof, by finite elements; the truth is what was concealed.
"""

from __future__ import annotations

from pathlib import Path

from harness import diagnose
from harness.proof.run import Task, conceal
from harness.proof.seal import unseal

SEED = 296277289
# The weight itself, and what promised more than it in a view that is linear about the bent model.
SOUGHT = ["sensor_gain", "sensor_hum", "sensor_lowpass", "added_inertia", "sensor_delay", "payload_mass"]


def test_a_weight_is_found_though_a_bent_model_and_a_sensor_s_gain_imitate_it(tmp_path: Path) -> None:
    name, digest = conceal(Task("flexible single", 2, "higher_mode"), SEED, tmp_path)
    folder = tmp_path / "cases" / name
    found = diagnose([str(r) for r in sorted(folder.glob("run*.csv"))], model=str(folder / "model.toml"), only=SOUGHT)
    (true,) = unseal(name, tmp_path / "sealed", digest)["planted"]
    assert true["effect"] == "payload_mass"
    assert found.verdict == "explained"
    (told,) = found.findings
    assert told["effect"] == "payload_mass"
    low, high = told["parameters"]["mass"]["ci95"]
    # One interval in twenty may miss, narrowly. Half as wide again, one in three hundred may.
    assert abs(true["parameters"]["mass"] - 0.5 * (low + high)) <= 0.75 * (high - low)
