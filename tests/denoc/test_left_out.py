"""Deflection under slow loads, whatever the number of modes, held against closed forms of the clamped beam.

Formulas: any table of beams, e.g. Young and Budynas, Roark's Formulas for Stress and Strain, 7th ed., table 8.1: end deflection
m g l³/3EI under a weight at the end, q l⁴/8EI under an even load q, 11 q l⁴/120EI under one that rises from 0 to q.
"""

from dataclasses import replace

import numpy as np
import pytest

import harness
from harness.denoc.beam.integrals import beam_data
from harness.denoc.beam.static_correction import left_out
from harness.denoc.lanes.model import LaneModel
from harness.engines.denoc_native import Native
from harness.recording.sensors import observe
from harness.system.flexible_link import flexible_link

PAYLOAD = 0.02


@pytest.fixture(params=[(1, "auto"), (3, "auto"), (2, "clamped_free"), (4, "tip_mass")])
def strip(request):
    modes, shapes = request.param
    system = harness.load("models/toml/flexible_pendulum.toml")
    (link,) = system.links
    beam = replace(link.beam, modes=modes, shapes=shapes, payload=PAYLOAD, material_damping=0.0)
    return system.replace_link(flexible_link(link.name, beam))


def at_rest(data, root, turning):
    """Modes' coordinates under the steady acceleration root + turning · x, shape (m,)."""
    load = -data.rho * data.weights * (root + turning * data.x)
    force = -data.payload * (root + turning * data.length)
    return np.linalg.solve(data.K, data.s.T @ load + data.tip.s * force)


@pytest.mark.parametrize(("root", "turning"), [(9.81, 0.0), (0.0, 40.0), (-3.0, 25.0)])
def test_modes_and_what_they_leave_out_make_the_whole(strip, root, turning):
    data = beam_data(strip, strip.links[0].name)
    rest = left_out(strip, data)
    l, rho, rigidity = data.length, data.rho, strip.links[0].beam.bending_stiffness
    still = np.zeros(data.coordinates)
    b = at_rest(data, root, turning)
    force = PAYLOAD * (root + turning * l)
    tip = -(rho * root * l**4 / 8 + 11 * rho * turning * l**5 / 120 + force * l**3 / 3) / rigidity
    curvature = -(rho * root * l**2 / 2 + rho * turning * l**3 / 3 + force * l) / rigidity
    assert data.tip.s @ b + rest.read(rest.tip, root, turning, still) == pytest.approx(tip, rel=1e-10)
    root_curvature = data.at(0.0).curvature @ b + rest.read(rest.curvature, root, turning, still)
    assert root_curvature == pytest.approx(curvature, rel=1e-9)


def test_modes_leave_nothing_out_that_another_link_hangs_on():
    system = harness.load("models/toml/two_link_flexible.toml")
    carrier = next(j.parent for j in system.joints if j.parent != system.base)
    rest = left_out(system, beam_data(system, carrier))
    assert rest.nothing


@pytest.mark.parametrize("quantity", ["tip_deflection", "root_strain"])
def test_sensors_on_lanes_and_the_textbook_model_read_the_same(strip, quantity):
    name = strip.links[0].name
    time = np.linspace(0.0, 0.3, 301)
    model = Native().build(strip)
    q0 = np.zeros(len(strip.coordinate_names))
    q0[0] = 1.0
    run = model.simulate(q0, 0 * q0, time)
    lanes = LaneModel(strip)
    rows = lanes.row()[None]
    seen = observe(lanes, rows, name, quantity, lanes.simulate(rows, q0[None], 0 * q0[None], time))[0]
    channel = run.channels[f"{name}.{quantity}"]
    assert np.abs(seen - channel).max() < 1e-6 * np.abs(channel).max()


@pytest.mark.parametrize(
    ("quantity", "modes", "kept", "whole"),
    [
        ("tip_deflection", 1, 0.985, 0.998),
        ("tip_deflection", 3, 0.9976, 0.99995),
        ("root_strain", 3, 0.83, 0.999),
    ],
)
def test_the_gains_that_the_theory_page_tells(quantity, modes, kept, whole):
    # The figures are those of docs/theory.md; the reference is the same model with twelve modes.
    time = np.arange(0.0, 1.0, 0.002)

    def read(count, linear):
        system = harness.load("models/toml/flexible_pendulum.toml")
        (link,) = system.links
        system = system.replace_link(flexible_link(link.name, replace(link.beam, modes=count)))
        lanes = LaneModel(system)
        rows, q0 = lanes.row()[None], np.zeros((1, lanes.n))
        q0[0, 0] = 1.0
        moved = lanes.simulate(rows, q0, 0 * q0, time)
        return observe(lanes, rows, link.name, quantity, moved, linear=linear)[0]

    truth = read(12, False)
    for linear, figure in ((True, kept), (False, whole)):
        seen = read(modes, linear)
        assert truth @ seen / (seen @ seen) == pytest.approx(figure, abs=0.6 * 10.0 ** -len(str(figure)[2:]))
