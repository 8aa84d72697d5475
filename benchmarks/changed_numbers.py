"""The numbers of the diagnosis, and how one of them is changed before anything of the diagnosis is imported."""

from __future__ import annotations

import ast
import importlib
import importlib.machinery
import importlib.util
import sys
from collections.abc import Iterator, Sequence
from importlib.abc import MetaPathFinder
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import harness

ROOT = Path(harness.__file__).parent
PACKAGE = "harness.diagnose"


def tables() -> dict[str, Path]:
    """The tables of numbers by the name of their module."""
    files = sorted([*ROOT.glob("diagnose/*/constants.py"), *ROOT.glob("diagnose/*/constants/*.py")])
    return {".".join(("harness", *f.relative_to(ROOT).with_suffix("").parts)): f for f in files if f.stem[0] != "_"}


def numbers() -> Iterator[tuple[str, str, str]]:
    """Every number that was chosen and not derived: its table, its name, and what is said of it."""
    for table, file in tables().items():
        source = file.read_text(encoding="utf-8")
        lines = source.splitlines()
        for node in ast.parse(source).body:
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                first = node.lineno - 1
                while lines[first - 1].startswith("# ") and not lines[first - 1].startswith("# ---"):
                    first -= 1
                said = " ".join(line[2:] for line in lines[first : node.lineno - 1])
                if "closed form" not in said.rpartition(";")[2]:
                    yield table, node.targets[0].id, said


def short(table: str, name: str) -> str:
    """A number's name in the file: that of its package and its own."""
    return f"{table.split('.')[2]}.{name}"


def changed(value: Any, factor: float) -> Any:
    """A number, or every one of several, times the factor; of a share beyond a half, what it leaves to one."""
    if isinstance(value, tuple):
        return tuple(changed(v, factor) for v in value)
    if isinstance(value, dict):
        return {key: changed(v, factor) for key, v in value.items()}
    if isinstance(value, int):
        return max(1, round(value * factor))
    return 1.0 - (1.0 - value) * factor if 0.5 < value < 1.0 else value * factor


class _Changed(importlib.machinery.SourceFileLoader):
    """Loads a module with one number changed if it is its table, and with what it reads of the tables noted."""

    def __init__(self, name: str, path: str, change: tuple[str, str, float] | None, read: set[str] | None) -> None:
        super().__init__(name, path)
        self._change, self._read = change, read

    def get_code(self, fullname: str) -> CodeType:
        tree = ast.parse(Path(self.path).read_text(encoding="utf-8"))
        if self._change is not None and fullname == self._change[0]:
            _, name, factor = self._change
            for node in tree.body:
                if (
                    isinstance(node, ast.Assign)
                    and isinstance(node.targets[0], ast.Name)
                    and node.targets[0].id == name
                ):
                    node.value = _called("_changed", node.value, ast.Constant(factor))
        elif self._read is not None:
            known = {
                alias.asname or alias.name: short(node.module, alias.name)
                for node in ast.walk(tree)
                if isinstance(node, ast.ImportFrom) and node.module in tables()
                for alias in node.names
            }
            _Noted(known).visit(tree)
        return compile(ast.fix_missing_locations(tree), self.path, "exec")

    def exec_module(self, module: ModuleType) -> None:
        module.__dict__["_changed"] = changed
        module.__dict__["_note"] = self._note
        super().exec_module(module)

    def _note(self, name: str, value: Any) -> Any:
        if self._read is not None:
            self._read.add(name)
        return value


class _Noted(ast.NodeTransformer):
    """Wraps every use of a number so that it is noted; compiled kernels are left as they are."""

    def __init__(self, known: dict[str, str]) -> None:
        self._known = known

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if isinstance(node.ctx, ast.Load) and node.id in self._known:
            return _called("_note", ast.Constant(self._known[node.id]), node)
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        if any("njit" in ast.unparse(d) for d in node.decorator_list):
            return node
        return self.generic_visit(node)


def _called(function: str, *arguments: ast.expr) -> ast.Call:
    return ast.Call(func=ast.Name(function, ast.Load()), args=list(arguments), keywords=[])


class Finder(MetaPathFinder):
    """Finds the modules of the diagnosis for ``_Changed``."""

    def __init__(self, change: tuple[str, str, float] | None, read: set[str] | None) -> None:
        self._change, self._read = change, read

    def find_spec(self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None) -> Any:
        if not fullname.startswith(PACKAGE + "."):
            return None
        spec = importlib.machinery.PathFinder.find_spec(fullname, path)
        if spec is None or spec.origin is None or not spec.origin.endswith(".py"):
            return spec
        loader = _Changed(fullname, spec.origin, self._change, self._read)
        return importlib.util.spec_from_file_location(
            fullname, spec.origin, loader=loader, submodule_search_locations=spec.submodule_search_locations
        )


def before_import(change: tuple[str, str, float] | None, read: set[str] | None) -> None:
    """Change a number (table, name, factor) from now on, and note in ``read`` what is read of the tables.

    Raises RuntimeError where something of the diagnosis has been imported already.
    """
    early = [m for m in sys.modules if m.startswith(PACKAGE + ".")]
    if early:
        raise RuntimeError(f"imported before the number was changed: {early[0]}")
    sys.meta_path.insert(0, Finder(change, read))


def values() -> dict[str, Any]:
    """Value of every number as it stands."""
    found = {}
    for table, name, _ in numbers():
        found[short(table, name)] = getattr(importlib.import_module(table), name)
    return found
