"""Two flexible links with rotors and dampers at both joints, against finite elements, with and without geometric stiffening."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from harness.cases.beams import strip, two_strips
from harness.cases.case import NATIVE, Case
from harness.cases.checks.deflection import Accuracy, DeflectionAgreement
from harness.system import System

# What a rotor and a damper at a joint are, in turn from the base [kg·m², N·m·s/rad]: enough to be half of what is felt there.
ROTORS, DAMPERS = (1e-3, 3e-4), (5e-3, 2e-3)


def system(stiffening: bool) -> System:
    links = two_strips(5)
    joints = tuple(
        replace(joint, armature=rotor, damping=damper)
        for joint, rotor, damper in zip(links.joints, ROTORS, DAMPERS, strict=True)
    )
    return replace(
        links, joints=joints, links=tuple(strip(name, modes=5, stiffening=stiffening) for name in ("upper", "lower"))
    )


def _case(name: str, title: str, peer: str, stiffening: bool, why: str) -> Case:
    return Case(
        name=name,
        title=title,
        source="J. Gerstmayr and H. Irschik, J. Sound Vib. 318 (2008) 461-487 (ANCF); A. Zwölfer and J. Gerstmayr, "
        "Acta Mechanica 232 (2021) 835-851 (floating frames)",
        system=partial(system, stiffening),
        checks=(
            DeflectionAgreement(
                peer=peer,
                position=(("shoulder", -1.0), ("elbow", -0.5)),
                duration=0.3,
                step=1e-4,
                elements=8 if stiffening else None,
                accuracies=(Accuracy(None, 0.01, 2e-5, why),),
            ),
        ),
        group="flexible",
        engines=(NATIVE, peer),
        cost=10.0,
    )


CASES = (
    _case("geared_links", "Two flexible links with rotors and dampers, against two ANCF beams", "exudyn_ancf", True,
          "eight cables on each beam at 0.1 ms are certain to about half a per cent of the peak"),
    _case("geared_links_unstiffened", "The same without geometric stiffening, against two floating frames", "exudyn_ffrf", False,
          "Craig-Bampton modes of bricks at 0.1 ms are certain to about half a per cent of the peak"),
)  # fmt: skip
