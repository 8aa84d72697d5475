"""What a mechanism is, and URDF, MJCF and TOML in and out."""

from harness.system.description import Attachment, Beam, Joint, JointType, Link, System
from harness.system.trajectory import Trajectory

__all__ = ["Attachment", "Beam", "Joint", "JointType", "Link", "System", "Trajectory"]
