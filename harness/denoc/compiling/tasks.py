"""The kernels that take long to compile, in groups that can be compiled ahead of use.

A group names its room and function instead of importing them: whoever runs kernels asks here, so nothing here may lean on them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from harness.denoc.compiling.compiled import cache_folder

_HOME = Path(__file__).parents[1]


@dataclass(frozen=True)
class Task:
    """A group of kernels: its room, the function of the room's ``ahead`` that compiles it, and what is then in the cache.

    module, function: of the room; their place in the cache tells that the group was compiled.
    """

    room: str
    name: str
    module: str
    function: str

    def compile(self) -> None:
        """Compile the group, without running it."""
        getattr(import_module(f"harness.denoc.{self.room}.ahead"), self.name)()

    @property
    def done(self) -> bool:
        """Whether the cache holds it."""
        found = cache_folder(_HOME / self.room).glob(f"{self.module}.*.nbi")
        return any(f"{self.function}-" in path.name for path in found)


# Those that call the same functions are neighbours; the largest at both ends, where one begins (``ahead``).
TASKS = {
    "lane_parameters": Task("lanes", "lane_parameters", "rows", "prepare_lane"),
    "lanes": Task("lanes", "lanes", "integrate", "run_groups"),
    "exponential": Task("lanes", "exponential", "exponential", "march_groups"),
    "spatial": Task("lanes", "spatial", "address", "spatial_at"),
    "planar": Task("lanes", "planar", "address", "planar_at"),
    "closed": Task("lanes", "closed", "closed", "close_states"),
    "dop853": Task("motion", "dop853", "adaptive", "dormand_prince8"),
    "gauss": Task("motion", "gauss", "fixed_step", "gauss_legendre6"),
    "rk4": Task("motion", "rk4", "fixed_step", "runge_kutta4"),
    "batches": Task("batch", "batches", "tree_mass", "mass_matrix"),
    "in_space": Task("batch", "in_space", "turns", "masses_from_turns"),
    "chain": Task("recursion", "rigid_chain", "rigid_address", "chain"),
    "rigid": Task("recursion", "rigid_dynamics", "rigid_address", "inverse"),
    "rigid_others": Task("recursion", "rigid_others", "rigid", "locate"),
    "loops": Task("loops", "loops", "address", "dynamics"),
    "flexible_others": Task("recursion", "flexible_others", "flexible", "locate"),
    "flexible": Task("recursion", "flexible_dynamics", "flexible_address", "inverse"),
}


def missing(tasks: Sequence[str]) -> list[str]:
    """Those of the tasks that have left nothing in the cache yet."""
    try:
        return [name for name in tasks if not TASKS[name].done]
    except OSError:
        return []
