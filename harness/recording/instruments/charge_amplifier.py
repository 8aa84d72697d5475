"""An accelerometer at the tip of a link and its charge amplifier, which makes a displacement of the acceleration.

What a tip accelerometer feels is specific force, acceleration less gravity. Of a pendulum that swings freely, gravity makes
nearly the same signal as the acceleration with the opposite sign: across a rigid link only l q̈ + g sin q is left, which is
−(ω² l − g) sin q, nothing at all where the accelerometer sits at the centre of percussion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import bilinear_zpk, sosfilt, zpk2sos

from harness.system.description import Array


@dataclass(frozen=True)
class ChargeAmplifier:
    """A charge amplifier, in displacement mode if ``integrations`` is 2.

    lower, upper: cut-offs [Hz] of first order (−3 dB). integrations: each is exact well above ``lower`` and forgets below it, as
    the amplifier's are.
    Source: E. O. Doebelin, Measurement Systems (2004), ch. 4; Brüel & Kjær, Type 2635 charge amplifier: lower and upper limiting
    frequency, displacement mode.
    """

    lower: float = 2.0
    upper: float = 30.0
    integrations: int = 2

    def read(self, acceleration: Array, rate: float) -> Array:
        """Displacement [m] of an acceleration [m/s²] sampled at ``rate`` [Hz] and at rest until the first sample, (T,) to (T,).

        s / (s + a) · (1 / (s + a))ⁿ · b / (s + b), with a and b the cut-offs in rad/s; what was there before is forgotten.
        """
        low, high = 2.0 * np.pi * self.lower, 2.0 * np.pi * self.upper
        poles = np.append(np.full(1 + self.integrations, -low), -high)
        zeros, poles, gain = bilinear_zpk(np.zeros(1), poles, high, rate)
        moving = acceleration - acceleration[0]
        return np.asarray(sosfilt(zpk2sos(zeros, poles, gain), moving))

    def gain(self, frequency: float) -> complex:
        """Reading over true displacement of a steady wave [1], complex; 1 for an ideal double integration."""
        s = 2j * np.pi * frequency
        low, high = 2.0 * np.pi * self.lower, 2.0 * np.pi * self.upper
        return complex(s / (s + low) * (s / (s + low)) ** self.integrations * high / (s + high))


@dataclass(frozen=True)
class TipAccelerometer:
    """A piezoelectric accelerometer at the tip of a rigid link, read as an angle: arc over length.

    length [m]: from the joint. limit [m/s²]: of its range. cross_axis: share of what acts along the link that it feels across it.
    """

    length: float
    amplifier: ChargeAmplifier = ChargeAmplifier()
    limit: float = 20.0 * 9.81
    cross_axis: float = 0.04

    def felt(self, angle: Array, rate: Array, acceleration: Array, gravity: float = 9.81) -> tuple[Array, Array]:
        """Specific force across and along a link that hangs at zero [m/s²], each (T,): what gravity and turning make of it."""
        across = self.length * acceleration + gravity * np.sin(angle)
        along = self.length * rate**2 + gravity * np.cos(angle)
        return np.asarray(across), np.asarray(along)

    def read(self, angle: Array, rate: Array, acceleration: Array, sampling: float, gravity: float = 9.81) -> Array:
        """The angle that arc over length gives [rad], (T,); angle, rate and acceleration of the joint, sampling [Hz]."""
        across, along = self.felt(angle, rate, acceleration, gravity)
        signal = np.clip(across + self.cross_axis * along, -self.limit, self.limit)
        return np.asarray(self.amplifier.read(signal, sampling) / self.length)
