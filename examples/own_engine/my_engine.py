"""An engine of one's own, to start from: a pendulum on a hinge, by its closed form.

Put your own engine's calls where the formulas are. Arrays come in the order of ``names``, in SI units.
"""

import numpy as np


class MyEngine:
    """What ``denoc`` asks for a model. ``version`` and ``refuses`` may be left out."""

    name = "mine"

    def version(self):
        return "1.0"

    def refuses(self, system):
        """Why this engine cannot take a mechanism, or None: then the rows say so, and nothing is guessed."""
        if len(system.links) != 1 or system.flexible or system.joints[0].prismatic:
            return "one rigid link on a hinge is all that it knows"
        return None

    def build(self, system):
        return MyModel(system)


class MyModel:
    """A mechanism in this engine. Methods that are missing are told as such, and the others compared."""

    def __init__(self, system):
        (joint,), (link,) = system.joints, system.links
        # Your own order of coordinates, if it is not that of the file: it is sorted out for you.
        self.names = (joint.name,)
        arm = np.cross(joint.axis, link.com)
        self.inertia = joint.axis @ link.inertia @ joint.axis + link.mass * arm @ arm + joint.armature
        self.damping, self.stiffness, self.rest = joint.damping, joint.stiffness, joint.rest_position
        # Weight turned into the joint's frame, and its moment about the axis.
        self.weight = link.mass * joint.rotation.T @ system.gravity
        self.axis, self.com = joint.axis, link.com

    def gravity(self, q):
        """g(q) of M q'' + C q' + g = τ + passive forces."""
        angle, axis = q[0], self.axis
        com = (
            self.com * np.cos(angle)
            + np.cross(axis, self.com) * np.sin(angle)
            + axis * (axis @ self.com) * (1.0 - np.cos(angle))
        )
        return np.array([-axis @ np.cross(com, self.weight)])

    def bias(self, q, qd):
        return self.gravity(q)  # one axis, fixed in space: no Coriolis forces

    def mass_matrix(self, q):
        return np.array([[self.inertia]])

    def forward_dynamics(self, q, qd, tau):
        """Damping and springs of the joint act; dry friction does not."""
        passive = -self.damping * qd - self.stiffness * (q - self.rest)
        return (tau + passive - self.bias(q, qd)) / self.inertia

    def inverse_dynamics(self, q, qd, qdd):
        passive = -self.damping * qd - self.stiffness * (q - self.rest)
        return self.inertia * qdd + self.bias(q, qd) - passive
