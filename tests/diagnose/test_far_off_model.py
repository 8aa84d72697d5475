"""A spring that the model does not have leaves it falling where the recording swings; free runs say nothing then.

Truth: the closed form of a damped oscillator (any textbook, e.g. Meirovitch, Fundamentals of Vibrations, §2.5).
"""

from __future__ import annotations

import numpy as np

from harness.diagnose.diagnose import diagnose
from harness.recording import Channel, Recording
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

MASS, STIFFNESS, REST, DAMPING = 1.2, 150.0, 0.0785, 0.9  # kg, N/m, m, N·s/m
GRAVITY, NOISE = 9.81, 3e-4


def lift() -> System:
    """A mass that slides up and down, held by nothing."""
    joint = Joint("lift", JointType.PRISMATIC, "base", "mass", axis=constant([0.0, 0.0, 1.0]))
    link = Link("mass", MASS, constant([0.0, 0.0, 0.0]), constant(np.diag([2e-3, 2e-3, 2e-3])))
    return System("lift", (joint,), (link,), tolerance=0.01)


def oscillation(start: float, seed: int) -> Recording:
    """The mass let go at a height [m], as read."""
    time = np.arange(0.0, 6.0, 1.0 / 200.0)
    middle = REST - MASS * GRAVITY / STIFFNESS
    decay = DAMPING / (2.0 * MASS)
    omega = np.sqrt(STIFFNESS / MASS - decay**2)
    swing = np.exp(-decay * time) * (np.cos(omega * time) + decay / omega * np.sin(omega * time))
    noise = NOISE * np.random.default_rng(seed).standard_normal(len(time))
    read = constant(middle + (start - middle) * swing + noise)
    name = f"from {start} m"
    return Recording(name, name, constant(time), (Channel("lift.position", "lift", "position", "m", read),))


def test_a_spring_that_the_model_lacks_is_found_with_its_damping() -> None:
    told = diagnose([oscillation(z, seed) for seed, z in enumerate((0.08, 0.12, -0.07))], model=lift())
    assert told.verdict == "explained"
    found = {f["effect"]: f["parameters"] for f in told.findings}
    assert set(found) == {"joint_stiffness", "viscous_damping"}
    for effect, name, value in (
        ("joint_stiffness", "stiffness", STIFFNESS),
        ("joint_stiffness", "rest_angle", REST),
        ("viscous_damping", "coefficient", DAMPING),
    ):
        told_as = found[effect][name]
        assert abs(told_as["value"] - value) < 4.0 * told_as["std"]
