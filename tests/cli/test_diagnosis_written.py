"""What a diagnosis found is on the disk before it is on the terminal."""

import json

import numpy as np

from harness.cli.main import status_of
from harness.report import diagnosis as shown

URDF = """<robot name="rig"><link name="base"/><link name="rod"><inertial><origin xyz="0 0 -0.15"/><mass value="0.2"/>
<inertia ixx="1.5e-3" iyy="1.5e-3" izz="1e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="pivot" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
<dynamics damping="2e-3"/></joint></robot>"""


def test_a_terminal_that_fails_loses_no_files(tmp_path, monkeypatch, capfd):
    # A small swing of a damped linear oscillator (closed form).
    inertia, moment, damping = 1.5e-3 + 0.2 * 0.15**2, 0.2 * 9.81 * 0.15, 2e-3
    time, decay = np.arange(0.0, 3.0, 0.02), 0.5 * damping / inertia
    rate = np.sqrt(moment / inertia - decay**2)
    q = 0.05 * np.exp(-decay * time) * (np.cos(rate * time) + decay / rate * np.sin(rate * time))
    table = np.column_stack([time, q + 1e-4 * np.random.default_rng(0).standard_normal(len(time))])
    np.savetxt(tmp_path / "run.csv", table, delimiter=",", header="time,pivot.position", comments="")
    (tmp_path / "rig.urdf").write_text(URDF)

    def gone(*_):
        raise ValueError("no terminal")

    monkeypatch.setattr(shown, "print_diagnosis", gone)
    out = tmp_path / "out"
    given = [str(tmp_path / "run.csv"), "--model", str(tmp_path / "rig.urdf"), "--out", str(out)]
    assert status_of(["diagnose", *given]) == 2 and "no terminal" in capfd.readouterr().err
    assert json.loads((out / "diagnosis.json").read_text())["schema"] == "denoc.diagnosis/1"
    assert {"report.html", "augmented.toml"} <= {path.name for path in out.iterdir()}
