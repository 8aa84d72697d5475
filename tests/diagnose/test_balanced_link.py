"""A link whose centre of mass lies on its joint is no rod with a mass at its end: it cannot be made to bend."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from simulated_recordings import nominal, recording

from harness.diagnose.problem.candidates import candidates
from harness.effects.bending import bend
from harness.errors import InputError


def balanced():
    """The pendulum's link balanced on its joint, though something is carried at its end."""
    system = nominal()
    link = system.links[-1]
    return system.replace_link(replace(link, com=np.zeros(3), end=np.array([0.0, 0.0, -0.3])))


def with_hand():
    """The same with a hand fixed 0.3 m out, which is where the link ends."""
    system = balanced()
    joint, link = system.joints[-1], system.links[-1]
    hand = replace(link, name="hand", com=np.array([0.0, 0.0, -0.05]), end=None)
    wrist = replace(joint, name="wrist", parent=link.name, child="hand", xyz=np.array([0.0, 0.0, -0.3]))
    return replace(system, links=(*system.links, hand), joints=(*system.joints, wrist))


@pytest.mark.parametrize("system", [balanced(), with_hand()])
def test_it_is_refused_in_words(system):
    site = nominal().links[-1].name
    with pytest.raises(InputError, match="no length or mass to bend with"):
        bend(system, site, {"frequency": 20.0, "damping_ratio": 0.01})


def test_it_is_no_candidate():
    time = np.arange(0.0, 4.0, 0.01)
    system = with_hand()
    run = recording("run", time, {f"{n}.position": 0.3 * np.sin(2.0 * time) for n in system.joint_names})
    sites = {c.site for c in candidates(system, [run]) if c.effect.name == "link_flexibility"}
    assert nominal().links[-1].name not in sites
