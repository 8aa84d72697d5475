"""Whether each engine is there and gets one tiny run right."""

from __future__ import annotations

import math
import os
import platform
import sys
from dataclasses import dataclass

import numpy as np

from harness.cases.pendulums import paper_inertia, paper_pendulum, paper_restoring
from harness.engines import registry
from harness.errors import EngineUnavailableError, UnsupportedError
from harness.parallel import default_workers
from harness.system import Beam, Joint, JointType, System
from harness.system.description import constant
from harness.system.flexible_link import flexible_link

# Engines of beams are asked for a frequency of this strip: 25 × 1 mm steel, 0.30 m, hub 2e-5 kg·m².
STRIP_HZ = 37.540


@dataclass(frozen=True)
class Examined:
    """An engine and how it did: ``works``, ``missing`` or ``broken``, and what came out."""

    name: str
    version: str | None
    state: str
    said: str


def examine() -> list[Examined]:
    """Every engine of the registry, tried on a pendulum (rigid) or on a steel strip (engines of beams)."""
    return [_try(name) for name in registry.names()]


def _try(name: str) -> Examined:
    try:
        engine = registry.engine(name)
        version = engine.version()
    except EngineUnavailableError as error:
        return Examined(name, None, "missing", str(error))
    try:
        system = paper_pendulum()
        if engine.refuses(system) is None:
            found = float(engine.build(system).forward_dynamics(np.array([0.5]), np.zeros(1), np.zeros(1))[0])
            true = -paper_restoring() * math.sin(0.5) / paper_inertia()
            what, good = (
                f"pendulum at 0.5 rad: {found:.6f} rad/s², true {true:.6f}",
                abs(found - true) < 1e-9 * abs(true),
            )
        else:
            # A floating frame does not stiffen by rotation, a geometrically exact beam cannot help it.
            bar = strip() if engine.refuses(strip()) is None else strip(stiffening=False)
            frequencies = engine.build(bar).frequencies(np.zeros(len(bar.coordinate_names)))
            found = float(frequencies[np.abs(frequencies - STRIP_HZ).argmin()])
            # A coarse mesh will do to see whether the engine works.
            what, good = f"steel strip: {found:.2f} Hz, true {STRIP_HZ:.2f}", abs(found - STRIP_HZ) < 0.02 * STRIP_HZ
    except UnsupportedError as error:
        return Examined(name, version, "broken", str(error))
    except Exception as error:
        return Examined(name, version, "broken", f"{type(error).__name__}: {' '.join(str(error).split())}")
    return Examined(name, version, "works" if good else "broken", what)


def strip(*, stiffening: bool = True) -> System:
    """A steel strip hinged at a hub, hanging, without gravity."""
    beam = Beam(
        length=0.3,
        direction=constant([0.0, 0.0, -1.0]),
        bending=constant([1.0, 0.0, 0.0]),
        mass=7850.0 * 0.3 * 0.025 * 0.001,
        bending_stiffness=2.0e11 * 0.025 * 0.001**3 / 12.0,
        width=0.025,
        thickness=0.001,
        youngs_modulus=2.0e11,
        density=7850.0,
        modes=1,
        geometric_stiffening=stiffening,
    )
    joint = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0.0, 1.0, 0.0]), armature=2e-5)
    return System("strip", (joint,), (flexible_link("rod", beam),), gravity=constant(np.zeros(3)))


def surroundings() -> dict[str, str]:
    """Python, cores, threads, and where compiled kernels are kept."""
    import numba

    from harness import kept_kernels

    return {
        "python": f"{platform.python_version()} ({sys.executable})",
        "platform": platform.platform(),
        "cores": str(default_workers()),
        "threads of numba": str(numba.config.NUMBA_NUM_THREADS),
        "OMP_NUM_THREADS": os.environ.get("OMP_NUM_THREADS", "not set"),
        "numba": numba.__version__,
        "compiled kernels": kept_kernels.place(),
    }
