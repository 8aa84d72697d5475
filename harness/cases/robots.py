"""Real robots: URDF files that the package ``example-robot-data`` ships (optional extra ``robots``)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib import metadata
from pathlib import Path

from harness.cases.case import Bench, Case, Check, Row
from harness.cases.users import read, state_checks
from harness.errors import InputError, UnsupportedError, install
from harness.system import System

PACKAGE = "example-robot-data"

# Arms, hands, legged robots, humanoids: file below the package's folder ``robots``, and joints that move.
ROBOTS = {
    "panda": "panda_description/urdf/panda.urdf",
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "kinova": "kinova_description/robots/kinova.urdf",
    "xarm7": "xarm_description/urdf/xarm7.urdf",
    "z1": "z1_description/urdf/z1.urdf",
    "so101": "so_arm_description/urdf/so101.urdf",
    "allegro": "allegro_hand_description/urdf/allegro_right_hand.urdf",
    "baxter": "baxter_description/urdf/baxter.urdf",
    "solo12": "solo_description/robots/solo12.urdf",
    "anymal": "anymal_b_simple_description/robots/anymal.urdf",
    "go2": "go2_description/urdf/go2.urdf",
    "talos": "talos_data/robots/talos_reduced.urdf",
    "icub": "icub_description/robots/icub.urdf",
    "g1": "g1_description/urdf/g1_29dof_rev_1_0.urdf",
}


def files() -> dict[str, Path]:
    """Every URDF of the package by its path below ``robots``; UnsupportedError if it is not installed."""
    try:
        listed = metadata.distribution(PACKAGE).files or []
    except metadata.PackageNotFoundError:
        raise UnsupportedError(f"the package {PACKAGE} is not installed", mend=install("robots")) from None
    found = {}
    for file in listed:
        if file.suffix == ".urdf" and "robots" in file.parts:
            found["/".join(file.parts[file.parts.index("robots") + 1 :])] = Path(str(file.locate()))
    return dict(sorted(found.items()))


def system(file: str) -> System:
    known = files()
    if file not in known:
        raise UnsupportedError(f"this version of {PACKAGE} has no {file}")
    # Several published robots carry inertia that no body can have; engines must agree on them all the same.
    try:
        return read(known[file], physical=False)
    except UnsupportedError:
        raise
    except InputError as error:
        raise UnsupportedError(error.what, mend=error.mend, source=file, line=error.line) from error


@dataclass(frozen=True)
class StateChecks:
    """The checks of a user's model; how many joints it has shows when it has been read."""

    quantity: str = "all"

    def run(self, bench: Bench) -> list[Row]:
        checks: tuple[Check, ...] = state_checks(len(bench.system.coordinate_names))
        return [row for check in checks for row in check.run(bench) if isinstance(row, Row)]


def _case(name: str, file: str) -> Case:
    build: Callable[[], System] = partial(system, file)
    return Case(
        name=f"robot_{name}",
        title=f"{name}: {file}",
        source=f"{PACKAGE}: {file}; agreement of independent engines at random states",
        system=build,
        checks=(StateChecks(),),
        group="robots",
        cost=2.0,
    )


CASES = tuple(_case(name, file) for name, file in ROBOTS.items())
