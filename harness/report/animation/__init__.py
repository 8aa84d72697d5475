"""A mechanism in motion: measured beside simulated, as lines between its joints."""

from harness.report.animation.scene import Motion, Scene, scene
from harness.report.animation.skeleton import Skeleton, skeleton

__all__ = ["Motion", "Scene", "Skeleton", "scene", "skeleton"]
