"""Ordinary dissipation is found however far off the nominal model is, before anything else is looked for.

The truth: a carriage on a rail, M dv/dt = F(t) - F_v v - F_c sign(v) + F_0 (the model that Janot, Gautier and Brunot, Data set and
reference models of EMPS (2019), identify), integrated by semi-implicit Euler in steps of 0.05 ms, at rest where the drive does not
overcome the dry friction. The nominal model is the mass alone, whose free runs do not come near.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from simulated_recordings import recording

from harness import load
from harness.diagnose.diagnose import candidates, pose
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.windows import Window, equal_parts
from harness.diagnose.selection.dissipation_starts import everywhere
from harness.diagnose.selection.short_window_starts import ordinary_by_way_of_shorter, very_short
from harness.diagnose.selection.study import Study

MASS, VISCOUS, DRY, OFFSET = 95.0, 203.0, 20.4, -3.2
NOISE, RATE, LENGTH, STEP = 2e-5, 200.0, 18.0, 5e-5

MODEL = f"""<robot name="carriage"><link name="rail"/>
<link name="slide"><inertial><mass value="{MASS}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="carriage" type="prismatic"><parent link="rail"/><child link="slide"/><axis xyz="1 0 0"/>
<limit lower="-9" upper="9" effort="1e4" velocity="9"/></joint></robot>"""


def _run() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time [s], position [m] and drive [N] of a carriage that is driven to and fro."""
    count = round(LENGTH / STEP)
    time = STEP * np.arange(count)
    drive = 55.0 * np.sin(2.0 * np.pi * 0.3 * time) + 30.0 * np.sin(2.0 * np.pi * 0.83 * time + 1.0)
    x, v, places = 0.0, 0.0, np.empty(count)
    for k in range(count):
        places[k] = x
        pull = drive[k] + OFFSET - VISCOUS * v
        after = v + STEP / MASS * (pull - DRY * np.sign(v if v else pull))
        v = 0.0 if (v == 0.0 and abs(pull) < DRY) or v * after < 0.0 else after
        x += STEP * v
    every = round(1.0 / RATE / STEP)
    noise = NOISE * np.random.default_rng(5).standard_normal(len(places[::every]))
    return time[::every], places[::every] + noise, drive[::every]


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    path = Path(tmp_path_factory.mktemp("rail")) / "rail.urdf"
    path.write_text(MODEL)
    system = load(path, physical=False)
    time, place, drive = _run()
    recorded = recording("run1", time, {"carriage.position": place, "carriage.effort": drive}, linear=True)
    problem = pose(system, [recorded])
    likelihood = Likelihood(problem, crude_colours(problem))
    windows = tuple(part for w in (Window(0, 0, len(problem.train[0].time)),) for part in equal_parts(w, 4))
    return Study(problem, Predictor(problem), likelihood, tuple(candidates(system, [recorded])), windows, swing=3.0)


def test_the_mass_alone_is_far_off_even_bent_beyond_its_tolerance(study: Study) -> None:
    nothing = study.fit(Hypothesis(), [np.zeros(len(study.predictor.nominal))], None)
    assert nothing.cost > 1000.0**2 * study.samples
    assert study.stretched(nothing)


def test_friction_and_offset_are_found_from_there(study: Study) -> None:
    found = ordinary_by_way_of_shorter(study, very_short(study))
    assert found is not None
    sizes = {
        member.effect.name: study.predictor.effect_values(found.hypothesis, k, found.x)[0]
        for k, member in enumerate(found.hypothesis.members)
    }
    assert sizes["viscous_damping"] == pytest.approx(VISCOUS, rel=0.03)
    assert sizes["coulomb_friction"] == pytest.approx(DRY, rel=0.03)
    assert sizes["constant_torque"] == pytest.approx(OFFSET, rel=0.1)
    # Nothing but noise is left, and so it is on the whole recording from there.
    assert found.cost < 1.5 * study.samples
    whole = Study(
        study.problem,
        study.predictor,
        study.likelihood,
        study.candidates,
        (Window(0, 0, study.windows[-1].last),),
        swing=3.0,
    )
    longer = everywhere(whole, found)
    assert longer is not None and longer.cost < 1.5 * whole.samples
