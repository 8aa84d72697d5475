"""A path that computes and has no row fails here."""

from __future__ import annotations

import inspect
from dataclasses import fields
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

from harness.cases.gate import read_accepted
from harness.cases.gate.coverage import EXEMPT, PATHS, rows_of, table
from harness.denoc import Denoc
from harness.denoc.batch.in_space import SpaceBatch
from harness.denoc.batch.model import BatchModel
from harness.denoc.compiling.tasks import TASKS
from harness.denoc.joint_laws import laws
from harness.denoc.lanes.model import LaneModel
from harness.denoc.loops.closed import Closed
from harness.effects import measurement, resampling
from harness.engines import registry
from harness.recording.formats.detect import READERS
from harness.system import Beam, Joint, Link

ROOT = Path(__file__).parents[2]
# Methods that closed mechanisms compute in another way.
AGAIN = ("forward_dynamics", "inverse_dynamics", "simulate")


def functions(owner: object) -> list[str]:
    return [name for name, value in vars(owner).items() if inspect.isfunction(value) and not name.startswith("_")]


def paths_of_the_code() -> set[str]:
    owners = (Denoc, Closed, LaneModel, BatchModel, SpaceBatch)
    found = {f"{owner.__name__}.{name}" for owner in owners for name in functions(owner)}
    # What a closed mechanism does as any other is a path already.
    found -= {f"Closed.{name}" for name in functions(Denoc)} - {f"Closed.{name}" for name in AGAIN}
    found |= {f"Closed.{name}" for name in AGAIN}
    found |= {f"law {slot.name}" for slot in laws.SLOTS}
    found |= {f"kernel {name}" for name in TASKS}
    for word, owner in (("joint", Joint), ("link", Link), ("beam", Beam)):
        found |= {f"{word} {field.name}" for field in fields(owner)}
    found |= {
        f"sensor {name}"
        for module in (measurement, resampling)
        for name in functions(module)
        if getattr(module, name).__module__ == module.__name__
    }
    # Text is read here, by no reader of a process of its own.
    found |= {f"recording {module}" for _, module, _ in READERS} | {"recording csv"}
    found |= {f"engine {name}" for name in registry.names() if name not in registry.own_names()}
    return found


def test_every_path_of_the_code_has_a_row_or_a_reason():
    known = PATHS.keys() | EXEMPT.keys()
    assert sorted(paths_of_the_code() - known) == []
    assert not PATHS.keys() & EXEMPT.keys()


def test_no_path_is_listed_that_the_code_does_not_have():
    # What is no method, law, kernel or field, and cannot be listed by looking.
    others = {
        path
        for path in PATHS
        if path.split()[0] in ("method", "lanes", "forces", "reader", "channel", "gravity", "dry", "base")
    }
    assert sorted((PATHS.keys() | EXEMPT.keys()) - others - paths_of_the_code()) == []


@pytest.mark.parametrize("path", sorted(PATHS))
def test_every_path_is_held_by_rows_that_are_accepted(path):
    rows = read_accepted(ROOT / "reference" / "accepted.json").rows
    compared = [key for key, entry in rows.items() if entry.verdict == "pass"]
    assert rows_of(path, compared), f"no accepted row of {', '.join(PATHS[path])}"
    for pattern in PATHS[path]:
        assert any(fnmatchcase(key, pattern) for key in compared), pattern


def test_the_documentation_shows_the_table():
    assert table() in (ROOT / "docs" / "gate.md").read_text("utf-8")
