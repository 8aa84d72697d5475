"""The numbers that decide where fits begin and what score tests promise: above each one its unit; its reason; how found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

from __future__ import annotations

from harness.diagnose.prediction.constants import REACH

# --- the first look, noise and short windows ---

# times the noise's cost; beyond which free runs of the nominal model say little about what is missing; chosen
NONLINEAR_COST_RATIO = 3.0
# times the slowest swing's frequency; below which motion, and so a misfit, has its power; chosen
MOTION_HARMONICS = 8.0
# relative difference; of noise estimates that changes nothing; chosen
SAME_NOISE_DIFFERENCE = 0.03
# of how much a window's readings vary; that the nominal model leaves on average where it explains nothing; chosen
EXPLAINS_NOTHING_SHARE = 0.5
# parts; of a short window, as far as samples allow; chosen
SHORT_WINDOW_PARTS = 16
# of what is left above the noise; that a round takes away at least where few effects will take all of it; chosen
ON_COURSE_SHARE = 0.5

# --- starting values ---

# times a joint's own frequency; beyond, a shaken base moves it by less than a hundredth as much; chosen: 1 / 12² =
# 0.007
FOLLOWED_FREQUENCY_RATIO = 12.0
# of a motion's extent; below which a shaking is not seen; chosen
UNSEEN_EXTENT = 1e-3
# periods; of a cogging torque in one turn, at most; chosen
MOST_COGGING_PERIODS = 60
# of the motion's extent; at which a stop may stand; chosen
STOP_PLACES = (
    0.15,
    0.25,
    0.35,
    0.45,
    0.55,
    0.65,
    0.72,
    0.79,
    0.85,
    0.9,
    0.94,
    0.97,
    0.99,
)
# times the special case's amplitude; a start for amplitudes that it does not have; chosen
LARGER_AMPLITUDE = 1.5
# of the first size of a law; at which it is as good as gone; chosen
GONE_SIZE = 1e-3
# of a channel's extent; at which it may saturate; chosen
SATURATION_PLACES = (0.8, 0.95, 0.999)
# of a mode's elastic energy in what was added; from which on the mode is that of what was added; chosen
OWN_MODE_SHARE = 0.5
# damping ratio; least of a start: less shows in no recording; chosen
LEAST_DAMPING_RATIO = 1e-3
# of the largest eigenvalue; below which one is rounding; chosen above double rounding (2e-16)
EIGENVALUE_ROUNDING = 1e-10
# ratio of stiffness; below which two starts are one; chosen
SAME_START_RATIO = 1.05
# times starting values; that a set is searched beyond its ends; closed form: a stiffness is the square of a
# frequency
FURTHER_REACH = REACH**2

# joints; of which an ordinary set has the dissipation of all; chosen
MOST_ORDINARY_JOINTS = 3

# --- from start to fit ---

# times the cost of noise alone; below which a special case is as good as the general law; chosen
AS_GOOD_COST_RATIO = 1.2
# ratio of damping; from which on nothing rings; chosen
DEAD_DAMPING_RATIO = 0.5
# times the cost of the fit that a start extends; beyond which it is given up; chosen
FAR_WORSE_RATIO = 2.0
# times the cost of the fit that a start extends; the same, where a valley is to be followed; chosen
OFF_THE_WAY_RATIO = 1.3
# of a nominal quantity; by which it is bent back at a time; chosen
BENT_BACK_STEP = 0.01
# stages; of bending back at least; chosen
FEWEST_BENT_STAGES = 4
# stages; of bending back at most; chosen
MOST_BENT_STAGES = 16
# steps; of a fit in such a stage; chosen
BENT_STAGE_STEPS = 8
# steps; in which everything else follows a new effect; chosen
FOLLOWING_STEPS = 5
# of the promised size; at which a new effect is tried; chosen
PROMISED_SHARES = (1.0, 0.5, 0.25, 0.1, 0.03, 0.01)

# --- score tests ---

# of a column's square; below which what is left of it is rounding; chosen above double rounding squared (5e-32)
UNRESOLVED_SHARE = 1e-13
# rad, rad/s; error of one step of a run, at most; chosen
COARSEST_TOLERANCE = 1e-8
# standard deviations of noise; the same; chosen
RESOLVED_NOISE = 1e-5
# standard deviations; by which data may move and the linear view still be good to a few hundredths of one; chosen
TRUSTED_SIGMAS = 100.0
# standard deviations of noise; norm of a projected direction below which nothing can be seen of it; chosen
WEAK_DIRECTION = 1e-4
# of a channel's extent; deviations of its reading up to here count as linear; chosen
LINEAR_EXTENT = 0.02
# of a channel's extent; the same of motion, which gets out of step. A spring and a heavier link do so alike, and
# what parts them is a ten thousandth of that, and by deviations twenty times as large nothing was left of it. Much
# smaller ones drown in the unevenness of runs with friction; measured on a spring beside a heavier link
LINEAR_MOTION_EXTENT = 1e-3
# times; by which a starting point is brought nearer to absence at most; chosen: was 1e-4, which could not part a
# spring from a lighter link
NEAREST_TO_ABSENCE = 1e-6
# times; by which a starting point is brought nearer to absence at first; chosen
FIRST_NEARER = 0.1
# times the spring that a torque at rest asks for with its rest at a typical angle; softest that is tried; chosen
SOFTEST_SPRING_RATIO = 0.3
# times, either way; by which a start with coordinates of its own is moved; chosen
RESIZED_RATIO = 10.0
# times the starting point; beyond which the linear view cannot vouch for a start; chosen
GREATEST_START_RATIO = 30.0
