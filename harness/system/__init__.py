"""What a mechanism is, and URDF, MJCF and TOML in and out."""

from harness.system.audit import audit
from harness.system.audit_findings import Audit
from harness.system.description import (
    Actuator,
    Attachment,
    Beam,
    Gimbal,
    Joint,
    JointType,
    Keyframe,
    Link,
    Mimic,
    Stops,
    System,
)
from harness.system.load import load
from harness.system.loop import Coupling, Frame, Loop
from harness.system.random_systems import random_chain, random_tree
from harness.system.trajectory import Trajectory
from harness.system.write import write

__all__ = [
    "Actuator",
    "Attachment",
    "Audit",
    "Beam",
    "Coupling",
    "Frame",
    "Gimbal",
    "Joint",
    "JointType",
    "Keyframe",
    "Link",
    "Loop",
    "Mimic",
    "Stops",
    "System",
    "Trajectory",
    "audit",
    "load",
    "random_chain",
    "random_tree",
    "write",
]
