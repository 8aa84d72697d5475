"""Instruments against what theory says of them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from harness.cases.pendulums import GRAVITY, LENGTH, paper_inertia, paper_restoring
from harness.recording.instruments import ChargeAmplifier, StrainBridge, TipAccelerometer, WireWound


def test_a_potentiometer_reads_in_steps_of_its_windings():
    pot = WireWound(windings=500, linearity=0.0, noise=0.0)
    angle = np.linspace(-1.0, 1.0, 4001)
    read = pot.read(angle)
    assert np.abs(read - angle).max() <= 0.5 * pot.step + 1e-12
    assert np.unique(np.diff(read).round(12)).size == 2  # nothing, or a whole step


def test_a_dragging_wiper_is_late_by_its_play():
    angle = np.sin(np.linspace(0.0, 4.0 * np.pi, 4001))
    read = WireWound(windings=10**7, linearity=0.0, noise=0.0, play=0.02).read(angle)
    later = slice(1500, None)
    moving = np.abs(np.gradient(angle)[later]) > 2e-3
    late = (angle - read)[later][moving] * np.sign(np.gradient(angle)[later][moving])
    assert late == pytest.approx(0.01, abs=1e-5)


def test_linearity_is_its_largest_deviation():
    pot = WireWound(windings=10**7, linearity=0.0025, noise=0.0)
    angle = np.linspace(-0.5 * pot.travel, 0.5 * pot.travel, 2001)
    assert np.abs(pot.read(angle) - angle).max() == pytest.approx(0.0025 * pot.travel, rel=1e-3)


@pytest.mark.parametrize("frequency", [1.07, 2.0, 8.0])
def test_the_amplifier_filters_as_its_transfer_function(frequency):
    amplifier, rate = ChargeAmplifier(), 4000.0
    time = np.arange(int(12.0 * rate)) / rate
    circular = 2.0 * math.pi * frequency
    displacement = 1e-3 * np.cos(circular * time)
    read = amplifier.read(-(circular**2) * displacement, rate)
    settled = time > 6.0
    wave = np.exp(-1j * circular * time[settled])
    found = np.sum(read[settled] * wave) / np.sum(displacement[settled] * wave)
    # s / (s + a) cubed and the low-pass, by hand
    low, high = 1.0 / (1.0 - 2.0j / frequency), 1.0 / (1.0 + 1j * frequency / 30.0)
    assert abs(found - low**3 * high) < 5e-3
    assert amplifier.gain(frequency) == pytest.approx(low**3 * high, rel=1e-12)


def test_far_above_its_cut_off_the_displacement_is_right():
    assert abs(ChargeAmplifier(lower=0.01, upper=1e5).gain(10.0)) == pytest.approx(1.0, abs=1e-4)


def test_gravity_takes_most_of_what_a_swinging_accelerometer_feels():
    square = paper_restoring() / paper_inertia()
    angle = np.linspace(-1.5, 1.5, 31)
    sensor = TipAccelerometer(LENGTH)
    across, _ = sensor.felt(angle, np.zeros(31), -square * np.sin(angle), GRAVITY)
    # −(ω² l − g) sin q; of l q̈ = −ω² l sin q that is 1 − g / ω² l
    assert across == pytest.approx(-(square * LENGTH - GRAVITY) * np.sin(angle), abs=1e-12)
    assert (square * LENGTH - GRAVITY) / (square * LENGTH) == pytest.approx(0.27, abs=0.005)
    percussion = GRAVITY / square
    at_percussion, _ = TipAccelerometer(percussion).felt(angle, np.zeros(31), -square * np.sin(angle), GRAVITY)
    assert np.abs(at_percussion).max() < 1e-12


def test_the_calibration_line_is_that_of_a_loaded_cantilever():
    bridge = StrainBridge(length=0.3, half_depth=0.0005, noise=0.0, warming=0.01)
    load, rigidity = 0.1, 2.0e11 * 0.025 * 0.001**3 / 12.0
    strain = np.full(11, load * 0.3 * 0.0005 / rigidity)
    time = np.linspace(0.0, 10.0, 11)
    read = bridge.read(strain, time)
    assert read[0] == pytest.approx(load * 0.3**3 / (3.0 * rigidity), rel=1e-12)
    assert read[-1] - read[0] == pytest.approx(bridge.line * 1e-6 * 0.01 * 10.0, rel=1e-9)
