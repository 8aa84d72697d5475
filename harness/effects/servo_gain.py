"""A servo that is stiffer or softer than its data say: it answers its command and its own position by one gain."""

from harness.effects.drive_gain import drive_gain
from harness.effects.effect import Effect, Family, Input, Plausible, Reshape, SiteKind
from harness.effects.measurement import gain
from harness.effects.scale import Scale
from harness.effects.servos import stiffer

EFFECT = Effect(
    name="servo_gain",
    title="servo gain",
    family=Family.INPUT,
    site=SiteKind.JOINT,
    parameters=(
        drive_gain(
            "stiffness of the servo, by which it answers command and position alike, over what the model says",
            Plausible(
                Scale(0.15), "gain of the loop, supply voltage and resistance are in it, each known to some 10 %"
            ),
        ),
    ),
    signature="The joint lags behind its command more, or less, the more the heavier the load; where the servo is at rest "
    "without load it is where it was told to be.",
    shows_in="motion under recorded commands that change fast, or that hold a weight",
    source="Duclusaud, Passault, Padois, Daney, Extended friction models for the physics simulation of servo actuators, arXiv "
    "2410.08650 (2024): the motor of a servo with torque constant and resistance identified, damping by its back-EMF apart.",
    expressed_by={
        "any engine": "stiffness of the joint or of its drive; the rest acts on the effort that is handed over"
    },
    needs=("effort", "servo"),
    confusable_with=("servo_torque", "actuator_gain", "payload_mass", "com_offset", "viscous_damping", "added_inertia"),
    reshape=Reshape(stiffer),
    input=Input(gain, stage=60),
)
