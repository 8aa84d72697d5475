"""The numbers that decide what recorded efforts say: above each one its unit; its reason; how it was found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

from __future__ import annotations

import numpy as np

# --- motion behind the efforts ---

# grid points in a period at the cutoff; on which motion is smoothed; chosen
OVERSAMPLING = 60.0
# times the cutoff; that the motion itself is smoothed at; chosen
MOTION_CUTOFF_RATIO = 3.0
# order; of the Butterworth low-pass, passed forwards and backwards; chosen
LOWPASS_ORDER = 4
# variance of the accelerations' noise over that of the accelerations; twice the bias of an inertia; chosen
ATTENUATION = 1e-3
# times the slowest swing's frequency; below which a cutoff would cut the swing itself; chosen
FEWEST_HARMONICS = 1.5
# of the recording's Nyquist frequency; highest cutoff of the motion itself; chosen
WIDEST_NYQUIST_SHARE = 0.7
# of the recording's Nyquist frequency; highest cutoff of the efforts; chosen
NYQUIST_SHARE = 0.35
# standard deviations of the velocity's noise; below which a joint may be at rest; chosen
STILL_SIGMAS = 5.0
# of the greatest speed; below which a joint may be at rest, at least; chosen
STILL_SHARE = 0.004
# periods at the cutoff; at either end of a recording that the low-pass has too little past or future for; chosen
EDGE_PERIODS = 2.0
# periods at the cutoff; that a joint must be still for its friction to be undetermined; chosen
RESTING_PERIODS = 1.0
# of the samples at which a joint moves; that must be left to compare, or the band is wider; chosen
LEAST_MOVING_SHARE = 0.5
# times the cutoff; by which it is raised at a time; chosen
WIDER_BAND_RATIO = 1.5

# --- pushes that nobody recorded ---

# robust standard deviations; at which a push is noticed; chosen
PUSH_SIGMAS = 6.0
# robust standard deviations; to which a push reaches on either side; chosen
PUSH_END_SIGMAS = 2.5
# of the efforts' 95th percentile; below which a push is not claimed; chosen
PUSH_SHARE = 0.15
# times dry friction in motion; that may hold a joint at rest before it breaks loose; citation: static over kinetic friction of dry
# and lubricated metals is seldom above 2 (Rabinowicz, Friction and Wear of Materials, 2nd ed. 1995, ch. 4)
BREAKAWAY_RATIO = 2.0
# of the shortest period that is looked at; shortest push: shorter ones are outliers of the smoothing; chosen
SHORTEST_PUSH_PERIODS = 0.5
# of the largest effort that was asked for; that a drive may give at most, as far as pushes are asked whether they are that; chosen
DRIVE_LIMITS = (0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3)
# of the time that pushes last; that is left beside a drive's limit, at most, where they are that; chosen
LIMITED_SHARE = 0.25
# of a push; that must be left beside what was found, at least, where it is one; chosen
STILL_PUSHED_SHARE = 0.5

# --- regression of ordinary torques ---

# rounds; of reweighting, at most; chosen
REWEIGHTING_ROUNDS = 20
# of the spread; by which a further round changes nothing; chosen
SETTLED_SPREAD = 1e-3
# robust standard deviations; at which Tukey's weight ends; citation: 95 % efficiency under Gaussian noise (Beaton
# and Tukey 1974)
TUKEY_WIDTH = 4.685
# torques; beside the ordinary ones, at most; chosen
MOST_FURTHER_TORQUES = 8
# times the independent samples; that the regression sees; chosen
SAMPLE_DENSITY = 4
# waves; of cogging in a turn, at most; chosen
MOST_COGGING_WAVES = 12
# times the speed at which a joint may rest; over which friction falls after it breaks loose; chosen
FALLING_SPEEDS = (2.0, 5.0, 12.0)
# factors; of a product of nominal quantities, at most; closed form: a mass, two lengths, an inertia
MOST_FACTORS = 4
# of the torque; that the sum of products may err by where it stands in for inverse dynamics; chosen
SAME_TORQUE = 1e-9

# cubic splines; that a force over a joint's position that nobody has named may be made of, as few as it takes; chosen: four are
# one cubic
POSITION_SHAPES = (4, 5, 6, 8)

# --- noise ---

# periods of the cutoff; between samples that are compared; chosen
SAMPLE_PERIODS = 0.55
# lags; of the autoregression, at most; chosen
NOISE_LAGS = 3

# --- fits ---

# stretches a parameter; from which on the scatter between stretches is trusted; chosen
STRETCHES_A_PARAMETER = 3
# evaluations; of one fit; chosen
MOST_EVALUATIONS = 25
# rounds; of noise and parameters in turn; chosen
NOISE_ROUNDS = 3
# of the sum of squares; by which a further step changes nothing: a hundredth of what evidence counts in, of a thousand samples;
# chosen
SETTLED_COST = 1e-5
# of the size of a joint's noise; by which a further round changes nothing; chosen
SETTLED_SIZE = 0.01
# samples; that the noise expected of a joint counts for, beside those it has; chosen: about the numbers of its memory
SIZE_SAMPLES = 4.0
# of a nominal quantity's σ; by which its slope is read off; chosen between rounding and curvature
NOMINAL_DIFFERENCE = 1e-3
# of a parameter's typical size; by which its slope is read off; chosen between rounding and curvature
PARAMETER_DIFFERENCE = 1e-5
# σ; how far a fit may go before the slopes of nominal quantities are read off again: torques are linear in most of
# them, so that half a per cent of a quantity (half a σ of one per cent) changes slopes by as much at most; chosen
STALE_SIGMAS = 0.5
# times as far; before the last round; chosen
STALE_RATIO_ON_THE_WAY = 8.0
# of the typical size; by which parameters that those slopes depend on may go; chosen
STALE_SHARE = 0.02
# of the efforts' size; by which the slope of the input chain is read off; chosen
INPUT_DIFFERENCE = 0.05
# of what arrives over what is recorded, or of a reading over what it reads; below which a slope is taken as that; chosen
LEAST_SLOPE = 1e-3

# --- the search ---

# of a joint's noise; a set that leaves less says that something was taken for noise; chosen
FAR_BELOW_NOISE = 0.7
# independent samples; without which efforts are not fitted; chosen
FEWEST_SAMPLES = 40
# of the greatest speed; below which a joint is about to reverse; chosen
REVERSING_SHARE = 0.1
# sets; that are carried on; chosen
BEAM_WIDTH = 2
# candidates; that are fitted beside each of them; chosen
MOST_CANDIDATES = 5
# candidates; that are asked whether they could stand in the place of another; chosen
MOST_RIVALS = 10
# effects; of a set at most, of a mechanism of one joint; chosen
MOST_EFFECTS = 5
# effects a driven joint; of a set at most: viscous and dry friction, which every geared joint has, and one more; chosen
EFFECTS_A_JOINT = 3
# starts; of one candidate; chosen
MOST_STARTS = 6
# times what its trace explains; that a fit may bring: traces are of few starts, and of small effects; chosen
TRACE_RATIO = 2.0
# times what its trace explains; that a rival may bring at most; chosen
RIVAL_TRACE_RATIO = 4.0
# of what an effect does; that what stands in its place may lack where only a few stretches say so; chosen
RIVAL_LACK = 0.05
# standard deviations, by the scatter between stretches; by which an effect must improve all recordings; convention: two of a
# normal distribution, which what just pays has where stretches are alike
THROUGHOUT_SIGMAS = 2.0
# standard deviations, by the scatter between stretches; from which on recordings part two sets; chosen: laws err alike at all
# turns, so that stretches are less independent than they look
PARTED_SIGMAS = 5.0
# evaluations; that show how far another effect leads; chosen
GLANCE_EVALUATIONS = 5
# chance; of a stretch of the nominal quantities under their tolerance, below which it is evidence; chosen
STRETCHED_CHANCE = 1e-7
# standard deviations; by which an effect must improve data held out; chosen
HELD_OUT_SIGMAS = 1.0
# standard deviations, by the scatter between stretches too; that an effect must be away from absence; convention:
# three of a normal distribution
FROM_NOTHING_SIGMAS = 3.0
# joints; from which on the motion's own search seldom ends within a minute, and efforts are asked first; chosen
EFFORTS_FIRST_JOINTS = 3
# of the time; that efforts asked first may take; chosen
EFFORTS_FIRST_SHARE = 0.5
# of the time; that the motion may take where it comes first: an answer by efforts of one or two joints takes 10 to 30 s;
# chosen
MOTION_FIRST_SHARE = 0.7
# of what is left of the time; that efforts may take to tell laws which the motion's search begins with, 2 to 10 s as a rule; chosen
SEEDING_SHARE = 0.15

# --- the answer ---

# chance; at which a shape left in the residual counts; chosen
SHAPE_CHANCE = 1e-4
# of the residual's variance; that such a shape must explain besides; chosen
SHAPE_SHARE = 0.05
# times the training residual; that the held-out one may be; chosen
HELD_OUT_RATIO = 1.3
# standard deviations; by which data held out, or a nominal quantity, must be off to count; chosen
SURELY_OFF_SIGMAS = 5.0
# relative size; of what shapes have in common, below which it is rounding; chosen above double rounding (2e-16)
SHAPES_DEPENDENT = 1e-8
# of what is left; that is still there after its memory; closed form: e⁻¹
FORGOTTEN_SHARE = np.exp(-1.0)
# samples; of a stretch that say how long something keeps; chosen
FEWEST_MEMORY_SAMPLES = 8

# --- what efforts do not turn on ---

# of the largest information; below which a direction of the numbers is rounding; chosen above double rounding (2e-16)
ROUNDED_INFORMATION = 1e-12
# of a direction that nothing turns on; that a number may have a part in and is still known; chosen
UNSEEN_PART = 1e-3
