"""A link taken as rigid that bends in its first mode."""

from __future__ import annotations

from harness.effects.bending import bend
from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="link_flexibility",
    title="flexible link",
    family=Family.ELASTICITY,
    site=SiteKind.LINK,
    parameters=(
        Parameter(
            "frequency",
            "Hz",
            "of the first bending mode of the link as mounted: its joint free to turn, gravity left out, all else "
            "at zero "
            "position",
            lower=1e-3,
            upper=1e5,
            scale=Scale(2.0, frequency=1),
            starts=(0.5, 1.5, 5.0),
            search="spectrum",
            inexact=0.01,  # see ``bend``
            plausible=Plausible(
                Scale(1.0, frequency=-1),
                "what bends slower than some times its swing would have been modelled",
                inverse=True,
            ),
        ),
        Parameter(
            "damping_ratio",
            "1",
            "of that mode",
            lower=0.0,
            upper=0.99,
            scale=Scale(0.01),
            starts=(0.3, 3.0, 20.0),
            plausible=Plausible(
                Scale(0.02), "metals and clamps: 0.0019 for the paper's strip, ten times that for bolted ones"
            ),
        ),
    ),
    signature="A fast decaying vibration rides on the swing after release and sudden changes, at one frequency.",
    shows_in="a sample rate above twice the frequency; a sudden start or drive; best with strain or tip acceleration",
    source="Meirovitch, Fundamentals of Vibrations (2001), ch. 8: bending vibration of beams.",
    expressed_by={
        "denoc": "beam with two modes",
        "exudyn": "ANCF cable elements",
        "mujoco": "a chain of short links with springs",
    },
    needs=("motion", "rigid"),
    confusable_with=("joint_flexibility", "base_compliance"),
    reshape=Reshape(bend, topology=True),
)
