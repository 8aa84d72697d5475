"""The numbers that decide what a recording is taken for before it is fitted: above each one its unit; its reason; how found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

from __future__ import annotations

import numpy as np

# --- units and zeros of angles ---

# rad; that a degree is; closed form: π / 180
DEGREE = np.pi / 180.0
# rad; that a quarter turn is; closed form: π / 2
QUARTER_TURN = 0.5 * np.pi
# cosine between accelerations and the model's; up to which the convention is doubted; chosen
DOUBTED_COSINE = 0.5
# cosine between accelerations and the model's; from which another convention is taken for the right one; chosen
FOLLOWED_COSINE = 0.95
# times; how large the model's accelerations may be beside those of the recording; chosen
ALIKE_ACCELERATIONS = (0.4, 2.5)
# swings of the model; that a recording has to have; chosen
FEWEST_SWINGS = 1.5
# joints; that turn, whose zeros are tried together, which bounds the work; chosen
MOST_TURNED_JOINTS = 3
# of its length; by which a quaternion may differ from 1 before that is told; chosen
UNIT_QUATERNION_ERROR = 0.02
# of its length; below which a quaternion is no attitude; chosen
NO_QUATERNION_LENGTH = 1e-6

# --- a start that is held ---

# of a channel's extent; at which it has begun to move, if that is not within its noise; chosen
BEGUN_EXTENT = 0.02
# standard deviations of the noise; that make a movement; chosen
MOVEMENT_SIGMAS = 8.0
# of the extent; up to which the beginning of a fall is fitted; chosen
FALL_EXTENT = 0.15
# samples; of standing still, and of falling; chosen
FEWEST_HELD_SAMPLES = 8
# times the noise; that what stands still may scatter; chosen
STILL_SCATTER = 1.5
# twice the logarithm of the likelihood; for a hold against a smooth motion from the first sample on; chosen
HOLD_EVIDENCE = 30.0
# standard deviations; between two releases that are not one delay; chosen
RELEASES_APART_SIGMAS = 10.0
# of the time that the fall is fitted over; the same, for what the fall's shape may be wrong by; chosen
RELEASES_APART_FALL = 0.1
# samples; that have to remain once what is held is left out; chosen
FEWEST_REMAINING_SAMPLES = 100

# --- motion that a hand carries or a stop ends ---

# samples; of the slowest swing, at which accelerations are read off; chosen
SAMPLES_A_SWING = 96
# such samples; in the local cubic, about a tenth of a swing; chosen
SMOOTHING_SAMPLES = 9
# such samples; in a window whose mean force is judged; chosen
FORCE_WINDOW_SAMPLES = 5
# such windows; that are carried at least, since a single one may be an outlier; chosen
FEWEST_CARRIED_WINDOWS = 2
# standard deviations; of the first windows' mean force beyond what the rest of the recording shows; chosen: was 6
CARRIED_SIGMAS = 5.0
# standard deviations; the same of a later window, in which a hand goes on; chosen
CARRIED_ON_SIGMAS = 2.5
# swings; after a carried stretch in which a knock still counts as part of it; chosen
KNOCK_SWINGS = 1.5
# of the accelerations that gravity makes; below which a carrying hand is not claimed; chosen
CARRIED_SHARE = 0.12
# of the accelerations that gravity makes; below which a blow that ends the motion is not claimed; chosen
BLOW_SHARE = 0.06
# of the extent of all recordings; that a joint must have gone beyond a place for no stop to be there; chosen
BEYOND_STOP_EXTENT = 0.05
# times its friction in motion; that a joint may be held by; chosen
STATIC_FRICTION_RATIO = 2.0
# of a recording, or of all; that may be left out: beyond, it is the model that is wrong; chosen
MOST_LEFT_OUT_SHARE = 0.4
# of the greatest speed, and of the swing's extent; below which a joint stands still: what stands still is held, and
# has an effect of its own (late release); chosen
MOVING_SHARE = 0.03
# times the median deviation; standard deviation of what is normally distributed but for outliers; closed form: 1 /
# Φ⁻¹(0.75), to five digits
ROBUST_SIGMA = 1.4826
# of the greatest speed; from which on motion is fast enough for its mean force to be judged; chosen
FAST_SHARE = 0.1
