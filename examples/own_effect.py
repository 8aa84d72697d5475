"""An effect of one's own: a small magnet that draws the joint to one angle.

Use it with ``denoc diagnose run1.csv run2.csv --model pendulum.urdf --effects examples/own_effect.py``.
"""

import math

name = "magnet"
title = "magnet at one angle"
signature = "The joint is drawn to one angle from within a few degrees, and left alone elsewhere."
confusable_with = ("cogging_torque", "joint_stiffness")
parameters = {
    "energy": {"unit": "N*m", "what": "depth of the well", "lower": 0.0, "scale": 0.002},
    "angle": {"unit": "rad", "what": "where the magnet sits", "scale": 0.3, "starts": (0.0, 0.3, -0.3)},
    "width": {"unit": "rad", "what": "reach of the magnet", "lower": 0.005, "scale": 0.05, "starts": (0.05, 0.15)},
}


def torque(position, velocity, time, p):
    """Minus the slope of the potential −energy · exp(−(position − angle)²/(2 width²))."""
    away = (position - p[1]) / p[2]
    return -p[0] * away / p[2] * math.exp(-0.5 * away * away)
