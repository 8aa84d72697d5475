"""A beam on a fixed joint, without any joint that moves, is diagnosed as others are.

The truth is closed: free vibration of a clamped-free Euler-Bernoulli beam in its first mode, beta l = 1.87510407
(Blevins, Formulas for Natural Frequency and Mode Shape (1979), table 8-1), w(t) = a exp(-zeta omega t) cos(omega_d t + phi), across
gravity, so that it does not sag.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness import diagnose, load
from harness.effects.scale import swings
from harness.recording import Channel, Recording
from harness.system import System
from harness.system.description import constant

LENGTH, WIDTH, THICKNESS, YOUNG, DENSITY = 0.40, 0.025, 0.001, 2.0e11, 7850.0
DAMPING, NOISE = 0.004, 2e-5
OMEGA = 1.87510407**2 * np.sqrt(YOUNG * THICKNESS**2 / 12.0 / DENSITY) / LENGTH**2

MODEL = f"""
name = "cantilever"
[[joint]]
name = "clamp"
type = "fixed"
parent = "base"
child = "strip"
[[link]]
name = "strip"
length = {LENGTH}
direction = [1, 0, 0]
bending = [0, 1, 0]
section = {{ width = {WIDTH}, thickness = {THICKNESS} }}
material = {{ youngs_modulus = {YOUNG}, density = {DENSITY} }}
modes = 1
"""


@pytest.fixture
def strip(tmp_path: Path) -> System:
    path = tmp_path / "strip.toml"
    path.write_text(MODEL)
    return load(path)


def _recording(name: str, size: float, seed: int) -> Recording:
    time = np.arange(0.0, 4.0, 0.004)
    ringing = np.sqrt(1.0 - DAMPING**2) * OMEGA * time + 0.4
    tip = size * np.exp(-DAMPING * OMEGA * time) * np.cos(ringing)
    values = constant(tip + NOISE * np.random.default_rng(seed).standard_normal(len(time)))
    channel = Channel("strip.tip_deflection", "strip", "tip_deflection", "m", values)
    return Recording(name, name, constant(time), (channel,), ())


def test_its_natural_frequency_is_that_of_the_first_mode(strip: System) -> None:
    # Rayleigh's quotient with the static shape is 1.5 % high (33/140 for 0.2427 of the mass).
    assert swings(strip) == (pytest.approx(OMEGA, rel=0.02),)


def test_damping_that_the_model_lacks_is_named(strip: System) -> None:
    found = diagnose([_recording("one", 0.006, 1), _recording("two", 0.004, 2)], model=strip)
    assert found.verdict == "explained"
    (finding,) = found.findings
    assert (finding["effect"], finding["site"]) == ("modal_damping", "strip")
    low, high = finding["parameters"]["damping_ratio"]["ci95"]
    assert low <= DAMPING <= high
    assert high - low < 0.1 * DAMPING
