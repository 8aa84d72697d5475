"""The numbers of predictions that decide an answer: above each one its unit; its reason; how it was found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

# --- free runs ---

# s; between the states that a free run hands over, unless the recording itself is coarser or finer; chosen
FINEST_STEP = 0.004
# rad, rad/s; error of a free run in one step: thousands of steps stay far below any sensor's noise; chosen
RUN_TOLERANCE = 1e-10
# instants; at which what a sensor makes of a block of averaged samples is worked out; chosen
MOST_WITHIN_A_BLOCK = 4

# --- stiff runs ---

# variances of the noise; what half the steps may change in the sum of squares of a run. Errors of order 4 leave a
# 225th of it, of order 2, where efforts have kinks and several joints turn, a ninth; chosen: was 5, then 1
HALVED_STEP_CHANGE = 0.3
# of that; below which steps twice as long will do next time, as steps of order 4 that are halved change 256 times
# less; chosen
EASY_STEP_SHARE = 1.0 / 300.0
# steps between two states that are handed over; at most; chosen: was 8, then 16
MOST_INNER_STEPS = 32
# relative; by which parameters of runs that err alike differ; chosen
ALIKE_ROW_DIFFERENCE = 1e-4
# rad, rad/s, relative from one on; by which initial states of runs that err alike differ; chosen
ALIKE_STATE_DIFFERENCE = 1e-5
# rad; that the fastest vibration turns in a step: below, steps that resolve it cost no more; chosen
STIFF_TURN = 0.5
# rad, rad/s; error in one step of runs that take more steps than they are given at the usual one, since every step of
# a held effort excites what vibrates; measured on a link of 60 Hz under held efforts, whose six seconds stay within
# 3e-10 of those at 1e-12
COARSER_TOLERANCE = 1e-7
# states; of a run that is worth being looked at as stiff; chosen
FEWEST_STIFF_STATES = 16

# --- coordinates of a fit ---

# powers of e; that a nominal quantity may be tried away from its stated value; chosen: was 40, where a load of 8e13
# kg was tried and stopped a diagnosis
FARTHEST_NOMINAL = 7.0
# ratio of starting values; from which on a parameter is fitted as a logarithm; chosen
LOGARITHMIC_SPAN = 10.0
# times, either way; beyond its starting values, that a parameter fitted as a logarithm may reach; chosen: was 20
REACH = 5.0
# times weaker than that; that a stiffness may get where a simpler effect stands at infinite stiffness: contacts
# give over a way of their own, so that a weak friction has as weak a stiffness; chosen
WEAKEST_RATIO = 1e3
# typical sizes; that a parameter may have: beyond, what follows from it would be lost in rounding; chosen
LARGEST_SIZE = 1e6
# of a window; that is simulated beyond its end where a clock may run slow; chosen: was 0.03
CLOCK_MARGIN = 0.25
