"""A servo that gives more or less torque than its data say, whatever it answers."""

from harness.effects.drive_gain import drive_gain
from harness.effects.effect import Effect, Family, Input, Reshape, SiteKind
from harness.effects.measurement import gain
from harness.effects.servos import stronger

EFFECT = Effect(
    name="servo_torque",
    title="servo torque off",
    family=Family.INPUT,
    site=SiteKind.JOINT,
    parameters=(drive_gain("torque of the servo, its damping included, over what the model says"),),
    signature="The joint answers its command as under a lighter or a heavier load, with its friction smaller or larger by the "
    "same factor.",
    shows_in="motion under recorded commands that change fast, or that hold a weight",
    source="Siciliano et al., Robotics: Modelling, Planning and Control (2009), ch. 5: drives and their torque "
    "constants; ch. 8: position and velocity loops.",
    expressed_by={
        "any engine": "stiffness and damping of the joint or of its drive; the rest acts on the effort that is handed over"
    },
    needs=("effort", "damped servo"),
    confusable_with=("servo_gain", "actuator_gain", "payload_mass", "com_offset", "added_inertia", "coulomb_friction"),
    reshape=Reshape(stronger),
    input=Input(gain, stage=60),
)
