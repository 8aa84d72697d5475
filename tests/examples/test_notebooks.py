"""The notebooks of ``examples/`` run from end to end in a real kernel, and say what is true."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed")
nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed")
pytest.importorskip("ipykernel", reason="ipykernel is not installed")

EXAMPLES = Path(__file__).parents[2] / "examples"
LONGEST = 300  # s that a cell may take on a busy machine


def run(name: str) -> str:
    """Run a notebook; all that its cells print, and the text of what they show."""
    notebook = nbformat.read(EXAMPLES / name, as_version=4)
    nbclient.NotebookClient(notebook, timeout=LONGEST, resources={"metadata": {"path": str(EXAMPLES)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    shown = [output.get("text", "") or output.get("data", {}).get("text/plain", "") for output in outputs]
    assert any("text/html" in output.get("data", {}) for output in outputs)  # tables show themselves
    return "\n".join(shown)


def test_every_notebook_is_kept_without_outputs():
    names = sorted(path.name for path in EXAMPLES.glob("*.ipynb"))
    assert names == ["concealed_friction.ipynb", "flexible_pendulum.ipynb", "own_urdf.ipynb"]
    for name in names:
        cells = nbformat.read(EXAMPLES / name, as_version=4).cells
        assert all(not cell.get("outputs") and cell.get("execution_count") is None for cell in cells)


@pytest.mark.slow
def test_own_urdf_against_three_engines():
    told = run("own_urdf.ipynb")
    assert "left out: nothing" in told


@pytest.mark.slow
def test_concealed_friction_is_found():
    told = run("concealed_friction.ipynb")
    low, high = map(float, re.search(r"found: ([\d.]+) to ([\d.]+)", told).groups())
    assert low < 4e-3 < high and high - low < 5e-4
    assert "report.html" in told


@pytest.mark.slow
def test_flexible_pendulum_swings_and_vibrates_where_it_should():
    told = run("flexible_pendulum.ipynb")
    # Euler and Bernoulli's strip, pinned with this hub: 37.540 Hz; gravity changes it by less than half a hertz.
    assert float(re.search(r"first vibration ([\d.]+) Hz", told).group(1)) == pytest.approx(37.54, abs=0.5)
    assert float(re.search(r"strongest vibration at ([\d.]+)", told).group(1)) == pytest.approx(37.5, abs=2.0)
