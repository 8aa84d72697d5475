"""By what factor a drive gives more or less than its data say: one number, for all that it may be a factor of."""

from harness.effects.effect import Parameter, Plausible
from harness.effects.scale import Scale

TORQUE_CONSTANT = Plausible(Scale(0.1), "torque constants of motors, 10 % by their data sheets")


def drive_gain(meaning: str, plausible: Plausible = TORQUE_CONSTANT) -> Parameter:
    """The parameter ``gain`` [1] of such an effect."""
    return Parameter(
        "gain",
        "1",
        meaning,
        lower=0.01,
        upper=100.0,
        neutral=1.0,
        scale=Scale(0.05),
        starts=(1.0, -1.0, 6.0, -6.0),
        plausible=plausible,
    )
