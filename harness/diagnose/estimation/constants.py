"""The numbers of estimation that decide an answer: above each one its unit; its reason; how it was found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

from __future__ import annotations

from scipy.stats import norm

# --- least squares ---

# times a step's predicted gain; the most that the rest of a search is expected to bring; chosen
EXPECTED_GAIN_RATIO = 6.0
# steps; of a fit at most, unless it is told otherwise; chosen
MOST_FIT_STEPS = 30
# in cost; gain of a step below which a fit has come to its end; chosen
ENOUGH_FIT_GAIN = 0.02
# in cost; the same of fits that a search only has to rank; chosen
RANKING_GAIN = 0.2
# of the normal equations' diagonal; damping that fits begin with; convention: Marquardt's 1e-3
FIRST_DAMPING = 1e-3
# steps; that tell a search's pace; chosen
PACE_STEPS = 4
# of the normal equations' diagonal; least damping; chosen
LEAST_DAMPING = 1e-9
# of the normal equations' diagonal; damping beyond which no step helps; chosen
MOST_DAMPING = 1e8
# relative, at least to one; length of a last step that leaves the sensitivities as they are; chosen
UNCHANGED_STEP = 3e-3
# rounds; of bringing windows to better states and going on from there; chosen
STATE_MIXING_ROUNDS = 3
# of the cost; below which a step's gain by mixing states is not worth going on; chosen
STATE_MIXING_GAIN = 1e-3
# times its cost; below which a window is brought to another initial state; chosen
BETTER_STATE_RATIO = 0.8
# times a step's length; beyond which what is added for its curvature is no correction; chosen
CURVED_STEP_RATIO = 30.0
# cost; of a run that left the numbers: what is merely far off costs less beside any noise; convention: was 1e15
LOST = 1e30

# --- difference quotients ---

# rad, rad/s; step of difference quotients by states; chosen between rounding and curvature
STATE_DIFFERENCE = 1e-6
# of the natural torque; step of difference quotients by forces; chosen between rounding and curvature
FORCE_DIFFERENCE = 1e-3
# in the fit's own coordinates (order one), of large initial states relative; step of difference quotients. Over a
# free run of a hundred radians curvature costs a ten thousandth of the quotient, which is less than most noise;
# chosen: was 3e-5, where sensitivities of long free runs were off by their curvature
DIFFERENCE = 1e-6
# norm of the change of the whitened prediction; that a quotient is taken of where that needs a longer step. Runs in
# which friction switches are uneven by 1e-4, where it is soft by up to 1e-2, and a weak parameter's slope would be
# that; chosen
FELT_CHANGE = 1.0
# in the fit's own coordinates; longest of such steps; chosen
LONGEST_DIFFERENCE = 1e-2
# norm of the change of the whitened prediction; by one step of a sharp difference quotient; chosen
SHARP_CHANGE = 10.0
# in the fit's own coordinates; shortest step of a sharp difference quotient; chosen
SHORTEST_SHARP_DIFFERENCE = 1e-7
# in the fit's own coordinates; longest step of a sharp difference quotient; chosen
LONGEST_SHARP_DIFFERENCE = 0.1
# in the fit's own coordinates; distance of a bound below which a parameter is not moved for a sharp quotient;
# chosen
NARROWEST_ROOM = 1e-3
# standard deviations of noise in a unit of a coordinate; steepest slope that a linear view holds: steeper ones
# overflow when squared and added; chosen
STEEPEST_SLOPE = 1e60

# --- windows, their states and the horizon of prediction ---

# s; over which a state is read off a recording at least; chosen
STATE_READING_TIME = 0.03
# times the median mean square of all windows; from which on a window's state is looked at again; chosen
ODD_WINDOW_RATIO = 3.0
# steps; downhill from a state: near a kink more do not help, and away from it fewer are enough; chosen
STATE_STEPS = 5
# rad or m; that a vibration plausibly begins with; chosen
VIBRATION_AMPLITUDE = 0.1
# rad/s, times the swing's frequency; speed of a swing of one radian, that a state plausibly begins with; chosen
SWING_SPEED = 2.0
# times; that an error may grow within a window: beyond, motion counts as unpredictable; chosen
FORETOLD_GROWTH = 300.0
# times; the same before anything is fitted. What falls over, as an arm that is held up by its motors, leads a model
# that is off by a hundredth of its weight astray by a tenth of a radian then; chosen
FORETOLD_GROWTH_AT_FIRST = 30.0
# pieces of a swing; over which the growth of errors is worked out; chosen
PIECES_A_SWING = 16
# samples; in such a piece at least; closed form: a piece has a beginning and an end
FEWEST_PIECE_SAMPLES = 2
# of a cycle; that a vibration may slip within a window, since a fit finds its way back from a quarter; chosen: half
# of that
VIBRATION_SLIP = 0.125
# samples a cycle; of a vibration that recordings show; chosen: twice Nyquist's
SAMPLES_A_CYCLE = 4.0
# samples; in a window at least; chosen
FEWEST_WINDOW_SAMPLES = 24
# windows; joined to one from stage to stage; chosen
WINDOW_GROWTH = 4

# --- assemblies of closed mechanisms ---

# starts; of Newton's method towards an assembly; chosen
ASSEMBLY_STARTS = 64
# samples; of a recording that are asked whether loops can be closed there; chosen
REACH_SAMPLES = 32
# starts; of Newton's method for each of them, one where the model places itself; chosen
REACH_STARTS = 16
# of those samples; that may be out of reach: noise at a dead point, a wrong zero of some hundredths; chosen
UNREACHED_SHARE = 0.5
# assemblies; that are run, which bounds the work; chosen
MOST_ASSEMBLIES = 16
# rad, or of the mechanism's size; within which two places of all bodies are one; chosen
SAME_ASSEMBLY = 1e-3
# of a joint's range; beyond which a place is none; chosen
OUTSIDE_RANGE_SHARE = 0.05
# of a swing; over which runs of assemblies are judged in turn; chosen
ASSEMBLY_SWINGS = (0.125, 0.25, 0.5, 1.0)
# samples; of such a run that are judged at least; chosen
FEWEST_ASSEMBLY_SAMPLES = 8
# times the mean square of the best; from which on an assembly is given up: likelier by far with an error of unknown
# size, even if all of it errs together; chosen
WORSE_ASSEMBLY_RATIO = 4.0

# times the median over all windows; how far what follows moves for what leads, from which on a window begins at a dead point: an
# error of a state that is read there counts as many times as much elsewhere, and not in a line; chosen
DEAD_POINT_RATIO = 10.0

# --- noise and its colour ---

# of a channel's extent; sensors resolve no less, and computed motions agree to no more; chosen
EXACT_SCATTER = 1e-6
# times the noise; cost from which on a band counts as misfit, not as noise: it lies three times above the noise;
# chosen
MISFIT_BAND_COST = 1.5
# of the bins; between a misfit's peaks the noise shows, in the quieter ones; chosen
QUIET_QUANTILE = 0.25
# times the noise; a bin so far above it belongs to a line of the spectrum; closed form: e⁻¹² of the bins of noise
# do
SPECTRAL_LINE_RATIO = 12.0
# samples; that one sample of noise may follow: white noise upon a slow error looks back as far as its size needs to
# be averaged away; chosen
LONGEST_NOISE_MEMORY = 32
# in units of the sensors' noise; variance that is nothing; chosen
FAINTEST_VARIANCE = 1e-12
# times the sum so far; up to which lags are summed for effective samples; citation: Sokal, Monte Carlo methods
# (1997) 3
CORRELATION_REACH = 5.0
# lines; over the angle, that are looked for at most; chosen
MOST_ANGLE_LINES = 8
# periods within the motion's range; that a line over the angle has: fewer are what any smooth misfit looks like;
# chosen
FEWEST_ANGLE_PERIODS = 4.0
# periods a turn; that are looked for at most; chosen
MOST_PERIODS_A_TURN = 5000.0
# trials; within one resolved period; chosen
ANGLE_OVERSAMPLING = 6.0
# resolved periods; whose median power is what a line over the angle is held against; chosen
ANGLE_BLOCK_PERIODS = 24.0
# overtones; of the rounding of an encoder, that are no lines of their own; chosen
ROUNDING_OVERTONES = 40
# logarithm of the odds; against so strong a line anywhere in noise, e^16 to one; chosen
ANGLE_LINE_EVIDENCE = 16.0

# --- a force that every hypothesis leaves out, over time ---

# knots of a window's forces, all joints together; bounds the work; chosen
MOST_FORCE_KNOTS = 180
# knots in the period of the slowest swing at most; what is faster moves no joint; chosen: 16 was tried and undone
MOST_KNOTS_A_SWING = 40.0
# periods of the slowest swing; memory of a force: one that lasts longer is a constant one; chosen
LONGEST_FORCE_MEMORY = 8.0
# times the shortest memory that can be told; up to which a force is said to keep for no longer than that; chosen
FLEETING_RATIO = 1.05
# chance; of the gain in likelihood under sensor noise alone, below which there is such a force; chosen
LEFT_FORCE_CHANCE = 1e-6
# of the natural torque; smallest size of such a force that is looked at; chosen
SMALLEST_FORCE = 1e-7
# of the natural torque; largest size of such a force that is looked at; chosen
LARGEST_FORCE = 1e2
# in units of the noise's variance; beside a force, at most; chosen
LOUDEST_VARIANCE = 1e12

# --- the same over the state ---

# nodes; of the grids over the state, all joints together: bounds the work; chosen
MOST_STATE_NODES = 240
# nodes; along a side of such a grid at least; chosen
FEWEST_NODES_A_SIDE = 5
# nodes; along a side of such a grid at most; chosen
MOST_NODES_A_SIDE = 11
# standard deviations of position and velocity; shortest length over which the force changes; chosen
SHORTEST_FORCE_LENGTH = 0.15
# standard deviations of position and velocity; longest length over which the force changes; chosen
LONGEST_FORCE_LENGTH = 5.0
# standard deviations of position and velocity; length over which a force changes that is no plain law: what is
# straight over all that was visited, two of these either way, is a constant, a spring or damping; chosen
USUAL_FORCE_LENGTH = 0.7
# in the logarithm of that length; standard deviation of its prior, so that most are a third of what was visited to
# all of one side of it; chosen
FORCE_LENGTH_SPREAD = 0.5
# of the natural torque; what a model that is right leaves of the forces that it has: the scale of a Cauchy prior;
# chosen
USUAL_STATE_FORCE = 0.01
# of the natural torque; the same of friction that is a recording's own: a tenth of what joints have, a hundredth or
# two; chosen
USUAL_LEVEL = 0.001
# of an effort; the same of a gain that is a recording's own: magnets lose a thousandth a kelvin, and drives warm by
# ten; chosen
USUAL_GAIN = 0.01
# standard deviations of the velocity; over which dry friction changes sides; chosen
TURNING_SPEED = 0.1
# steps of a grid; over which a force is continued where no motion passed; chosen
CONTINUED_STEPS = 3
# of their mean square; added to nodes that few readings tell; chosen
NODE_RIDGE = 1e-6
# of the variance; added so that covariances of long lengths can be factorised; chosen above double rounding
# (2e-16): was 1e-9
COVARIANCE_JITTER = 1e-6
# of the largest square; first added to a matrix that rounding has made indefinite; chosen at double rounding
# (2e-16)
FIRST_ADDED = 1e-15
# of the largest square; most that is added to it; chosen
LARGEST_ADDED = 1e-6
# rounds; of pushing the likeliest force and looking again; chosen: was 8
PUSHING_ROUNDS = 20
# times the noise's variance left; from which on a set is begun where it follows the recorded motion; chosen
FAR_FROM_NOISE_RATIO = 2.0
# of the surprise (twice the logarithm of the odds); that a further round has to promise; chosen
ENOUGH_SURPRISE = 1.0
# steps; of a fit beside a force that is not the last one yet; chosen
MOST_STEPS_BESIDE = 6
# times; that the motion which forces act along is brought nearer to the recordings; chosen
CLOSER_ROUNDS = 6
# of what is left (squares); above which that has come to an end; chosen
CLOSER_GAIN = 0.9
# of what joints usually answer to a force; below which they do not; chosen
STUCK_ANSWER = 1e-2
# of a step; that one is shortened to which has led nowhere; chosen
SHORTENED_STEP = 0.3
# of a step; shortest that is tried; chosen
SHORTEST_STEP = 0.05
# in the fit's own coordinates; how stiffly numbers of effects are held where they stand: what is not told stays;
# chosen
HELD_STIFFNESS = 1e-2

# --- intervals ---

# standard deviations; to either end of a normal distribution's 95 %; closed form: Φ⁻¹(0.975) = 1.95996
NORMAL_95 = float(norm.ppf(0.975))
# of a fit's own coordinate; width of an interval beyond which nothing is known; chosen
WIDEST_INTERVAL = 20.0
# recordings; that the spread of all parameters together counts as, beside a parameter's own; chosen
POOLED_RECORDINGS = 4.0
# clusters; without which their spread says nothing; chosen
FEWEST_CLUSTERS = 3
