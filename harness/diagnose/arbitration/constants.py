"""The numbers that decide how models are held against recordings: above each one its unit; its reason; how it was found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

from __future__ import annotations

import numpy as np

# --- what models agree on ---

# of its size; beyond which half a 95 % interval that holds every model leaves a number open; chosen
OPEN_SHARE = 0.5
# weight; from which on a number is named in a combination; chosen
NAMED_WEIGHT = 0.2
# numbers; that are named in a combination; chosen
MOST_NAMED = 5
# of its size; by which a number may be off and still be the same for every purpose; chosen
ALIKE_SHARE = 0.01
# of a joint's natural inertia; that a change of a number is at least measured by; chosen
LEAST_INERTIA_SHARE = 0.05
# of a joint's natural torque or inertia; the same of what is less as a rule; chosen
LEAST_LAW_SHARE = 0.005

# --- base parameters ---

# positions; at which columns are compared; chosen
BASE_PARAMETER_POSITIONS = 40
# of its length; what of a column the ones before leave where it depends on them; chosen above double rounding
# (2e-16)
DEPENDENT_COLUMN = 1e-9
# factor; of grouped parameters below which it is rounding; chosen above double rounding (2e-16)
NEGLIGIBLE_FACTOR = 1e-6

# --- fits of the freed numbers ---

# steps; of a fit of the freed numbers; chosen
FIT_STEPS = 40
# of its size; at which a number begins that a model does not have; chosen
BEGINNING_SHARE = 0.25
# in sizes; standard deviation of a combination that changes nothing; chosen
UNSEEN_SPREAD = 1e8
# steps; of a fit of initial states; chosen
STATE_FIT_STEPS = 20
# times the noise's variance; beyond which other beginnings are tried; chosen
FAR_FROM_NOISE_RATIO = 4.0

# --- where models fail ---

# times the noise; from which on what fitted equations leave is worth a sentence; chosen
TELLING_NOISE_RATIO = 2.0
# groups; of windows by speed, extent or effort, equally many in each; chosen
WINDOW_GROUPS = 4
# windows; that a test of a difference needs; chosen
FEWEST_WINDOWS = 4
# chance; below which a difference is told; convention: 5 %
CLEAR_CHANCE = 0.05
# of logarithms of mean squares; by which a difference matters; closed form: of an error a twentieth larger, 2 ln
# 1.05
MATTERING_DIFFERENCE = 2.0 * np.log(1.05)
