"""What the base install leaves out: nothing needs it before it is used, and then one line says which extra brings it."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from harness.errors import EXTRAS, install

ROOT = Path(__file__).parents[2]
ARM = ROOT / "tests" / "compare" / "descriptions" / "arm.urdf"
PENDULUM = str(ROOT / "models" / "urdf" / "rigid_pendulum.urdf")


def without_extras(code: str, tmp_path: Path) -> subprocess.CompletedProcess[str]:
    """Run Python in a process in which none of the packages of the extras can be imported."""
    block = f"import sys; sys.modules.update(dict.fromkeys({sorted(EXTRAS)!r})); "
    return subprocess.run([sys.executable, "-c", block + code], capture_output=True, text=True, cwd=tmp_path)


def denoc(tmp_path: Path, *arguments: str) -> tuple[int, str, str]:
    code = f"from harness.cli.main import status_of; sys.exit(status_of({list(arguments)!r}))"
    done = without_extras(code, tmp_path)
    return done.returncode, done.stdout, done.stderr


def test_every_extra_that_is_named_is_one_that_pip_knows():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert set(EXTRAS.values()) <= set(project["optional-dependencies"])
    base = {entry.split(">")[0] for entry in project["dependencies"]}
    assert not base & {
        "pin",
        "exudyn",
        "pyarrow",
        "pandas",
        "platformdirs",
        "distributed",
        "pysindy",
        "cmaes",
        "figaroh",
        "example-robot-data",
    }


def test_the_base_install_imports_without_any_of_them(tmp_path):
    code = """
import pkgutil, json, harness
from importlib import import_module
failed = {}
for module in pkgutil.walk_packages(harness.__path__, "harness."):
    # Workers and the command itself run on import.
    if module.name.endswith("__main__"):
        continue
    try:
        import_module(module.name)
    except Exception as error:
        failed[module.name] = f"{type(error).__name__}: {error}"
print(json.dumps(failed))
"""
    done = without_extras("exec(" + repr(code) + ")", tmp_path)
    assert done.returncode == 0, done.stderr
    failed = json.loads(done.stdout.splitlines()[-1])
    # Readers of formats and what asks peers are imported when they are used.
    for name, error in failed.items():
        if not name.startswith("harness.proof.peers"):
            assert error.startswith("MissingPackageError") and 'pip install "denoc-harness[' in error, (name, error)
    assert len(failed) <= 6


def test_engines_that_are_not_there_are_skipped_rows_with_the_mend(tmp_path):
    status, out, err = denoc(tmp_path, "validate", str(ARM), "--workers", "1", "--json", "-")
    assert status == 0, err
    rows = json.loads(out)["rows"]
    skipped = {
        row["engines"][1]: row["note"] for row in rows if row["quantity"] == "all" and row["verdict"] == "skipped"
    }
    assert set(skipped) == {"pinocchio", "exudyn"}
    assert all(install("engines") in note for note in skipped.values())
    assert {row["engines"][1] for row in rows if row["verdict"] == "pass"} == {"mujoco"}


def test_a_row_that_a_missing_package_makes_impossible_keeps_its_name_and_says_so_at_the_gate(tmp_path):
    status, out, err = denoc(tmp_path, "validate", "--case", "recording_files", "--workers", "1", "--json", "part.json")
    assert status == 0, err
    part = ROOT / "reference" / "accepted.json"
    status, out, err = denoc(
        tmp_path, "gate", "--results", "part.json", "--reference", str(part), "--no-self-test", "--json", "-"
    )
    rows = [row for row in json.loads(out)["rows"] if row["case"] == "recording_files" and not row["ok"]]
    assert status == 1, err
    assert [(row["quantity"], row["engines"], row["verdict"]) for row in rows] == [
        ("recording_parquet", ["denoc", "analytic"], "skipped")
    ]
    assert rows[0]["reason"] == f"not possible here: pyarrow is not installed: {install('parquet')}"


def test_the_suite_is_installed_with_every_extra_that_its_rows_need():
    sources = [
        file.read_text(encoding="utf-8")
        for part in ("cases", "engines", "recording", "system")
        for file in (ROOT / "harness" / part).rglob("*.py")
    ]
    imports = [
        node for text in sources for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import | ast.ImportFrom)
    ]
    asked = {
        name.partition(".")[0]
        for node in imports
        for name in ([alias.name for alias in node.names] if isinstance(node, ast.Import) else [node.module or ""])
    }
    # What is found by its files, and never imported, is asked for by the name of its extra.
    named = {extra for text in sources for extra in re.findall(r'install\("(\w+)"\)', text)}
    needed = {EXTRAS[name] for name in asked if name in EXTRAS} | named
    assert {"engines", "parquet", "robots"} <= needed
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    target = makefile.split("$(VENV)/.run:")[1].split("\n\n")[0]
    (extras,) = re.findall(r"'\.\[([a-z,]+)\]'", target)
    assert needed <= set(extras.split(","))


@pytest.mark.parametrize(
    ("arguments", "extra"),
    [
        (("simulate", PENDULUM, "--engine", "mujoco", "--duration", "0.1", "--out", "run.parquet"), "parquet"),
        (("diagnose", "run.parquet", "--model", PENDULUM), "parquet"),
        (("simulate", PENDULUM, "--engine", "pinocchio"), "engines"),
    ],
)
def test_one_line_says_which_extra_brings_what_is_missing(arguments, extra, tmp_path):
    (tmp_path / "run.parquet").write_bytes(b"PAR1" + bytes(64) + b"PAR1")
    status, _, err = denoc(tmp_path, *arguments)
    (line,) = [line for line in err.splitlines() if not line.startswith("compiling")]
    assert status == 2 and line.startswith("denoc: ") and install(extra) in line


def test_a_cluster_and_peers_that_cannot_be_asked_are_refused_before_any_work(tmp_path, monkeypatch):
    from harness.errors import InputError
    from harness.parallel import parallel_map
    from harness.proof.run import prove

    for package in ("distributed", "pandas"):
        monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(InputError) as caught:
        parallel_map(abs, [1], dask="tcp://127.0.0.1:1")
    assert install("cluster") in str(caught.value)
    with pytest.raises(InputError) as caught:
        prove(tmp_path / "proof", peers=True)
    assert install("peers") in str(caught.value)
    assert not (tmp_path / "proof").exists()
