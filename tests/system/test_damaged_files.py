"""Whatever a model file has been through, reading it ends in a system or in one line that says what is wrong."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest

import harness
from harness.errors import InputError
from harness.system import audit

MODELS = Path(__file__).resolve().parents[2] / "models"
ALL = sorted(path for path in MODELS.rglob("*") if path.suffix in (".urdf", ".xml", ".toml"))
STRANGE = [
    "nan",
    "-1",
    "0",
    "1e999",
    "inf",
    "",
    '"',
    "<",
    "]",
    "true",
    "[[]]",
    "{}",
    "é",
    "\x00",
    "1 2",
    "base",
    "99999999999999999999",
]


def damaged(text: str, rng: random.Random) -> str:
    """A few words of the text taken out, doubled, swapped or replaced."""
    words = re.split(r"(\s+|[=\[\]{},<>\"/])", text)
    for _ in range(rng.randint(1, 3)):
        k = rng.randrange(len(words))
        kind = rng.randrange(4)
        if kind == 0:
            words[k] = ""
        elif kind == 1:
            words[k] = words[k] * 2
        elif kind == 2:
            other = rng.randrange(len(words))
            words[k], words[other] = words[other], words[k]
        else:
            words[k] = rng.choice(STRANGE)
    return "".join(words)


@pytest.mark.parametrize("path", ALL, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_damage_is_told_in_one_line(tmp_path: Path, path: Path) -> None:
    rng = random.Random(path.name)
    text = path.read_text(encoding="utf-8")
    refused = 0
    for _ in range(60):
        target = tmp_path / path.name
        target.write_text(damaged(text, rng), encoding="utf-8")
        for read in (harness.load, audit) if path.suffix == ".toml" else (harness.load,):
            try:
                read(target)
            except InputError as error:
                refused += 1
                assert "\n" not in str(error)
                assert len(str(error)) < 600
    assert refused > 5  # the damage is real


@pytest.mark.parametrize("ending", ["urdf", "xml"])
def test_a_model_that_ought_to_be_xml_and_is_none_is_not_told_as_toml(tmp_path: Path, ending: str) -> None:
    file = tmp_path / f"robot.{ending}"
    file.write_text("404: not found\n")
    with pytest.raises(InputError, match=rf"robot\.{ending}:1: holds no XML"):
        harness.load(file)
    # What a file is called decides nothing where it can be read.
    file.write_text((MODELS / "toml/flexible_pendulum.toml").read_text())
    assert harness.load(file).joint_names
