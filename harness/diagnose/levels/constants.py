"""The numbers that decide how friction differs between recordings: above each one its unit; its reason; how it was found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

# --- levels of friction, by fits ---

# Hz; to which recordings are thinned; convention: 250 Hz
THINNED_RATE = 250.0
# of the logarithm of a level; its spread before anything is recorded: what bearings are known to do; chosen
LEVEL_SPREAD = 0.15
# of the logarithm of a level; the same of viscous damping: oils lose half of their viscosity over ten to twenty kelvin; chosen
VISCOUS_LEVEL_SPREAD = 0.5
# of a parameter's scale; step of difference quotients; chosen between rounding and curvature
LEVEL_FIT_DIFFERENCE = 1e-6
# blocks of a recording; between which the gradient's scatter is taken; chosen
GRADIENT_BLOCKS = 12
# of the largest position; the residual that is aimed at, before it is known; chosen
FIRST_RESIDUAL = 3e-4
# fits; that begin where the best one ended; chosen: was 8
MOST_REFITS = 4
# evaluations; of one fit; chosen
MOST_LEVEL_EVALUATIONS = 60
# in cost; below which a further fit is not worth it; chosen
ENOUGH_REFIT_GAIN = 2.0
# of a starting value; by which it is expected to be wrong; chosen
START_ERROR = 0.1
# rad or m; in which Dahl's friction may build up: shorter ones are Coulomb's friction; chosen
SHORTEST_DAHL_WAY = 1e-3
# s; from which a first state is read off; chosen
FIRST_STATE_TIME = 0.06
# samples; of a stretch that is still a free run; chosen
FEWEST_FREE_SAMPLES = 20

# --- levels of friction, by what a fit leaves ---

# stretches of a recording; if it swings so often; chosen
LEVEL_STRETCHES = 10
# of the level; step of difference quotients; chosen between rounding and curvature
LEVEL_DIFFERENCE = 1e-4
# of the greatest speed; between which friction that all recordings share is linear; chosen
SHARED_SPEEDS = (0.0, 0.03, 0.1, 0.25, 0.5, 1.0)
# of the distance from the middle of the motion; the same over the place; chosen
SHARED_PLACES = (0.0, 0.25, 0.5, 0.75, 1.0)
# of the reach of the motion; over which friction that yields builds up; chosen
YIELDING_WAYS = (0.01, 0.03, 0.1)
# of the greatest speed; over which dry friction turns; chosen
TURNING_SPEED_SHARE = 0.02
# of a level's logarithm; beyond which a linear estimate says nothing; chosen
FURTHEST_LEVEL = 3.0
# of a level's logarithm; from which on no reading bears on it; chosen
UNTOLD_LEVEL = 1e3
# of the largest; below which a direction of the normal equations is rounding; chosen above double rounding (2e-16)
RESOLVED_DIRECTION = 1e-9

# --- whether they differ ---

# of a level; by which levels must differ to be worth telling; chosen
LEAST_DIFFERENCE = 0.03
# of the logarithm of a level; spread of levels that are all but one; chosen
TIED_SPREAD = 1e-6
# hypotheses; the likeliest, in which dry friction is looked for where none is claimed; chosen
RANKED_HYPOTHESES = 4

# --- recordings that disagree with one another ---

# times the noise; that a set leaves of all recordings together which leaves noise of each: what is left of that by laws that are
# nearly right is no disagreement; chosen
APART_RATIO = 3.0
