"""The numbers that decide what an answer says: above each one its unit; its reason; how it was found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

# --- time limits ---

# of what is left of the time for telling; that intervals may take: errors on data held out come after them; chosen
INTERVALS_SHARE = 0.6
# of what is left of the time for telling; that looking for what predicts best may take, for the same reason; chosen
PREDICTING_SHARE = 0.6

# --- the sentences ---

# of the mismatch on data held out; that laws must remove to be told as possible in so many words; chosen
POSSIBLY_EXPLAINED_SHARE = 0.5
# of the error on data held out; from there on another set predicts plainly better; chosen
PLAINLY_BETTER_ERROR = 0.9
# of the error on data held out; from there on the nominal model is told to predict better than what is told as augmented; chosen:
# a tenth more is not passed over in silence where a table shows it
BETTER_NOMINAL_ERROR = 0.95
# of the nominal model's error; that it must leave at most with its quantities fitted within their tolerances to be told of; chosen
WITHIN_TOLERANCES_SHARE = 0.5
# of a channel's standard deviation (RMS); from which on a model does not follow it: an error of the same size that has nothing to
# do with it leaves so much; closed form: √(1 + 1)
ASTRAY_RATIO = 2.0**0.5
# of what was to be explained; above which no more digits are told: what a model that goes astray leaves has no size; chosen
NEARLY_ALL_SHARE = 0.9995
# standard deviations of its tolerance; beyond which a nominal quantity is not said to be adjusted as that allows; closed form: of
# 370 quantities of a model whose tolerances are right one lies farther
OUTSIDE_TOLERANCE = 3.0
# standard deviations of its tolerance; beyond which a nominal quantity is told to be bent beside what was found; chosen
BENT_BESIDE_FINDINGS = 5.0
# quantities; that are named of those bent so far; chosen
MOST_BENT_NAMED = 3
# standard deviations of its tolerance; from which on a nominal quantity is told to be adjusted where nothing else is; closed
# form: two in three quantities of a model whose tolerances are right lie nearer
TOLD_BEND = 1.0
# of what a model states; below which what may be left of it is not told beside that none is; chosen
TOLD_REST = 0.01
# of the greatest gain; that a test must have to be told instead, because it says more; chosen
TELLING_GAIN_SHARE = 0.25
# correlation with something claimed; from which on a nominal quantity is told too; chosen
TOLD_CORRELATION = 0.3
# terms; of a formula at most: with more, most forces look like something; chosen
MOST_FORMULA_TERMS = 2
# of the squares above the noise; below which a formula says too little of what is left; chosen
FORMULA_SHARE = 0.5
# hypotheses; in the ranking; chosen
SHOWN_HYPOTHESES = 8

# --- numbers and their digits ---

# digits; of a number at least; chosen
FEWEST_DIGITS = 3
# digits; of a number at most; chosen
MOST_DIGITS = 9
# as large as a number may be; up to which all digits are written, since 5570000 and 5.57e+06 would look like two
# figures; chosen
PLAIN_NUMBER = 1e9
# ratio of the ends of an interval; beyond which either is read by itself; chosen
ENDS_RATIO = 10.0
# width of an interval over its best value; beyond which it tells nothing, and a reader takes its ends for findings; chosen
UNDETERMINED_RATIO = 1e6
# relative standard deviation; of what is counted, not measured; chosen
COUNTED_SPREAD = 1e-9
# times as far as its deviation says, or as its other end; beyond which an interval itself is told; chosen
LOPSIDED_RATIO = 2.0
# standard deviations; to either end of a normal distribution's 95 %; closed form: Φ⁻¹(0.975), to the digits that
# are told
TWO_SIDED_95 = 1.96

# --- the model that predicts best ---

# sets of the search; that are asked beside the one claimed; chosen
NEAREST_SETS = 3
# stretches; that are left out in turn at least: recordings, or halves or quarters of them where there are fewer;
# chosen
FEWEST_FOLDS = 4
# stretches; that are left out in turn at most; chosen
MOST_FOLDS = 6
# samples; of a stretch that is left out; chosen
FEWEST_FOLD_SAMPLES = 25
# steps; of a fit for prediction; chosen
PREDICTION_STEPS = 15
# of the slowest swing; length of a piece: over less than a whole one no model loses count; chosen
PIECE_SWINGS = 0.5
# times as long; pieces after pieces, until they are whole: a fit over some follows the motion over a few times as many; chosen
LONGER_PIECES_RATIO = 4.0

# --- curves and the replay in other engines ---

# of the period; span of the local cubic from which accelerations are read; chosen
SMOOTHING_PERIODS = 1.0 / 14.0
# s; of motion that engines are compared over; chosen
REPLAY_TIME = 4.0
# s; step of engines with a fixed one; chosen
REPLAY_STEP = 5e-4
# s; the same where it must be finer; chosen
FINE_REPLAY_STEP = 1e-4

# --- recordings that disagree with one another ---

# recordings; whose numbers a sentence has room for; chosen
RECORDINGS_NAMED = 6
# of the largest number; below which one is told as nothing; chosen
NOTHING_SHARE = 1e-3
