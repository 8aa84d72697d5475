"""A drive that gives more or less than is recorded: a wrong torque constant, a wrong gear ratio."""

from harness.effects.drive_gain import drive_gain
from harness.effects.effect import Effect, Family, Input, SiteKind
from harness.effects.measurement import gain

EFFECT = Effect(
    name="actuator_gain",
    title="actuator gain",
    family=Family.INPUT,
    site=SiteKind.JOINT,
    parameters=(drive_gain("effort that arrives over effort recorded"),),
    signature="The response to the drive is too large or too small by one factor; free motion is as modelled.",
    shows_in="driven motion",
    source="Siciliano et al., Robotics: Modelling, Planning and Control (2009), ch. 5: drives and their torque "
    "constants.",
    expressed_by={"any engine": "acts on the effort that is handed to any engine"},
    needs=("effort",),
    simpler=(),
    confusable_with=("added_inertia", "payload_mass", "actuator_deadzone", "servo_gain", "servo_torque"),
    input=Input(gain, stage=60),
)
