"""Numbers that decide an answer stand in the table of their package, and say what they are, why, and how they were found."""

from __future__ import annotations

import ast
import re
from collections import Counter
from pathlib import Path

import pytest

import harness

DIAGNOSE = Path(harness.__file__).parent / "diagnose"
TABLES = sorted([*DIAGNOSE.glob("*/constants.py"), *DIAGNOSE.glob("*/constants/*.py")])
FOUND = ("closed form", "citation", "measured on", "convention", "chosen")
NEUTRAL = re.compile(r"-?[01](\.0)?")
# Sizes of buffers, lanes and plots, counts of columns, and units: no answer hangs on them.
EXEMPT = {
    "answer.MOST_POINTS",
    "conditioning.TIMES",
    "criticism.AT_ONCE",
    "estimation.BLOCK",
    "estimation.FRICTIONS",
    "estimation.TOGETHER",
    "inverse.AT_ONCE",
    "inverse.COLUMNS",
    "inverse.DENSE",
    "inverse.DRY",
    "inverse.KEPT",
    "inverse.MOTIONS",
    "inverse.ORDINARY",
    "inverse.POINTS",
    "prediction.ABREAST",
    "prediction.MOST_KEPT",
    "prediction.UNEQUAL",
    "problem.EVENLY",
    "selection.MOST_SAMPLES",
    "selection.MOST_TOGETHER",
}


def _is_number(value: ast.expr) -> bool:
    """Whether an expression is a number, several, or a formula of some, and not only another one's name."""
    parts = list(ast.walk(value.args[0] if isinstance(value, ast.Call) and len(value.args) == 1 else value))
    several = [v for part in parts if isinstance(part, ast.Dict) for v in part.keys]
    plain = (ast.Constant, ast.Tuple, ast.List, ast.Dict, ast.BinOp, ast.UnaryOp, ast.operator, ast.unaryop, ast.Name, ast.Load,
             ast.Attribute, ast.Call)  # fmt: skip
    constants = [p.value for p in parts if isinstance(p, ast.Constant) and p not in several]
    return (
        all(isinstance(part, plain) for part in parts)
        and bool(constants)
        and all(isinstance(c, (int, float)) and not isinstance(c, bool) for c in constants)
    )


def _numbers(tree: ast.Module) -> list[str]:
    """Names that a module gives to numbers."""
    found = []
    for node in tree.body:
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        )
        value = node.value if isinstance(node, (ast.Assign, ast.AnnAssign)) else None
        if value is not None and _is_number(value):
            found += [n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name)]
    return found


def _tree(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"))


def test_numbers_stand_in_tables() -> None:
    """What is met here moves to ``constants`` of its package, or decides no answer and is named above."""
    elsewhere = {
        f"{file.relative_to(DIAGNOSE).parts[0]}.{name}"
        for file in DIAGNOSE.rglob("*.py")
        if file not in TABLES
        for name in _numbers(_tree(file))
    }
    assert elsewhere == EXEMPT


def test_what_steers_a_fit_is_no_number_in_a_function() -> None:
    """Defaults of parameters and fields other than none and one (or the last), and how long and how far a fit goes."""
    found = set()
    for file in DIAGNOSE.rglob("*.py"):
        for node in ast.walk(_tree(file)):
            values: list[tuple[str, ast.expr | None]] = []
            if isinstance(node, ast.arguments):
                every = [*node.posonlyargs, *node.args]
                values += [
                    (a.arg, d) for a, d in zip(every[len(every) - len(node.defaults) :], node.defaults, strict=True)
                ]
                values += [(a.arg, d) for a, d in zip(node.kwonlyargs, node.kw_defaults, strict=True)]
            elif isinstance(node, ast.ClassDef):
                values += [(ast.unparse(f.target), f.value) for f in node.body if isinstance(f, ast.AnnAssign)]
            elif isinstance(node, ast.Call):
                values += [(k.arg, k.value) for k in node.keywords if k.arg in ("most_steps", "enough", "max_nfev")]
            found |= {
                f"{file.relative_to(DIAGNOSE).with_suffix('').as_posix()}.{name}"
                for name, value in values
                if value is not None
                and re.fullmatch(r"-?\d[\d.e+*/ -]*", ast.unparse(value))
                and not NEUTRAL.fullmatch(ast.unparse(value))
            }
    # How many figures a sentence has.
    assert found - {"answer/explain.count"} == set()


@pytest.mark.parametrize(
    "line", ["A = 1.5", "A = 2 * B", "A, B = 1, 2.0", "A: float = 1e-3", "A = (1.0, 2.0)", "A = float(norm.ppf(0.9))"]
)
def test_numbers_are_seen(line: str) -> None:
    assert "A" in _numbers(ast.parse(line))


@pytest.mark.parametrize(
    "line", ["A = 'a'", "A = ('a', 1)", "A = B", "A = Check('a', 1)", "A = True", "A = {1.0: 'a quarter'}"]
)
def test_other_things_are_no_numbers(line: str) -> None:
    assert not _numbers(ast.parse(line))


@pytest.mark.parametrize("table", TABLES, ids=lambda t: t.relative_to(DIAGNOSE).with_suffix("").as_posix())
def test_every_number_says_what_it_is_and_how_it_was_found(table: Path) -> None:
    """Unit; reason; how found: in the comment above it."""
    lines = table.read_text(encoding="utf-8").splitlines()
    for k, line in enumerate(lines):
        name = re.match(r"([A-Z_0-9]+) = ", line)
        if name:
            first = k
            while lines[first - 1].startswith("# ") and not lines[first - 1].startswith("# ---"):
                first -= 1
            said = [part.strip() for part in " ".join(line[2:] for line in lines[first:k]).split(";")]
            assert len(said) == 3 and all(said), name[1]
            assert said[2].startswith(FOUND), name[1]


def test_tables_are_leaves() -> None:
    """A number may follow from one of another table, and from nothing else of the diagnosis."""
    for table in TABLES:
        for node in ast.walk(_tree(table)):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("harness"):
                assert ".constants" in str(node.module), table


def test_numbers_are_used_and_named_once_in_a_package() -> None:
    """One that nothing uses goes, and a name means one thing in its package."""
    used = Counter(
        w
        for file in DIAGNOSE.rglob("*.py")
        for w in re.findall(r"\b[A-Z][A-Z_0-9]+\b", file.read_text(encoding="utf-8"))
    )
    names = [(table.relative_to(DIAGNOSE).parts[0], name) for table in TABLES for name in _numbers(_tree(table))]
    assert len(set(names)) == len(names)
    # Where it stands, where it is imported, and where it is used.
    assert [name for _, name in names if used[name] < 3] == []
