"""The numbers that decide what is claimed: above each one its unit; its reason; how it was found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

# --- what an effect must show ---

# of what an effect does; to which its law may be wrong: less than that beside it is no effect; chosen
INEXACT_LAW_SHARE = 1e-3
# of the noise; by which an effect must change the prediction at least; chosen
PRACTICAL_SHARE = 0.05
# standard deviations; by which an effect must improve data held out; chosen: was 1
HELD_OUT_SIGMAS = 1.5
# standard deviations of noise; between predictions of data held out, up to which those cannot confirm an effect;
# chosen
BLIND_SIGMAS = 4.0
# of what an effect explains; below which training says nothing of it, unless that pays its price. (A weak spring
# may show in the difference between amplitudes alone: tolerances leave half a hundredth of it to the training.);
# chosen
UNREPEATED_SHARE = 0.002
# standard deviations; by which data held out that can see an effect may fall short; convention: three of a normal
# distribution
CONTRARY_SIGMAS = 3.0
# times its price; that an effect must gain which data held out cannot confirm; chosen
AMPLE_GAIN_RATIO = 5.0
# members; from which on a set may piece together what nobody has named; chosen
CROWDED_SET = 3
# times its price; that each member of such a set must gain; chosen
CROWDED_PRICE_RATIO = 3.0
# of what a wave explains; from which on something that rings may be it; chosen
RINGING_SHARE = 0.9
# in the criterion; by which a set is better that does not stand on data held out; chosen
UNPROVEN_EVIDENCE = 30.0
# sets; that are asked whether they stand where the best one does not, likeliest first; chosen
MOST_SETS_ASKED = 6

# --- grades ---

# posterior probability over all sets; from which on an effect, or one of its class, is more than possible;
# convention: 95 %
SURE_PROBABILITY = 0.95
# times its usual size; beyond which a number is not believed: of a centre of mass, three lengths of its link;
# chosen
BEYOND_BELIEF_RATIO = 30.0
# times its usual size; beyond which a number is not believed while there was no time to ask what else could be in its
# place: as rare as five standard deviations; chosen
UNASKED_BELIEF_RATIO = 5.0
# times what is left; that a plain law must explain, or it may be part of that; chosen
PLAIN_LAW_RATIO = 1.0
# times an estimate; that its interval reaches to, beyond which recordings say that something is there, not what;
# chosen
VAGUE_RATIO = 10.0
# of the posterior; that changes no quantile of an interval; chosen
NEGLIGIBLE_POSTERIOR = 1e-6
# standard deviations; within which a quantile of a mixture is looked for; chosen
QUANTILE_SIGMAS = 10.0
# times the error on data held out; from which on it is worth saying; chosen
WORSE_PREDICTION_RATIO = 1.02

# --- rivals ---

# rivals; fitted for each member, which bounds the work; chosen
MOST_RIVALS = 9
# fits of one study; beyond which something outside the catalogue is at work and no further rival is fitted; chosen
MOST_RIVAL_FITS = 60
# of a member's gain; that a rival's score test must promise: the test is linear, the truth is not; chosen
RIVAL_PROMISE = 0.5
# of a member's gain; the same for what is dear to fit, whose test is made at its likely size and so is closer to
# the truth; chosen
DEAR_RIVAL_PROMISE = 0.65
# of a member's gain; that a rival may lack to be made more general; chosen
HOPEFUL_LACK = 0.1
# rivals; that are made more general, which bounds the work; chosen
MOST_WIDENED_RIVALS = 3
# rivals; whose forces over the angle are tried at other places; chosen
MOST_PLACED_RIVALS = 4
# rivals; whose more general laws are tried at typical values; chosen
MOST_GENERAL_RIVALS = 4
# rivals; that are told, however far from the best set; chosen
FEWEST_RIVALS_TOLD = 2
# pairs of exchanges; that are fitted; chosen
MOST_CROSSED_RIVALS = 6
# in the criterion; by how much one of them may be worse alone; chosen
CROSSED_EVIDENCE = 30.0
# members; of larger sets that leave more than noise, only known rivals are told; chosen
FEW_MEMBERS = 2
# times, either way; that the numbers which shape a law are started anew; chosen
SHAKEN_RATIO = 4.0
# of what the set that is told leaves; variance of what free runs of another leave, at least; chosen: less is the error of
# runs
QUIETEST_VARIANCE = 1e-8

# times what is left; that waves over the angle, seen whole, must explain to be more than possible; measured on Gaussian processes
# over 0.6 to 5 rad with lengths of 0.05 to 0.8 rad, 20 000 of each: one in 4 000 at most has two waves of 2 to 12 periods in it
# that explain so much (3 in 1 000 thirty times)
WAVE_RATIO = 100.0
# waves; from which on that is needed of fewer draws; measured on the same
MANY_WAVES = 4.0
# times what is left; that so many must explain; measured on the same, up to 40 periods: none of 20 000 of any length has four waves
# in it that explain ten times what is left
MANY_WAVES_RATIO = 20.0
