"""Sensors are read with the lengths and mode shapes that a hypothesis gives the mechanism, not with the nominal ones."""

from dataclasses import replace

import numpy as np
import pytest

import harness
from harness.denoc.lanes.model import LaneModel
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.diagnose.problem.problem import ChannelInfo, Problem, Run
from harness.diagnose.problem.windows import Window
from harness.effects.catalogue import effect
from harness.effects.scale import references
from harness.recording.sensors import observe
from harness.system.flexible_link import flexible_link

TIME = np.arange(0.0, 0.4, 0.002)


def predictor(system, *channels):
    infos = tuple(ChannelInfo(f"{site}.{quantity}", site, quantity, "SI") for site, quantity in channels)
    run = Run("run", TIME, np.zeros((len(infos), len(TIME))), None, 0.002)
    return Predictor(Problem(system, infos, (run,), (run,)))


def by_itself(system, state, site, quantity):
    """The channel of a model that knows nothing but this system, shape (T,)."""
    model = LaneModel(system)
    q, qd = np.split(np.atleast_2d(state), 2, axis=1)
    rows = model.row()[None]
    return observe(model, rows, site, quantity, model.simulate(rows, q, qd, TIME))[0]


@pytest.mark.parametrize("quantity", ["tip_deflection", "root_strain", "tip_acceleration"])
def test_load_at_the_tip_changes_what_the_mode_shapes_show(quantity):
    system = replace(harness.load("models/toml/flexible_pendulum.toml"), tolerance=0.02)
    (link,) = system.links
    asked = predictor(system, (link.name, quantity))
    load = Candidate(effect("payload_mass"), link.name, references(system, link.name))
    hypothesis = Hypothesis((load,))
    x = np.zeros((2, asked.size(hypothesis)))
    x[1, len(asked.nominal) :] = to_internal(load, np.array([0.05]))
    window = Window(0, 0, len(TIME))
    state = np.zeros(asked.state_size(hypothesis))
    state[0] = 0.8
    light, laden = asked.predict(hypothesis, x, [(0, window, state), (1, window, state)])
    loaded = system.replace_link(flexible_link(link.name, replace(link.beam, payload=link.beam.payload + 0.05)))
    for channels, alone in ((light, system), (laden, loaded)):
        truth = by_itself(alone, state, link.name, quantity)
        assert np.abs(channels[0] - truth).max() < 1e-7 * np.abs(truth).max()


def test_an_accelerometer_at_the_end_sits_where_the_length_says():
    system = replace(harness.load("models/urdf/rigid_pendulum.urdf"), tolerance=0.05)
    link = system.links[0]
    asked = predictor(system, (link.name, "tip_acceleration"))
    hypothesis = Hypothesis()
    x = np.zeros((1, asked.size(hypothesis)))
    x[0, [n.kind for n in asked.nominal].index("length")] = 1.0
    state = np.array([0.8, 0.0])
    (channels,) = asked.predict(hypothesis, x, [(0, Window(0, 0, len(TIME)), state)])
    longer = asked.altered(hypothesis, x[0])
    assert longer.links[0].com[2] / link.com[2] == pytest.approx(np.exp(0.05))
    truth = by_itself(longer, state, link.name, "tip_acceleration")
    assert np.abs(channels[0] - truth).max() < 1e-7 * np.abs(truth).max()
