"""The numbers that decide what criticism says: above each one its unit; its reason; how it was found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

# --- tests of what a fit leaves ---

# chance; at which a test of the remainder counts, all recordings being tested at once, with a dozen questions each;
# chosen
TEST_CHANCE = 1e-5
# blocks of a window; the loudness of most of which is that of what is left; chosen
LOUDNESS_BLOCKS = 20
# times the noise floor; held-out residual up to which a model counts as complete; chosen
COMPLETE_RESIDUAL_RATIO = 1.2
# samples; over which a misfit is looked for to go on, at most a quarter of a stretch; chosen
CORRELATION_LAGS = 10
# times what noise gains (or has of power); beyond what an error of the noise's colour can make; chosen
COLOUR_ERROR_RATIO = 1.5
# standard deviations; by which data held out may be left worse than those fitted to; chosen
HELD_OUT_MISFIT_SIGMAS = 5.0
# half waves over a window; of a reading that wanders, at most; chosen
WANDERING_HALF_WAVES = 12
# times the swing's frequency; band around the swing whose spectrum is tested; chosen
SWING_BAND = (0.3, 4.0)
# stretches of a window, over all channels; one of which may be louder than the others; chosen
LOUDER_STRETCHES = 16
# samples; that a stretch must have to be compared in loudness; chosen
LOUDER_STRETCH_SAMPLES = 20
# stretches; without which their loudness is not compared; chosen
FEWEST_LOUDER_STRETCHES = 8
# places of a recording; at which a lasting jump is tried, evenly spread and again where it is likely; chosen
READING_JUMP_PLACES = 160

# --- forces that nobody has named ---

# of the gravity torque; size of the probing forces, small enough to stay linear; chosen
PROBING_FORCE_SHARE = 1e-4
# places over the range of a joint; at which a force of its own is allowed; chosen
STATE_FORCE_PLACES = 10
# times the half range of positions, or the fastest motion; to which the state is cut off where a force is tried
# over it; chosen
STATE_CUT = 1.5
# 1 / fastest motion; steepness by which a force that tells the senses of turning apart turns; chosen
TURNING_STEEPNESS = 20.0
# of all samples; quantile of the speed that counts as the fastest motion; chosen
FASTEST_QUANTILE = 0.98
# of all samples; quantiles of the position that count as the ends of the motion; chosen
END_QUANTILES = (0.005, 0.995)
# of the range of motion; how far a force at one place may reach; chosen
LOCAL_FORCE_WIDTHS = (0.25, 0.1, 0.04)
# angles beside zero; at which a force may begin that acts on one side only; chosen: was 5
ONE_SIDED_FORCE_ANGLES = 9
# moments of a recording; at which a force is tried to set in; chosen
SETTING_IN_MOMENTS = 12
# of the swing's period; how long a force that acts once is taken to last; chosen
SINGLE_FORCE_PERIODS = 0.5
# terms; of which an unnamed force may be the sum, at most; chosen
MOST_FORCE_TERMS = 3
# ratio of eigenvalues of the columns' correlations; below which terms count as dependent; chosen above double
# rounding (2e-16)
FORCE_TERMS_DEPENDENT = 1e-8
# of the columns' squares; ridge under which the gain of several forces at once is solved for; chosen
GAIN_RIDGE = 1e-6
# of the swing's period / 2π; shortest time in which a force may relax; chosen
SHORTEST_RELAXATION = 0.03
# of the swing's period / 2π; longest time in which a force may relax; chosen
LONGEST_RELAXATION = 100.0
# relaxation times; that are tried between these; chosen
RELAXATION_TIMES = 16
# of the largest eigenvalue of the columns' correlations; below which the rest is rounding; chosen above double
# rounding (2e-16)
RELAXATIONS_DEPENDENT = 1e-10
# times the swing's frequency; slowest shaking of a support that is tried; chosen
LOWEST_SHAKING = 0.2
# times the swing's frequency; fastest shaking of a support that is tried; chosen
HIGHEST_SHAKING = 4.0
# frequencies in one over the longest window; how finely shaking is tried, twice what a window resolves; chosen
SHAKING_FINENESS = 2.0
# frequencies; of shaking that are tried at most, to bound the work; chosen
MOST_SHAKING_FREQUENCIES = 240
# of the largest column's square; below which the area of two waves is rounding; chosen above double rounding
# (2e-16)
SHAKING_WAVES_DEPENDENT = 1e-9
# in the criterion; by which an unnamed force must do better than an effect that explains all; chosen
UNNAMED_FORCE_BETTER = 12.0

# --- whether predictions of data held out need an effect ---

# times what the remainder still holds; that an effect must explain, or the remainder might have faked it; chosen
FAKED_RATIO = 10.0
# of what an effect explains; that an unnamed force must leave, to which its linear response is trusted; chosen
NEEDED_SHARE = 0.05
# times; that the held-out free run's error grows without an effect that is claimed beside such a remainder; chosen
CARRIES_RATIO = 1.4
# times; the same of an effect that is claimed whatever the data held out give by themselves; chosen
AMPLY_CARRIES_RATIO = 1.8
# relative difference; of an effect's size between separate recordings that is still the same; chosen
STEADY_SIZE_DIFFERENCE = 0.4
# relative difference; of a frequency between separate recordings that is still the same; chosen
STEADY_FREQUENCY_DIFFERENCE = 0.03
# rad; difference of a phase between separate recordings that is still the same; chosen
STEADY_PHASE_DIFFERENCE = 0.6
# standard deviations; that separate estimates may always be apart; convention: three of a normal distribution
STEADY_SIGMAS = 3.0
# steps; of a fit to the data held out by themselves; chosen
HELD_OUT_FIT_STEPS = 20

# --- where the nominal model and the force that is left out fail ---

# pieces of a recording; each tested on its own; chosen
LOCATED_PIECES = 24
# chance; at which a piece counts as left by the model; chosen
LOCATED_CHANCE = 1e-4
# of the misfit's power; inside the band that is named; chosen
LOCATED_BAND_SHARE = 0.9
# of the greatest speed; below which motion counts as slow in what is told of a force; chosen
SLOW_MOTION_SHARE = 0.2
# of the greatest speed; above which motion counts as fast in what is told of a force; chosen
FAST_MOTION_SHARE = 0.7
# of the half range of angles; up to which a place counts as the middle in what is told of a force; chosen
MIDDLE_SHARE = 0.3
# of the half range of angles; beyond which a place counts as far out in what is told of a force; chosen
FAR_OUT_SHARE = 0.7
# times its share of the time; that a place must hold of the force to be told; chosen
TELLING_PLACE_RATIO = 1.5
# of what is left; that a place holds at least to be worth a sentence; chosen
TELLING_PLACE_SHARE = 0.1
# of a joint's way, or of a recording's time; lengths of the stretches that may be told as the place of a force, a magnet's, a rail
# joint's, a knock's; chosen
NARROW_SHARES = (0.05, 0.1, 0.2)
# of a joint's way, or of a recording's time; from one such stretch to the next; chosen
NARROW_STEP = 0.025
# turns; that a joint makes in all where places are those of every turn; chosen
FEWEST_TURNS = 2.0
# standard deviations; of a slope's noise, below which a recorded joint is taken to rest; chosen
NOISE_OF_REST = 2.0
# samples; of a joint's position, with fewer of which its recorded motion is not known; chosen
FEWEST_READ = 8

# --- doubts ---

# relatives; fitted for what beside a remainder might as well be the law, to bound the work; chosen
MOST_UNPARTED = 4
# samples; of a stretch in which dry friction holds the model; chosen
HELD_STRETCH_SAMPLES = 8
# of the noise; by which a prediction that stands still changes from sample to sample at most; chosen
HELD_CHANGE = 1e-3
# of what a member explains, and of a stretch; that lies where dry friction holds the model, if it only frees that;
# chosen
CREEP_SHARE = 0.5
# of the fastest motion; up to which a joint creeps; chosen
CREEP_SPEED_SHARE = 0.2
# periods of the slowest swing; the samples around a single event that nobody has to explain; chosen
EVENT_PERIODS = 1.0
# periods of the slowest swing; between the moments at which an event is tried; chosen
EVENT_STRIDE_PERIODS = 0.25
# rounds of choosing moments; parameters that the event has bent are put right by the first; chosen
EVENT_ROUNDS = 2
# times; that moments and parameters are found in turn, at most, until neither changes; chosen
EVENT_EXCHANGES = 10
# times the sensors' own scatter from sample to sample; beyond which what is left is no noise of theirs; chosen
SLOW_NOISE_RATIO = 4.0
