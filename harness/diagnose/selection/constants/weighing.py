"""The numbers that decide how sets are weighed: above each one its unit; its reason; how it was found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

from __future__ import annotations

from scipy.stats import chi2

from harness.diagnose.problem.constants import UNPARTED_EVIDENCE

# --- beside a force over the state ---

# sets; that are grown and shrunk side by side: of two that are as good, one may have the wrong law; chosen
SETS_ABREAST = 2
# further members; that are fitted beside a set, of those that promise most; chosen
MEMBERS_TRIED_BESIDE = 3
# twice the logarithm of the odds; by which a set may turn out likelier than a linear view promises, since the force
# beside it moves otherwise; closed form: half of what cannot be told apart
HOPED_EVIDENCE = 0.5 * UNPARTED_EVIDENCE
# twice the logarithm of the odds; behind the best set, from which on nothing is tried beside a set; closed form:
# twice what cannot be told apart
BEHIND_EVIDENCE = 2.0 * UNPARTED_EVIDENCE
# twice the logarithm of the odds; from which on further plain laws are not asked about; closed form: ten times what
# cannot be told apart
OUT_OF_REACH_EVIDENCE = 10.0 * UNPARTED_EVIDENCE
# twice the logarithm of the odds; by which plain laws leave a worse remainder than laws that leave noise, from which on no further
# plain law makes up for it: growing brought 20 to 170 on sealed cases; chosen
FAR_REMAINDER_EVIDENCE = 20.0 * UNPARTED_EVIDENCE
# rounds; of growing and shrinking; chosen
MOST_ROUNDS_BESIDE = 12

# --- a model's own error ---

# sets; whose own force is estimated, to choose the one that the first likelihood is made from; chosen
COMPARED_SETS = 12
# relative change; of a variance, or of samples that count as one, that changes no weighing; chosen
SETTLED_CHANGE = 0.2
# rounds; of estimating the force and weighing again; chosen: was 3
WEIGHING_ROUNDS = 5
# of the size of the force; laws are looked for that would leave so much of it; chosen
SOUGHT_FORCE_SHARE = 0.3
# of a force's size; that is left, below which further laws may show beside it; chosen
SHRUNK_FORCE_SHARE = 0.6
# of what laws leave (RMS); by which a linear view of an error that would explain it may be wrong; chosen
LINEAR_VIEW_ERROR = 0.2
# of what a set leaves (squares); by which one without a law leaves plainly more: three times the error is more than
# a law costs, whatever else is fitted anew; closed form: 3² - 1
PLAINLY_MORE_LEFT = 8.0
# of what the fit left that a set was begun from (squares); a fit that leaves less has left a wrong valley; chosen
NEARER_FIT_RATIO = 0.5
# times the noise (RMS); nearer to it, noise is the measure; chosen
LOUD_RATIO = 3.0

# --- profile likelihoods ---

# whole numbers; beside the likeliest, either way, that are tried; chosen
MOST_NEIGHBOURS = 5
# rise of twice the logarithm of the profile likelihood; at the ends of a 95 % interval of one parameter; closed
# form: χ²⁻¹(0.95, 1) = 3.841
PROFILE_95 = float(chi2.ppf(0.95, 1))
# times; that an interval is doubled outward; chosen
MOST_DOUBLINGS = 5
# steps; of a fit there; chosen
OUTWARD_STEPS = 10
# times; that an interval is halved inward; chosen
MOST_HALVINGS = 12
# times; that the step to where it ends is halved then; chosen
END_REFINEMENTS = 3
# of a logarithm; that an interval may reach; chosen
FARTHEST_LOGARITHM = 4.0
# of a logarithm; what is as uncertain as that is wide enough; chosen
UNKNOWN_LOGARITHM = 1.0
# twice the logarithm of how many; valleys a hundredth wide in which what vibrates fits the noise a little, one at
# every frequency; chosen
VALLEYS_EVIDENCE = 8.0
# waves; over the angle, that must be seen for cogging to be more than a piece of a smooth force; measured on the draws of
# ``claims.constants.WAVE_RATIO``
FEWEST_WAVES = 2.0
