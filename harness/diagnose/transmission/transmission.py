"""Recordings with a second encoder behind the gear: what lies between drive and link is told beside a diagnosis of the drives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.claims.grades import POSSIBLE
from harness.diagnose.problem.constants import HELD_OUT_SHARE
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.transmission.constants import PLACING_ROUNDS
from harness.diagnose.transmission.laws import LAWS
from harness.diagnose.transmission.regression import explained
from harness.diagnose.transmission.second_encoders import SecondEncoders
from harness.diagnose.transmission.told import JointTwist, sentence
from harness.diagnose.transmission.twist import (
    TwistRun,
    behind_the_gears,
    cutoff_for,
    given_way,
    off_by_tolerance,
    twists,
)
from harness.effects.catalogue import effect
from harness.effects.scale import references
from harness.recording.recording import Recording
from harness.system import Attachment, System
from harness.system.description import constant

Array = NDArray[np.float64]

GIVES = {"joint_flexibility", "backlash"}  # effects by which a link is elsewhere than its drive


def links_apart(
    system: System, recordings: Sequence[Recording], held: Recording | None, second: SecondEncoders
) -> SecondEncoders:
    """Second encoders with where the links are, as far as they and the model as stated show that joints give.

    recordings, held: without what second encoders read.
    """
    every = [*recordings, *([held] if held is not None else [])]
    if not second or _unusable(system, every):
        return second
    second = replace(second, cutoff=cutoff_for(system, every))
    for _ in range(PLACING_ROUNDS):
        # Loads are those where the links are, which lateness and gain tell, which loads tell.
        late, gains = dict[str, float](), dict[str, float]()
        for joint in _joints(system, system, every, second):
            found: dict[str, dict[str, float]] = {}
            for law, span in zip(joint.fitted.laws, joint.fitted.laws.spans, strict=True):
                found[LAWS[law].effect] = LAWS[law].values(joint.fitted.shares[span].tolist())
            late[joint.joint] = found.get("sensor_delay", {}).get("delay", 0.0)
            if GIVES & set(found):
                gains[joint.joint] = found.get("sensor_gain", {}).get("gain", 1.0)
        second = second.giving(every, late, gains)
    return second


def as_of_one_body(
    system: System, recordings: Sequence[Recording], held: Recording | None, second: SecondEncoders
) -> tuple[list[Recording], Recording | None]:
    """Recordings, and the one held out, with the efforts that drives would need if their links did not give.

    Inverse dynamics takes links to be where the drives are: what their weight and inertia need elsewhere is taken off the efforts,
    by the model as stated, whose errors count there by the little that links give.
    """
    every = [*recordings, *([held] if held is not None else [])]
    if not any(second.motion):
        return list(recordings), held
    out = []
    for recording, there in zip(every, second.motion, strict=True):
        more, time = given_way(system, recording, there, second.cutoff)
        efforts = tuple(
            replace(e, values=constant(e.values + np.interp(recording.time, time, more[:, system.joint_names.index(e.site)])))
            for e in recording.efforts
        )  # fmt: skip
        out.append(replace(recording, efforts=efforts))
    return (out, None) if held is None else (out[:-1], out[-1])


def with_second_encoders(
    found: Diagnosis, system: System, recordings: Sequence[Recording], held: Recording | None, second: SecondEncoders
) -> Diagnosis:
    """A diagnosis with what second encoders tell of its joints.

    recordings, held: without what those read. second: as ``links_apart`` leaves them. Loads are those of the model with what was
    found.
    """
    if not second:
        return found
    every = [*recordings, *([held] if held is not None else [])]
    why = _unusable(system, every)
    if why:
        return replace(found, quality=[*found.quality, *_passed_over(every, second, why)])
    joints = _joints(system, found.augmented or system, every, second, judged=True)
    if not joints:
        why = f"too little is recorded to compare encoders below {second.cutoff:.2g} Hz"
        return replace(found, quality=[*found.quality, *_passed_over(every, second, why)])
    return _told(found, joints)


def _joints(
    system: System, whole: System, recordings: Sequence[Recording], second: SecondEncoders, *, judged: bool = False
) -> list[JointTwist]:
    """The twist of every joint with a second encoder, explained.

    whole: the system that loads are of. judged: whether the model's tolerances count.
    """
    links = behind_the_gears(whole)
    others = off_by_tolerance(system, links) if judged else []
    runs = [
        twists(system, recording, channels, there, second.late, second.cutoff, links, others) if channels else {}
        for recording, channels, there in zip(recordings, second.channels, second.motion, strict=True)
    ]
    joints = []
    for name in system.joint_names:
        mine = [run[name] for run in runs if name in run]
        divided = _divided(mine, held_out=bool(mine) and name in runs[-1])
        if divided is None:
            continue
        candidates = [_candidate(system, name, law, recordings) for law in range(len(LAWS))]
        fitted = explained(*divided, partial(_surprise, candidates))
        joint = system.joint(name)
        joints.append(JointTwist(name, joint.position_unit, joint.prismatic, *divided, fitted, candidates))
    return joints


def _surprise(candidates: Sequence[Candidate], law: int, shares: Array) -> float:
    """−2 log of how plausible a law and its size are, the effects that it is one of being alike."""
    candidate = candidates[law]
    total = 2.0 * (float(np.log(len({one.effect for one in LAWS}))) + candidate.effect.rarity)
    values = LAWS[law].values(shares.tolist())
    for parameter in candidate.effect.parameters:
        if parameter.plausible is not None and parameter.name in values:
            total += parameter.plausible.surprise(values[parameter.name], parameter.neutral, candidate.references)
    return total


def _unusable(system: System, recordings: Sequence[Recording]) -> str:
    """Why second encoders cannot be used; empty where they can."""
    if system.flexible or system.loops or system.gimbals:
        return "encoders behind gears are compared in trees of rigid links on joints of one degree of freedom"
    for recording in recordings:
        lacking = [name for name in system.joint_names if f"{name}.position" not in recording.channel_names]
        if lacking:
            return f"without {lacking[0]}.position the loads behind the gears are not known"
    return ""


def _passed_over(recordings: Sequence[Recording], second: SecondEncoders, why: str) -> list[dict[str, Any]]:
    return [
        {"recording": r.name, "kind": "ignored_column", "channel": c.name, "what": why, "done": "left out"}
        for r, channels in zip(recordings, second.channels, strict=True)
        for c in channels
    ]


def _divided(runs: Sequence[TwistRun], *, held_out: bool) -> tuple[list[TwistRun], list[TwistRun]] | None:
    """Training recordings and the one held out, or parts of a single one."""
    if not runs:
        return None
    if len(runs) > 1 and held_out:
        return list(runs[:-1]), list(runs[-1:])
    cut = int((1.0 - HELD_OUT_SHARE) * len(runs[-1].time))
    return [*runs[:-1], runs[-1].part(slice(0, cut))], [runs[-1].part(slice(cut, None))]


def _candidate(system: System, joint: str, law: int, recordings: Sequence[Recording]) -> Candidate:
    site = LAWS[law].site(joint)
    own = references(system, site, recordings[0])
    # An axis that gravity does not load is driven all the same.
    return Candidate(effect(LAWS[law].effect), site, replace(own, torque=max(own.torque, own.effort)))


def _told(found: Diagnosis, joints: Sequence[JointTwist]) -> Diagnosis:
    """The diagnosis with rows and words of its joints' second encoders."""
    each = [joint.findings() for joint in joints]
    rows = [row for own in each for row in own]
    firm = [row for row in rows if row["grade"] != POSSIBLE]
    complete = all(joint.complete for joint in joints)
    verdict = found.verdict
    if verdict == "consistent" and (rows or not complete):
        verdict = ("explained" if complete else "partly_explained") if firm else "unexplained"
    elif firm and (verdict == "unexplained" or not complete):
        verdict = "partly_explained"
    augmented = found.augmented
    if augmented is not None:
        augmented = instead_of_the_drives(augmented, _attached(firm, joints))
    curves = found.curves
    if curves is not None:
        drawn = [residuals for joint in joints for residuals in joint.residuals()]
        curves = replace(curves, residuals=(*curves.residuals, *drawn))
    noise: list[Any] = [{"channel": j.channel, "std": j.noise, "unit": j.unit} for j in joints]
    return replace(
        found,
        verdict=verdict,
        summary=f"{found.summary} {sentence(joints, each)}",
        noise=[*found.noise, *noise],
        findings=[*found.findings, *rows],
        fit=[*found.fit, *(joint.fit() for joint in joints)],
        augmented=augmented,
        curves=curves,
    )


def instead_of_the_drives(system: System, more: Sequence[Attachment]) -> System:
    """The system with what encoders on both sides of a joint tell, in place of what its drive alone has told of the same effect."""
    told = {(a.effect, a.site) for a in more}
    kept = (a for a in system.attachments if (a.effect, a.site) not in told)
    return replace(system, attachments=(*kept, *more))


def _attached(rows: Sequence[dict[str, Any]], joints: Sequence[JointTwist]) -> list[Attachment]:
    """What lies between drive and link, for the augmented model; errors of second encoders are none of a model's."""
    there = {joint.joint for joint in joints}
    out = []
    for row in rows:
        if row["site"] not in there:
            continue
        values = {name: parameter["value"] for name, parameter in row["parameters"].items()}
        spread = {name: parameter["std"] for name, parameter in row["parameters"].items()}
        if row["effect"] == "joint_flexibility":
            values.setdefault("damping", 0.0)  # a slow twist does not tell it
        out.append(Attachment(row["effect"], row["site"], values, spread))
    return out
