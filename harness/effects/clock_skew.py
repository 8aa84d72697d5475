"""A logger whose clock runs fast or slow; acts on every channel."""

from harness.effects.effect import Effect, Family, Parameter, Plausible, Sensor, SiteKind
from harness.effects.measurement import clock_skew
from harness.effects.scale import Scale

EFFECT = Effect(
    name="clock_skew",
    title="clock skew",
    family=Family.SENSOR,
    site=SiteKind.CHANNEL,
    parameters=(
        Parameter(
            "factor",
            "1",
            "recorded time over true time; above 1 the clock runs fast",
            lower=0.8,
            upper=1.25,
            neutral=1.0,
            scale=Scale(0.005),
            starts=(1.0, -1.0, 10.0, -10.0),
            plausible=Plausible(Scale(1e-4), "crystal oscillators keep time to 1e-4 (Ridoux and Veitch, 2010)"),
        ),
    ),
    signature="Everything is slower or faster by the same factor; the phase runs away steadily.",
    shows_in="long recordings whose frequency is known from elsewhere (dimensions, a known drive)",
    source="Ridoux and Veitch, Principles of robust timing over the Internet, Commun. ACM 53 (2010) 54–61: clock skew.",
    expressed_by={"any engine": "acts on the signal that any engine predicts"},
    needs=("channel",),
    simpler=(),
    confusable_with=("payload_mass", "added_inertia", "com_offset", "joint_stiffness"),
    sensor=Sensor(clock_skew, stage=10, every_channel=True, clock=True),
)
