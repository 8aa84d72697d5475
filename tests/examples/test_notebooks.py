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


def run(name: str, folder: Path = EXAMPLES) -> str:
    """Run a notebook in a folder; all that its cells print, and the text of what they show."""
    notebook = nbformat.read(EXAMPLES / name, as_version=4)
    nbclient.NotebookClient(notebook, timeout=LONGEST, resources={"metadata": {"path": str(folder)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    shown = [output.get("text", "") or output.get("data", {}).get("text/plain", "") for output in outputs]
    assert any("text/html" in output.get("data", {}) for output in outputs)  # tables show themselves
    return "\n".join(shown)


def test_every_notebook_is_kept_without_outputs():
    names = sorted(path.relative_to(EXAMPLES).as_posix() for path in EXAMPLES.rglob("*.ipynb"))
    assert names == ["concealed_friction.ipynb", "flexible_pendulum.ipynb", "own_urdf.ipynb", "paper/paper.ipynb"]
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


@pytest.mark.slow
def test_the_paper_from_its_table_to_the_answer():
    told = run("paper/paper.ipynb", EXAMPLES.parent)
    assert "is 40000 kg/m³" in told
    assert "the elastic stiffness is missing in the equation of rod's bending" in told
    # 2 J ω ζ of a swing that loses by dry friction too is more than its viscous part of 1.0e-3.
    assert re.search(r"every sample: viscous and dry", told)
    # The ratio that the strip was given.
    assert float(re.search(r"the strip itself ([\d.]+)", told).group(1)) == pytest.approx(0.004, rel=0.03)
    assert "coulomb_friction" in re.search(r"found: (.*)", told).group(1)
