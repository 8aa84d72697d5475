"""The numbers that decide which experiment is proposed: above each one its unit; its reason; how it was found.

``chosen`` where neither a derivation nor a measurement is on record: what such a number does to answers when doubled and halved
stands in ``reference/sensitivity.json``.
"""

# --- what is proposed ---

# standard deviations of noise; by which predictions must differ for an experiment to decide; chosen
PARTED_SIGMAS = 5.0
# standard deviations of noise; the same for one that is good enough, so that no other one has to be found; chosen
PLAINLY_PARTED_SIGMAS = 50.0
# steps of a swing; over which a speed is read off; chosen
SPEED_STEPS_A_SWING = 20
# s; between the samples of a proposed recording; convention: 250 Hz
SAMPLE_TIME = 1 / 250.0
# rad; angles that are proposed to be released from; chosen
RELEASE_ANGLES = (0.15, 0.3, 0.8, 1.5, 2.6)
# rad, or m where nothing is known of a slide; a usual amplitude; chosen
USUAL_AMPLITUDE = 0.8
# of the extent of a slide, or the speed of a joint, in the recordings at hand; that are proposed; chosen
RELEASE_SHARES = (0.25, 0.5, 1.0, 2.0)
# times as long as the recordings at hand; that a longer recording is; chosen
LONGER_RATIO = 3.0
# of the slowest swing's frequency; at which a drive is proposed; chosen
DRIVE_FREQUENCIES = (0.4, 0.8, 1.6)
# of the torque that gravity makes at most; with which a drive is proposed; chosen
DRIVE_SHARE = 0.15
# of that torque over the inertia; below which a joint that is let go stays where it is; chosen
STAYING_ACCELERATION = 1e-6

# --- how far two hypotheses are apart ---

# m/s²; noise of an accelerometer that is proposed; convention: of a common micromechanical one
ACCELEROMETER_NOISE = 0.05
# rad, rad/s; step of difference quotients by states; chosen between rounding and curvature
SEPARATION_DIFFERENCE = 1e-5
# swings; over which a rival is brought near to begin with, then twice as many, and so on; chosen
FIRST_SWINGS = 1.5
# steps; over each such time; chosen: was 12
NEARING_STEPS = 25
# steps; the same where something vibrates, whose runs are dear: what slips by a cycle is not led back by more;
# chosen
VIBRATING_NEARING_STEPS = 8
# steps; over all of it at once, which will do for what is alike and not far off; chosen
SHORTCUT_STEPS = 3
# standard deviations; that part nothing; chosen
NOTHING_PARTED_SIGMAS = 1.0
# of the cost; below which a step's gain is not worth the next one; chosen: was 0.02
NEARING_GAIN = 1e-3
# rad, rad/s; at least, from which a hypothesis has to find back to itself; chosen
MOVED_AWAY = 0.01
# of a separation; that a hypothesis may stay away from itself; chosen
FOUND_BACK_SHARE = 0.1
