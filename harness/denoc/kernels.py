"""The kernels that take long to compile, each with the types it is used with: what can be compiled ahead of use."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Task:
    """How a group of kernels is compiled, and the module and function whose place in the cache tells that it was."""

    compile: Callable[[], object]
    module: str
    function: str


# Only the types of these are looked at.
_VECTOR, _MATRIX, _CUBE = np.zeros(1), np.zeros((1, 1)), np.zeros((1, 1, 1))
_WHOLE, _TABLE = np.zeros(1, dtype=np.int64), np.zeros((1, 1), dtype=np.int64)
_RIGID = (1, _MATRIX, _TABLE)
_FLEXIBLE = (*_RIGID, _VECTOR)
# As ``lanes.LaneModel.tables``.
_LANES = (_TABLE, _TABLE, _WHOLE, _MATRIX, _CUBE, _MATRIX)


def _compile(kernel: Any, *arguments: Any) -> None:
    """Compile a kernel for arguments such as these, without running it."""
    from numba import typeof

    kernel.compile(tuple(typeof(argument) for argument in arguments))


def _rigid() -> None:
    from harness.denoc.binding import entry
    from harness.denoc.dynamics_call import forward_entry, inverse_entry
    from harness.denoc.rigid_address import addresses

    addresses()
    entry(forward_entry, 4)
    entry(inverse_entry, 4)


def _chain() -> None:
    from harness.denoc.rigid_address import chain_address

    chain_address()


def _rigid_others() -> None:
    from harness.denoc import rigid, rigid_mass
    from harness.denoc.binding import entry
    from harness.denoc.rigid_address import mass_entry

    entry(mass_entry, 2)
    _compile(rigid_mass.mass_matrix_rows, *_RIGID, _MATRIX, _CUBE)
    _compile(rigid.energy_rows, *_RIGID, _MATRIX, _MATRIX, _MATRIX)
    _compile(rigid.subtract_passive, *_RIGID, _VECTOR, _VECTOR, _VECTOR)
    _compile(rigid.locate, *_RIGID, _VECTOR, _VECTOR)


def _flexible() -> None:
    from harness.denoc.flexible_address import addresses

    addresses()


def _flexible_others() -> None:
    from harness.denoc import flexible

    _compile(flexible.mass_matrix_rows, *_FLEXIBLE, _MATRIX, _CUBE)
    _compile(flexible.energy_rows, *_FLEXIBLE, _MATRIX, _MATRIX, _MATRIX)
    _compile(flexible.hub_rows, 1, 1, _MATRIX, 1, _MATRIX, _MATRIX, _MATRIX, _VECTOR, _MATRIX)
    _compile(flexible.subtract_passive, *_FLEXIBLE, _VECTOR, _VECTOR, _VECTOR)
    _compile(flexible.locate, *_FLEXIBLE, _VECTOR, _VECTOR)


def _dop853() -> None:
    from harness.denoc.adaptive import dormand_prince8

    _compile(
        dormand_prince8, 1, 1, _MATRIX, _WHOLE, _VECTOR, _VECTOR, _VECTOR, _MATRIX, True, 1.0, 1.0, 1.0,
        _MATRIX, _MATRIX, _MATRIX, _WHOLE,
    )  # fmt: skip


def _rk4() -> None:
    from harness.denoc.fixed_step import runge_kutta4

    _compile(runge_kutta4, 1, 1, _VECTOR, 1.0, _MATRIX, True, _MATRIX, _MATRIX)


def _gauss() -> None:
    from harness.denoc.fixed_step import gauss_legendre6

    _compile(gauss_legendre6, 1, 1, _VECTOR, 1.0, _MATRIX, True, *[_MATRIX] * 5)


def _planar() -> None:
    from harness.denoc.lanes_address import planar

    planar()


def _spatial() -> None:
    from harness.denoc.lanes_address import spatial

    spatial()


def _lane_parameters() -> None:
    from harness.denoc.lanes_rows import prepare_lane

    links, tree, _, axes, nominal, plane = _LANES
    _compile(prepare_lane, _VECTOR, 1, links, tree, axes, nominal, plane, *[_VECTOR] * 4)


def _lanes() -> None:
    from harness.denoc.lanes import step_method
    from harness.denoc.lanes_integrate import run_groups

    _compile(
        run_groups, 1, 1, _MATRIX, _MATRIX, 1, *_LANES, 1, _VECTOR, _WHOLE, _CUBE, _WHOLE, 1, 1, _VECTOR, 1.0,
        *step_method(8),
        _CUBE, _CUBE, _CUBE,
    )  # fmt: skip


def _exponential() -> None:
    from harness.denoc.lanes_exponential import march_groups

    _compile(
        march_groups, _MATRIX, _CUBE, 1, *_LANES, 1, _CUBE, _CUBE, np.zeros((1, 1, 1, 1)), _CUBE, _CUBE, 1.0, 1.0, 1,
        _CUBE, _CUBE, _CUBE, _MATRIX,
    )  # fmt: skip


def _batches() -> None:
    from harness.denoc import batch_kernels, batch_mass, batch_tree_mass

    _compile(batch_kernels.forward_dynamics, 1, 1, _TABLE, *[_VECTOR] * 8)
    _compile(batch_kernels.inverse_dynamics, 1, 1, _TABLE, *[_VECTOR] * 7)
    _compile(batch_tree_mass.mass_matrix, 1, 1, _TABLE, np.zeros(1, dtype=np.uint64), *[_VECTOR] * 5)
    _compile(batch_kernels.all_finite, _VECTOR)
    _compile(batch_mass.chain_mass_matrix, 1, 1, _TABLE, *[_VECTOR] * 5)


# Those that call the same functions are neighbours; the largest at both ends, where one begins (``ahead``).
TASKS = {
    "lane_parameters": Task(_lane_parameters, "lanes_rows", "prepare_lane"),
    "lanes": Task(_lanes, "lanes_integrate", "run_groups"),
    "exponential": Task(_exponential, "lanes_exponential", "march_groups"),
    "spatial": Task(_spatial, "lanes_address", "spatial_at"),
    "planar": Task(_planar, "lanes_address", "planar_at"),
    "dop853": Task(_dop853, "adaptive", "dormand_prince8"),
    "gauss": Task(_gauss, "fixed_step", "gauss_legendre6"),
    "rk4": Task(_rk4, "fixed_step", "runge_kutta4"),
    "batches": Task(_batches, "batch_tree_mass", "mass_matrix"),
    "chain": Task(_chain, "rigid_address", "chain"),
    "rigid": Task(_rigid, "rigid_address", "inverse"),
    "rigid_others": Task(_rigid_others, "rigid", "locate"),
    "flexible_others": Task(_flexible_others, "flexible", "locate"),
    "flexible": Task(_flexible, "flexible_address", "inverse"),
}


@lru_cache(maxsize=1)
def without_stale() -> None:
    """Remove, once, the indices of kernels that earlier processes left on disk if any of their sources is newer.

    The compiler's own cache looks at the file of a function only, not at the files of the functions it calls.
    """
    from harness.denoc.lanes_rows import prepare_lane

    patterns = ("lanes*", "laws*", "batch*")
    try:
        newest = max(path.stat().st_mtime for name in patterns for path in Path(__file__).parent.glob(f"{name}.py"))
        for path in (path for name in patterns for path in Path(prepare_lane.stats.cache_path).glob(f"{name}.nbi")):
            if path.stat().st_mtime < newest:
                path.unlink(missing_ok=True)
    except OSError:
        return


def missing(tasks: Sequence[str]) -> list[str]:
    """Those of the tasks that have left nothing in the cache yet."""
    from harness.denoc.lanes_rows import prepare_lane

    try:
        without_stale()
        kept = [path.name for path in Path(prepare_lane.stats.cache_path).glob("*.nbi")]
    except OSError:
        return []
    return [
        name
        for name in tasks
        if not any(k.startswith(f"{TASKS[name].module}.") and f"{TASKS[name].function}-" in k for k in kept)
    ]
