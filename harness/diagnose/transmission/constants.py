"""The numbers that decide what second encoders say: above each one its unit; its reason; how it was found.

``chosen`` where neither a derivation nor a measurement is on record.
"""

# independent samples; of a recording, without which it is passed over; chosen
FEWEST_SAMPLES = 24
# blocks; of a recording, that are left out in turn; chosen between their number and their length (Künsch, Ann. Stat. 17 (1989)
# 1217: blocks longer than what is left keeps)
BLOCKS = 5
# rounds; of the memory of what is left and of the laws in turn; chosen
NOISE_ROUNDS = 3
# times the encoders' noise; that may be left where nothing more is looked for; chosen
COMPLETE_RATIO = 2.0
# of a shape's length; of what is left beside a recording's zero, below which it is rounding; chosen above double rounding (2e-16)
ROUNDING = 1e-9
# rounds; of where links are and what their encoders' errors are in turn; chosen
PLACING_ROUNDS = 4
# of a share; that a law which physics gives its sign has at least, so that a stiffness stays a number; chosen
LEAST_SHARE = 1e-3
# recordings; from which on one is left out in turn; convention: with two, halves would be all there is
FEWEST_RECORDINGS = 3
