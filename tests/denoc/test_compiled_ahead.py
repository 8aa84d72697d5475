"""Kernels compiled ahead of their use are those that are used, and nobody waits for a helper that is gone."""

from __future__ import annotations

import inspect
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from harness.denoc.compiling import ahead, signature
from harness.denoc.compiling import tasks as kernels

_COMPILE = """
import sys
from harness.denoc.compiling import ahead
from harness.denoc.compiling.tasks import TASKS, missing
names = sys.argv[1].split(",")
assert missing(names) == names, missing(names)
ahead.work(names, sys.argv[2])
assert missing(names) == []
"""
_USE = """
import numpy as np
from harness.denoc import Denoc
from harness.denoc.motion.adaptive import dormand_prince8
from harness.denoc.motion.fixed_step import runge_kutta4
from harness.denoc.recursion.rigid import energy_rows
from harness.system.random_systems import random_chain
model, time = Denoc(random_chain(2, 1)), np.linspace(0.0, 0.01, 3)
for method in ("dop853", "rk4"):
    model.simulate(np.zeros(2), np.zeros(2), time, method=method)
for kernel in (dormand_prince8, runge_kutta4, energy_rows):
    assert sum(kernel.stats.cache_hits.values()) == 1, kernel
    assert not kernel.stats.cache_misses, kernel
"""


def _python(code: str, cache: Path, *arguments: str) -> None:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache)}
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]


@pytest.mark.slow
def test_what_is_compiled_ahead_is_what_is_used(tmp_path: Path) -> None:
    claims = tmp_path / "claims"
    claims.mkdir()
    _python(_COMPILE, tmp_path / "cache", "rigid,rigid_others,dop853,rk4", str(claims))
    _python(_USE, tmp_path / "cache")


@pytest.mark.parametrize("task", kernels.TASKS)
def test_kernels_are_compiled_for_as_many_arguments_as_they_take(task: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def counted(kernel: Any, *arguments: Any) -> None:
        assert len(arguments) == len(inspect.signature(kernel.py_func).parameters), kernel.py_func.__name__

    monkeypatch.setattr(signature, "compile_for", counted)
    kernels.TASKS[task].compile()


def test_every_command_names_tasks_that_there_are() -> None:
    for tasks in (ahead.SIMULATE, ahead.DIAGNOSE, ahead.EVERYTHING):
        assert set(tasks) <= set(kernels.TASKS)


def test_processes_take_all_tasks_each_from_another_end() -> None:
    for tasks in (["a"], list("abcde"), list(ahead.EVERYTHING)):
        orders = ahead._orders(tasks)
        assert all(sorted(order) == sorted(tasks) for order in orders)
        assert len({order[0] for order in orders}) == min(len(tasks), 4)


def test_a_task_is_claimed_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = []
    monkeypatch.setattr("harness.denoc.motion.ahead.rk4", lambda: compiled.append("rk4"))
    monkeypatch.setattr(ahead, "_own", set())
    ahead.work(["rk4"], str(tmp_path))
    ahead.work(["rk4"], str(tmp_path))
    assert compiled == ["rk4"]
    assert (tmp_path / "rk4.done").exists()


def test_a_helper_that_is_gone_is_not_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    monkeypatch.setattr(ahead, "_claims", tmp_path)
    monkeypatch.setattr(ahead, "_helpers", [gone])
    monkeypatch.setattr(ahead, "_own", set())
    (tmp_path / "dop853").touch()
    ahead.ready("dop853")
    assert not (tmp_path / "dop853.done").exists()
