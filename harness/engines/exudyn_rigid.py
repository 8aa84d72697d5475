"""Exudyn's rigid trees as an engine: what they are asked for, and what not; the model is in ``exudyn_rigid_model``."""

from __future__ import annotations

from dataclasses import dataclass, replace

from harness.engines.checked import installed_version, raise_if_refused
from harness.engines.coupled import CoupledModel, couple, follows, without_mimics
from harness.engines.expressed import bends, refusal
from harness.engines.exudyn_rigid_model import LARGEST, ExudynModel, rigid_model
from harness.errors import UnsupportedError
from harness.system import Coupling, JointType, System
from harness.system.lowering import chained, one_degree


@dataclass(frozen=True)
class Exudyn:
    """Exudyn's rigid trees as an ``Engine``; its beams are engines of their own."""

    name: str = "exudyn"

    def version(self) -> str:
        return installed_version("exudyn", "Exudyn")

    def refuses(self, system: System) -> str | None:
        if system.loops and follows(chained(system)):
            return "joints that follow others beside loops are not told Exudyn here"
        if any(isinstance(loop, Coupling) for loop in system.loops):
            return "Exudyn's trees have no polynomial coupling of joints"
        try:
            one_degree(
                without_mimics(chained(replace(system, loops=()), keep=(JointType.BALL, JointType.FREE))),
                "Exudyn's tree of joints of one degree of freedom",
            )
        except UnsupportedError as error:
            return error.what
        if bends(system):
            return "Exudyn's kinematic trees have no elastic links; its beams are exudyn_ancf and exudyn_ffrf"
        n = len(system.joint_names)
        if n == 0:
            return "the system has no movable joint"
        if n > LARGEST:
            return f"{n} coordinates: Exudyn's kinematic trees are for up to {LARGEST}"
        return refusal("Exudyn", system)

    def build(self, system: System) -> ExudynModel | CoupledModel:
        """The system in Exudyn; raises UnsupportedError with the reason if it is refused."""
        raise_if_refused(system, self.refuses(system))
        if not system.simple:
            system = chained(system)
            if follows(system):
                independent = self.build(without_mimics(system))
                return couple(system, independent, independent.names, independent.names)
        if not system.loops:
            return rigid_model(system)
        from harness.engines.exudyn_loops import ClosedExudynModel, add_joints

        return rigid_model(system, ClosedExudynModel, lambda mbs, tree: add_joints(mbs, tree, system))
