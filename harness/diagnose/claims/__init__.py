"""What may be claimed: effects judged on data held out, and their rivals.

Many effects piece together what nobody has named, so in a set of three or more each pays three times over. No law holds better than
to a thousandth, so what explains less than that share of another finding is none, unless the nominal model would be bent out of its
tolerance without it. Data held out judge by the cost that they add to a fit of the training data (a predictive likelihood), so what
training leaves uncertain is held against nobody, in deviations as large as what is left there. Data that cannot see an effect need
not confirm it; but what only they ask for has been fitted to them, and has to be repeated within them. A nominal model bent out of
its tolerance often predicts as well what an effect is there for; it is no way to do without the effect.

Likelihoods part laws as if nothing but noise were left. Beside a remainder the law that fits best may be the one that takes up most
of it: Dahl's friction, which is a spring before it is friction, for a magnet under a pendulum. So what makes a law more general is
weighed as an effect of its own would be, and its special case is told unless it explains ten times what is left.
"""
