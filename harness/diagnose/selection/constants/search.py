"""The numbers that decide how sets of effects are searched: above each one its unit; its reason; how it was found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

# --- when a set counts as hopeless, far, near or complete ---

# times the cost of noise alone; below which a set counts as complete; chosen
COMPLETE_COST_RATIO = 1.15
# times the cost of noise alone; beyond which a fit is hopeless; chosen
HOPELESS_COST_RATIO = 2.0
# times what the best set leaves; beyond which a fit is far from it; chosen
FAR_COST_RATIO = 3.0
# in the criterion, or the score; within which a set is near the best one; chosen
NEAR_EVIDENCE = 60.0
# in the score; that makes a difference at all; chosen
NOTICEABLE_GAIN = 6.0
# in the score; within which a fit is under way to the best one; chosen
UNDER_WAY_GAIN = 200.0
# standard deviations of the cost of noise alone; that are clearly more than noise; convention: three of a normal
# distribution
CLEARLY_NOISE_SIGMAS = 3.0
# times the cost of noise alone; beyond which how loud the noise is matters little; chosen
PLAINLY_MORE_THAN_NOISE = 1.2
# times the cost of noise alone; farther away, whole numbers that are off by one do not matter; chosen
WORTH_COUNTING_RATIO = 3.0
# chance; of the nominal quantities' deviations, below which a fit is also begun without them; chosen
STRETCHED_CHANCE = 1e-5
# in the criterion; for how a vibration began, since it shows in few samples of its own window; citation: Akaike's
# two a parameter
VIBRATION_PRICE = 2.0
# typical sizes, or powers of e; over which a parameter may lie before anything is recorded; chosen
PRIOR_WIDTH = 3.0
# of what is left above the noise; that effects which are cheap to fit must promise for dear ones not to be looked
# at; chosen
SUFFICIENT_SHARE = 0.8
# relative difference; of scores under two estimates of the noise, up to which score tests serve for both; chosen
ALIKE_SCORES = 0.1
# steps; along a valley that others were given up in; chosen
PATIENT_STEPS = 100
# parts of a swing; over one of which a state is read off: a cubic follows it, and noise matters little; chosen
STATE_READING_PARTS = 8.0
# sets; that are kept, or fitted anew, when all are weighed anew; chosen
RETAINED_SETS = 24
# sets; that are kept a round; chosen
BEAM_WIDTH = 2
# effects; fitted beside each of them; chosen
TRIED_EFFECTS = 4
# effects; in a set at most; chosen
LARGEST_SET = 4
# alternatives; fitted for every member of the best set; chosen
MEMBER_ALTERNATIVES = 3
# fits; of one study: what needs more is not among few effects of the catalogue; chosen
MOST_STUDY_FITS = 30
# steps; of a fit in the search; chosen
SEARCH_STEPS = 15
# steps; of a fit with one more effect, or of ordinary dissipation; chosen
EXTENDING_STEPS = 25

# --- beam search ---

# sets; that are carried to their end before they are compared; chosen
MOST_CARRIED_SETS = 4
# steps; of a fit that is carried to its end; chosen
CARRIED_STEPS = 40
# of the noise's variance; by which predictions of sets that are alike differ; chosen
ALIKE_PREDICTIONS = 0.01
# of what is left above the noise; that one more effect takes away at least; chosen
STALLED_SHARE = 0.02
# of what is left above the noise; that an effect which is dear to fit must promise; chosen
DEAR_EFFECT_SHARE = 0.05
# times; what the linear view promises that a fit may bring; chosen
GENEROUS_PROMISE = 2.0
# effects; that are fitted for how one set is bent; chosen
STRAIGHTENING_EFFECTS = 3
# single effects; looked beside for another one; chosen
PROSPECTS = 4
# sets of two; tried of these; chosen
OFFERED_PAIRS = 4
# times what it promises; of effects that are dear to fit, whose tests are made at their likely sizes; chosen
DEAR_PROMISE = 1.5
# effects; named that were to be fitted next when the time was up; chosen
PROMISED_EFFECTS = 3

# --- rewriting a set ---

# exchanges; for what is dear to fit, in a set that is not; chosen
MOST_DEAR_EXCHANGES = 1
# sets, nearly as good; whose other members' relatives are tried; chosen
MOST_SECOND_SETS = 2
# of what a candidate does (squared); that bending does not do as well, at most; chosen: was 0.05, where bending was
# not undone in long chains
BENT_ALIKE_SHARE = 0.15
# steps; of a fit that is bent back; chosen
BENT_BACK_STEPS = 25
# of what a member brings; that another candidate's score test must promise; chosen
ALTERNATIVE_PROMISE = 0.3
# of what a member brings; the same for candidates that are dear to fit; chosen
DEAR_ALTERNATIVE_PROMISE = 0.6
# sets; tried without what has come to nothing, likeliest first; chosen
MOST_EMPTIED_SETS = 8
# of an effect's typical size; below which it is absent; chosen
NOTHING_SIZE = 1e-3
# pairs of exchanges; fitted; chosen
MOST_EXCHANGED_PAIRS = 6
# candidates; fitted in the place of one member; chosen
MOST_STANDING_IN = 6
# of what the set without the member leaves; that another candidate must promise to explain; chosen
STANDING_IN_SHARE = 0.3
# sets; nearly as good, that are tried without a member; chosen
MOST_REDUCED_SETS = 6
# in the criterion; within which a set is nearly as good; chosen
NEARLY_BEST_EVIDENCE = 20.0
# of a member's gain; that a relative's score test must promise; chosen
RELATIVE_PROMISE = 0.05
# sizes; of a candidate looked at in a member's place; chosen
RELATIVE_SIZES = 4
# sizes; that it is begun at; chosen
RELATIVE_BEGUN_SIZES = 2
# steps; in which it finds its own; chosen
RELATIVE_SIZE_STEPS = 10
# of every window; beginnings that a relative is compared over; chosen
WINDOW_BEGINNINGS = (0.0625, 0.25, 1.0)
# times what the best set leaves on any beginnings; that a relative leaves there at most; chosen
SAME_WORK_RATIO = 10.0
# times the cost of noise alone; what is left there is phases that have slipped, and tests say nothing; chosen
SLIPPED_COST_RATIO = 30.0
# times the fastest of the motion, and times what the damping says; speeds over which the friction falls, and how
# far; chosen
FALLING_FRICTION_SHAPES = ((0.7, 1.0), (1.4, 1.6))
# places; of a cogging torque's periods that are fitted besides; chosen
MOST_COGGING_PLACES = 4
# of what the best place promises; that another place must promise; chosen
COGGING_PLACE_PROMISE = 0.7
