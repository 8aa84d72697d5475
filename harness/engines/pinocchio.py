"""Pinocchio as an engine: what it is asked for, and what it is not; the model is in ``pinocchio_model``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from harness.denoc.compensated import carried
from harness.engines.checked import installed_version, raise_if_refused
from harness.engines.coupled import CoupledModel, couple, follows, without_mimics
from harness.engines.expressed import bends, express, refusal
from harness.engines.loops import closing, refuses_loops
from harness.engines.pinocchio_axes import axes_of
from harness.engines.pinocchio_model import LARGEST, PinocchioModel, _by_velocity, _pinocchio, pinocchio_model
from harness.errors import UnsupportedError
from harness.system import JointType, System
from harness.system.lowering import chained, position_of_rate


@dataclass(frozen=True)
class Pinocchio:
    """Pinocchio as an ``Engine``: rigid trees of up to ``LARGEST`` coordinates, dry friction not simulated."""

    name: str = "pinocchio"

    def version(self) -> str:
        return installed_version("pin", "Pinocchio")

    def refuses(self, system: System) -> str | None:
        if bends(system):
            return "Pinocchio has no elastic links"
        n = system.nv
        if n == 0:
            return "the system has no movable joint"
        if system.loops and follows(chained(system)):
            return "joints that follow others beside loops are not told Pinocchio here"
        reason = refuses_loops("Pinocchio", system, couplings=False)
        if reason:
            return reason
        if n > LARGEST:
            return f"{n} coordinates: pinocchio.Data would take {32 * n**3 / 1e9:.1f} GB (four tensors of n³)"
        return refusal("Pinocchio", system, compensation=True)

    def build(self, system: System) -> PinocchioModel | CoupledModel:
        """The system in Pinocchio; raises UnsupportedError with the reason if it is refused."""
        raise_if_refused(system, self.refuses(system))
        if not system.simple:
            # What Pinocchio is given: joints of one degree, free flyers and spherical joints, none following another.
            system = chained(system, keep=(JointType.FREE, JointType.BALL))
            if follows(system):
                independent = self.build(without_mimics(system))
                return couple(system, independent, independent.names, independent.position_names)
        pin = _pinocchio()
        expressed = express(system)
        system = expressed.system
        try:
            model = pinocchio_model(system)
        except (RuntimeError, ValueError) as error:  # inertia that no body can have, which it checks here and there
            raise UnsupportedError(f"Pinocchio refuses it: {error}", source=system.source) from error
        bare = pin.Model(model)
        bare.armature = np.zeros(model.nv)
        made = PinocchioModel(
            names=system.coordinate_names,
            position_names=system.position_names,
            axes=axes_of(model, system),
            local=position_of_rate(system),
            system=system,
            model=model,
            bare=bare,
            data=pin.Data(model),
            armature=_by_velocity(system, "armature"),
            damping=_by_velocity(system, "damping"),
            stiffness=_by_velocity(system, "stiffness"),
            rest=_by_velocity(system, "rest_position"),
            forces=expressed.forces,
            lifts=tuple(self._lifts(system)),
        )
        if not system.loops:
            return made
        from harness.engines.pinocchio_loops import closed

        return closed(made, closing(system))

    def _lifts(self, system: System) -> Iterator[tuple[float, PinocchioModel]]:
        """Models that weigh what is carried of the links, and what hangs on them beside their weight."""
        for sign in (1.0, -1.0):
            turned = replace(system, links=tuple(replace(k, gravcomp=sign * k.gravcomp) for k in system.links))
            if any(link.gravcomp > 0.0 for link in turned.links):
                found = self.build(carried(turned, 0.0))
                assert isinstance(found, PinocchioModel)
                yield sign, found
