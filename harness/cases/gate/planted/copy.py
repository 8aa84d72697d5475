"""A copy of this package with one line made wrong, and with those compiled kernels taken out that the line is part of."""

from __future__ import annotations

import ast
import os
import shutil
from pathlib import Path

from harness.cases.gate.planted.patch import Patch
from harness.denoc.compiling.compiled import STAMP, versions_of
from harness.errors import InputError

PACKAGE = Path(__file__).parents[3]


def spoiled_copy(patch: Patch, folder: Path) -> Path:
    """Write the copy below ``folder``; returns the folder to put on Python's path.

    Files are linked, the one that is patched is written anew. Raises InputError if its text does not stand there once.
    """
    target = folder / PACKAGE.name
    shutil.copytree(PACKAGE, target, copy_function=_link, ignore=shutil.ignore_patterns("*.pyc"))
    models = PACKAGE.parent / "models"
    if models.exists():
        (folder / "models").symlink_to(models)
    path = file_of(patch, target)
    before = path.read_text("utf-8")
    text = before.replace(patch.old, patch.new)
    path.unlink()
    path.write_text(text, encoding="utf-8")
    # What compiles functions by hand may hand on any of its own.
    if "jit(" in before or "simd" in path.parts or _compiled_part(before) != _compiled_part(text):
        _forget(target, path)
    _stamp(target)
    return folder


def file_of(patch: Patch, package: Path = PACKAGE) -> Path:
    """The file that a patch changes; raises InputError if its text does not stand there once."""
    hits = [path for path in package.rglob(patch.file) if patch.old in path.read_text("utf-8")]
    if len(hits) != 1 or hits[0].read_text("utf-8").count(patch.old) != 1:
        raise InputError(
            f"{patch.name}: its text does not stand in {patch.file} once", mend="bring the patch up to date"
        )
    return hits[0]


def _stamp(package: Path) -> None:
    """Say of the kernels left that they belong to the files as they are now: else all would be thrown away.

    A new file, for the old one is linked, and what is written into it would be the checkout's.
    """
    for stamp in list(package.rglob(STAMP)):
        stamp.unlink()
        stamp.write_text(versions_of(package / "denoc"), encoding="utf-8")


def _compiled_part(text: str) -> list[str]:
    """What of a module can be in a kernel: what stands at its top, and functions that are handed to the compiler.

    A function that nothing decorates, or that only keeps its answers, is Python's own, and no kernel can call it.
    """
    return [
        ast.dump(node)
        for node in ast.parse(text).body
        if not isinstance(node, ast.FunctionDef | ast.ClassDef)
        or (isinstance(node, ast.FunctionDef) and any(not _keeps_answers(mark) for mark in node.decorator_list))
    ]


def _keeps_answers(decorator: ast.expr) -> bool:
    name = decorator.func if isinstance(decorator, ast.Call) else decorator
    return isinstance(name, ast.Name) and name.id in ("cache", "lru_cache")


def _link(source: str, target: str) -> str:
    try:
        os.link(source, target)
    except OSError:  # another file system
        shutil.copy2(source, target)
    return target


def _forget(package: Path, changed: Path) -> None:
    """Take out what the compiler keeps of every module whose kernels the changed one can be part of.

    Its cache looks at the file of a function only, and would go on with the code as it was. What is no part of the native
    dynamics is compiled into none of its kernels; packages hand on names, and nothing that is compiled.
    """
    modules = {_name(package, path): path for path in package.rglob("*.py")}
    kernels = {name for name, path in modules.items() if ".denoc." in name and path.stem != "__init__"}
    importers: dict[str, set[str]] = {}
    for name in kernels:
        for imported in _imports(modules[name], kernels):
            importers.setdefault(imported, set()).add(name)
    stale: set[str] = set()
    waiting = [_name(package, changed)]
    while waiting:
        name = waiting.pop()
        if name not in stale:
            stale.add(name)
            waiting += importers.get(name, ())
    for name in stale:
        path = modules[name]
        for kept in (path.parent / "__pycache__").glob(f"{path.stem}.*.nb[ic]"):
            kept.unlink()


def _name(package: Path, path: Path) -> str:
    parts = path.relative_to(package.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _imports(path: Path, known: set[str]) -> set[str]:
    """Modules that a file imports, in functions too; not what is for the type checker alone."""
    found: set[str] = set()
    waiting: list[ast.AST] = [ast.parse(path.read_text("utf-8"))]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            continue
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
        waiting += ast.iter_child_nodes(node)
    return found & known
