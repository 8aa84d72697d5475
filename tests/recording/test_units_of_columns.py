"""Only a unit of the dimension that a column asks for passes; what everybody writes is read or gets a mend."""

import numpy as np
import pytest

from harness.errors import InputError
from harness.recording.units import factor_to_si

# Exact by definition: 1 lbf = 0.45359237 kg · 9.80665 m/s², 1 in = 0.0254 m, 1 oz = 1/16 lb, 1 rev = 2π rad (BIPM, SI brochure;
# NIST SP 811, appendix B). A NATO mil is 1/6400 of a turn; a mil as a length is a thousandth of an inch.
POUND, INCH, GRAVITY = 0.45359237 * 9.80665, 0.0254, 9.80665

READ = [
    *[("position", u, 2 * np.pi) for u in ("turn", "turns", "rev", "revs", "revolution", "revolutions")],
    *[("position", u, np.pi / 180) for u in ("deg", "degree", "degrees", "Degrees", "DEG", "°", "º")],
    ("position", "mil", 2 * np.pi / 6400),
    ("position", "mrad", 1e-3),
    ("position", "gon", np.pi / 200),
    ("position", "2*pi/65536 rad", 2 * np.pi / 65536),
    *[("velocity", u, 2 * np.pi / 60) for u in ("rpm", "RPM", "rev/min", "r/min", "U/min")],
    *[("velocity", u, 2 * np.pi) for u in ("rev/s", "turn/s", "turns/s")],
    *[("velocity", u, np.pi / 180) for u in ("dps", "deg/s", "°/s", "deg/sec")],
    *[("effort", u, 1.0) for u in ("Nm", "N m", "N-m", "N.m", "N·m", "N*m")],
    *[("effort", u, 1e-3) for u in ("mNm", "mN*m", "mN m", "Nmm")],
    *[("effort", u, 1e-2) for u in ("Ncm", "N cm", "N*cm")],
    ("effort", "kNm", 1e3),
    ("effort", "0.07 Nm", 0.07),
    *[("effort", u, GRAVITY / 100) for u in ("kgf*cm", "kgcm", "kg-cm", "kg.cm", "kgf·cm")],
    *[("effort", u, POUND / 16 * INCH) for u in ("oz-in", "ozf*in", "oz.in")],
    *[("effort", u, POUND * INCH) for u in ("in-lb", "lbf*in", "lb-in")],
    *[("effort", u, POUND * 12 * INCH) for u in ("ft-lb", "lbf*ft", "lb-ft")],
    *[("root_strain", u, 1e-6) for u in ("microstrain", "µε", "με", "ue", "uE", "ppm", "µm/m", "um/m")],
    *[("root_strain", u, 1e-3) for u in ("mm/m", "‰", "millistrain")],
    *[("root_strain", u, 1.0) for u in ("1", "strain", "m/m")],
    ("root_strain", "2000 microstrain", 2e-3),
    ("root_strain", "%", 1e-2),
    ("tip_deflection", "mil", 1e-3 * INCH),
    ("tip_deflection", "0.05 mm", 5e-5),
    *[("tip_acceleration", u, 1.0) for u in ("m/s2", "m/s^2", "m/s²", "m/s/s", "m*s-2", "m/sec2")],
    *[("tip_acceleration", u, GRAVITY) for u in ("g", "G")],
    ("tip_acceleration", "mg", 1e-3 * GRAVITY),
    ("tip_acceleration", "Gal", 1e-2),
    *[("time", u, 1.0) for u in ("s", "sec", "secs", "Seconds")],
    *[("time", u, 1e-6) for u in ("us", "µs", "usec")],
]


@pytest.mark.parametrize(("quantity", "unit", "factor"), READ)
def test_read(quantity, unit, factor):
    size, _ = factor_to_si(unit, quantity, prismatic=False)
    assert size == pytest.approx(factor, rel=1e-12)


COUNTS = r"as 2\*pi/4096 rad"
REFUSED = [
    *[
        ("position", u, COUNTS)
        for u in ("count", "counts", "bit", "percent", "%", "ppm", "1", "2*pi/4096", "ticks", "lsb")
    ],
    *[("position", u, "does not fit") for u in ("m/m*s", "sr", "rad/s", "mm", "dB", "N*m")],
    *[("velocity", u, COUNTS) for u in ("counts/s", "Bq", "1/min", "1/s", "kHz", "Hz", "rps", "cps")],
    *[("effort", u, "torque constant") for u in ("A", "mA", "ampere")],
    *[("effort", u, "does not fit") for u in ("N", "kg", "N*m/rad", "W")],
    *[("root_strain", u, "2000 microstrain") for u in ("mV/V", "V/V", "µV/V", "mV", "V")],
    *[("root_strain", u, "does not fit") for u in ("deg", "rad", "count", "bit", "s/s*rad", "mrad")],
    *[("tip_deflection", u, "one pixel") for u in ("px", "pixel", "css_pixel", "point")],
    *[("time", u, "0.001 s") for u in ("counts", "samples", "frames")],
    *[("position", u, "is not a unit") for u in ("9**9,999,999 rad", "deg**2,4096", "0,5 mm")],
    ("time", "Hz", "does not fit"),
    ("tip_acceleration", "m/s", "does not fit"),
]


@pytest.mark.parametrize(("quantity", "unit", "words"), REFUSED)
def test_refused(quantity, unit, words):
    with pytest.raises(InputError, match=words):
        factor_to_si(unit, quantity, prismatic=False, source="run.csv", column="x")


def test_counts_of_a_slide_need_their_length():
    assert factor_to_si("0.005 mm", "position", prismatic=True) == (5e-6, "m")
    assert factor_to_si("mil", "position", prismatic=True)[0] == pytest.approx(2.54e-5, rel=1e-12)
    with pytest.raises(InputError, match=r"as 0\.005 mm for a count"):
        factor_to_si("counts", "position", prismatic=True)
    with pytest.raises(InputError, match="does not fit"):
        factor_to_si("deg", "position", prismatic=True)
