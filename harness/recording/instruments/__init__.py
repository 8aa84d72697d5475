"""Instruments as they really behave: what a potentiometer, a charge amplifier or a strain-gauge bridge makes of a signal.

The effects of `harness.effects` are single faults with parameters to be fitted. An instrument is a chain of several, with the
numbers of its data sheet, to make recordings as an experiment would have them.
"""

from harness.recording.instruments.charge_amplifier import ChargeAmplifier, TipAccelerometer
from harness.recording.instruments.potentiometer import WireWound
from harness.recording.instruments.strain_gauge import StrainBridge

__all__ = ["ChargeAmplifier", "StrainBridge", "TipAccelerometer", "WireWound"]
