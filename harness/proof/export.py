"""Sealed cases for others: recordings, nominal models and digests under names that tell nothing; the answers stay in the proof."""

from __future__ import annotations

import json
import secrets
import shutil
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from harness.errors import InputError
from harness.proof.kept import read_digests, texts_by_name
from harness.proof.seal import unseal
from harness.whole_files import write_whole

NAMES = "exported.json"  # in the proof's folder: exported name -> case
# Bits of a seed. Who has this code can draw the first rig of every seed and hold it against an exported model: of thirty-one bits
# that takes days, of so many nobody can.
SEED_BITS = 128
GUESSED = 2**80  # a seed below it may be found so


def seed_of_export() -> int:
    """A fresh seed that cannot be tried out."""
    return secrets.randbits(SEED_BITS) | 1 << (SEED_BITS - 1)


def export(proof: Path, to: Path) -> int:
    """Copy a proof's cases without their answers; how many.

    proof: folder with ``cases``, ``sealed`` and ``digests.json``. to: a new folder. Names of cases say their kind, so that they are
    drawn by lot; the proof keeps which is which, the same at every export. The seed stays behind too: with it cases could be drawn
    again. Raises InputError where the folder is not empty or the proof was not sealed whole.
    """
    digests = _digests(proof)
    if to.exists() and any(to.iterdir()):
        raise InputError("is not empty", source=to, mend="give --export a new folder")
    names = _names(proof, digests)
    partial = to.with_name(f".{to.name}.partial")
    shutil.rmtree(partial, ignore_errors=True)
    for shown, name in names.items():
        target = partial / "cases" / shown
        target.mkdir(parents=True)
        for source in sorted((proof / "cases" / name).iterdir()):
            if source.name == "model.toml" or (source.name.startswith("run") and source.suffix == ".csv"):
                # By content alone: the time of writing would tell the order of drawing.
                (target / source.name).write_bytes(source.read_bytes())
    published = {shown: digests[name] for shown, name in names.items()}
    (partial / "digests.json").write_text(json.dumps(published, indent=1) + "\n", encoding="utf-8")
    (partial / "README.md").write_text(
        files("harness.proof").joinpath("export.md").read_text(encoding="utf-8"), encoding="utf-8"
    )
    template = {"schema": "denoc.claims/1", "entrant": "", "cases": {shown: {"findings": []} for shown in names}}
    (partial / "claims.template.json").write_text(json.dumps(template, indent=1) + "\n", encoding="utf-8")
    if to.exists():
        to.rmdir()
    partial.replace(to)
    return len(names)


def answers(proof: Path) -> tuple[dict[str, dict[str, Any]], dict[str, str]]:
    """Sealed answers by case, held against their digests; and the exported name of each case that has one."""
    digests = _digests(proof)
    file = proof / NAMES
    names = texts_by_name(file) if file.exists() else {}
    return {name: unseal(name, proof / "sealed", published) for name, published in digests.items()}, {
        name: shown for shown, name in names.items()
    }


def _digests(proof: Path) -> dict[str, str]:
    if not (proof / "digests.json").exists():
        raise InputError(
            "holds no sealed cases", source=proof, mend="give the folder that `denoc prove --export` kept (its --out)"
        )
    if not (proof / "sealed").is_dir():
        raise InputError(
            "has no answers: it is an export",
            source=proof,
            mend="give the folder that `denoc prove --export` kept (its --out)",
        )
    return read_digests(proof)


def _names(proof: Path, digests: Mapping[str, str]) -> dict[str, str]:
    file = proof / NAMES
    if file.exists():
        return texts_by_name(file)
    order = list(digests)
    secrets.SystemRandom().shuffle(order)
    width = max(3, len(str(len(order))))
    names = {f"case-{k:0{width}d}": name for k, name in enumerate(order, 1)}
    write_whole(file, json.dumps(names, indent=1) + "\n")
    return names
