"""Real robots: every URDF of example-robot-data that can be read, in Pinocchio against the native dynamics, MuJoCo and Exudyn.

Their roots are fixed, and float.
"""

from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

from harness.engines import registry
from harness.errors import InputError
from harness.system.load import load
from harness.system.random_joints import random_position


def urdfs() -> Iterator[Path]:
    try:
        files = metadata.files("example-robot-data") or []
    except metadata.PackageNotFoundError:
        return
    for file in files:
        if file.name.endswith(".urdf"):
            yield Path(str(file.locate()))


ROBOTS = sorted(urdfs())


@pytest.mark.skipif(not ROBOTS, reason="example-robot-data is not installed")
# Exudyn's trees have no free joint.
@pytest.mark.parametrize(
    ("floating", "engines"),
    [(False, ("denoc", "mujoco", "exudyn")), (True, ("denoc", "mujoco"))],
    ids=["fixed", "floating"],
)
def test_robots(floating: bool, engines: tuple[str, ...]) -> None:
    compared = 0
    for path in ROBOTS:
        try:
            system = load(path, floating=floating)
        except InputError:
            continue
        models = {name: registry.engine(name).build(system) for name in ("pinocchio", *engines)}
        n = system.nv
        rng = np.random.default_rng(n)
        q, qd, qdd = random_position(system, rng), *rng.normal(size=(2, n))
        reference = models.pop("pinocchio")
        tau = reference.inverse_dynamics(q, qd, qdd)
        mass = reference.mass_matrix(q)
        # Accelerations carry the rounding of the torques times the mass matrix's condition; the rest is rounding alone.
        amplified = 1e-15 * n * max(10.0, np.linalg.cond(mass))
        for name, model in models.items():
            at = f"{path.name} in {name}"
            assert model.mass_matrix(q) == pytest.approx(mass, abs=1e-13 * np.max(np.abs(mass))), at
            assert model.inverse_dynamics(q, qd, qdd) == pytest.approx(tau, abs=1e-12 * np.max(np.abs(tau))), at
            scale = np.max(np.abs(qdd))
            assert model.forward_dynamics(q, qd, tau) == pytest.approx(qdd, abs=amplified * scale), at
        compared += 1
    assert compared >= 50
