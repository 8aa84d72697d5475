"""The numbers of a problem that decide an answer: above each one its unit; its reason; how it was found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

# --- evidence, wherever two hypotheses are weighed ---

# twice the logarithm of the odds; below which hypotheses cannot be told apart, and by which an effect has to pay;
# citation: "very strong" evidence begins there (Kass and Raftery, JASA 90 (1995) 773), and at 6 a sensor's gain of
# 0.998 was told as a flexible link
UNPARTED_EVIDENCE = 10.0

# twice the logarithm of the odds; from which on evidence is called strong, and beyond which a set has no say in an
# interval of 95 %; citation: "strong" begins there (Kass and Raftery), odds of twenty (2 ln 20 = 5.99)
STRONG_EVIDENCE = 6.0

# --- what of the recordings is used ---

# of a single recording, until it has come to rest; that is held out; convention: stated to users
HELD_OUT_SHARE = 0.3
# samples of all recordings together, a channel; to which recordings are thinned, which bounds the work; chosen
MOST_SAMPLES = 24_000
# samples of the fastest motion that is looked for; that thinning leaves at least; chosen: was 60, and recordings at
# 500 Hz are averaged to 250 Hz since
SAMPLES_A_SWING = 40.0
# Hz; rate beyond which samples are averaged in blocks: recordings at 250 Hz are left as they are; chosen
FINEST_RATE = 260.0
# usable samples; that a recording has to have, to tell motion from noise; chosen
FEWEST_USABLE_SAMPLES = 50
# of a sample; that a block may be shorter than the rate asks for; chosen
BLOCK_SHORTNESS = 0.1
# of a channel's extent; around where it ends, within which it has come to rest; chosen
AT_REST_SHARE = 0.02
# samples; of motion without which a recording is not divided where it comes to rest; chosen
FEWEST_MOVING_SAMPLES = 100
# samples; of a stretch of an estimate of coherence between position and velocity; chosen
COHERENCE_SEGMENT = 128
# chance; at which a frequency counts as coherent; convention: one in a hundred
COHERENT_CHANCE = 0.01
# of the frequencies; that must be coherent, for a velocity to count as computed from the position; chosen
COHERENT_SHARE = 0.15
# periods of the slowest swing; in a short window; chosen
SHORT_WINDOW_SWINGS = 1.5

# --- efforts between samples ---

# parts of every interval; where laws bend an effort between two samples; chosen
EFFORT_PARTS = 8
# points of a run so divided; beyond which it is divided less, since corners between samples that are many cost
# little; chosen
MOST_EFFORT_POINTS = 40_000
# intervals between samples; from which on an effort is taken for a straight line; chosen
EFFORT_GAP_INTERVALS = 3.0

# of an effort's range; from which on a change within one interval may be a jump, as only a command makes it; chosen
COMMAND_JUMP_SHARE = 0.1
# times the change in half of all intervals; that a jump is; chosen
COMMAND_JUMP_RATIO = 10.0
# of a jump; that the changes before and after it stay below: what passes through a filter takes several intervals;
# chosen
LONE_JUMP_SHARE = 0.3
# intervals; that say how an effort changes otherwise; chosen
FEWEST_EFFORT_INTERVALS = 20

# --- what a model's joints do ---

# of a joint's range; how far from a limit a recording has met it, by its sensor's zero and the give of the stop;
# chosen
NEAR_LIMIT_SHARE = 0.02
# relative 1σ; of a nominal quantity whose model states none; convention: stated to users
USUAL_TOLERANCE = 0.01
# logarithm of a factor; by which a nominal quantity is bent at most while a fit is under way: a thousand times; chosen
FARTHEST_BENT = 7.0
# of a joint's range; beyond which the joint runs through what the model states; chosen
PAST_LIMIT_SHARE = 0.1

# extent by unit; of a joint that is held; chosen
HELD_EXTENT = {"rad": 0.02, "m": 0.001}

# --- time limits ---

# of the time limit; by which search, rivals, criticism and telling have to be over, what one leaves being the next
# one's: what is found counts for nothing until it is judged on data held out, so that the search has not much more
# than half; chosen
STAGE_SHARES = (0.55, 0.7, 0.9, 1.0)
# of what is left of the search's time; that looking for few effects which leave only noise may take: what is more than
# noise has to be weighed beside a force that is left out; chosen
FEW_EFFECTS_SHARE = 0.35
# of what is left of the search's time; that the search under noise alone may take, for the same reason; chosen
NOISE_SEARCH_SHARE = 0.5
# the same; where few effects leave only noise on short windows, so that noise is likely the measure of whole runs, too;
# chosen
NOISE_ALONE_SHARE = 0.85
# of what is then left; that fitting what may not be as drawn may take, before sets are weighed; chosen
DRAWN_SHARE = 0.4
# of the time of criticism; that fitting ordinary laws at every joint may take, for what free runs say of them; chosen
ORDINARY_LAWS_SHARE = 0.3
# of the time of criticism; that tests of what is left may take beside a force that is a remainder whatever they say;
# chosen
REMAINDER_SHARE = 0.4
# s after an interrupt; that each stage may still go on for; chosen
STAGE_TIMES_AT_INTERRUPT = (0.0, 0.5, 2.5, 3.5)
# s beyond the end; for what an answer cannot do without; chosen
GRACE_TIME = 2.5
