"""The page on the paper: its tables are those that the commands gave, its pictures are there, and its commands exist."""

from __future__ import annotations

import json
import re
import runpy
import shlex
import tomllib
from pathlib import Path

import click
import pytest

from harness.cases.paper import beside
from harness.cli.main import denoc
from harness.proof.paper_damping import PUBLISHED

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "paper.md"
KEPT = ("damping", "departure", "links", "readings")


def test_tables_are_those_of_the_references():
    page = PAGE.read_text(encoding="utf-8")
    places = re.findall(r"<!-- table (\S+) (\S+) -->", page)
    assert {path for path, _ in places} == {f"reference/paper_{what}.json" for what in KEPT}
    assert runpy.run_path(str(ROOT / "docs" / "tables.py"))["filled"](page) == page


@pytest.mark.parametrize("what", KEPT)
def test_a_reference_says_the_command_that_made_it(what):
    kept = json.loads((ROOT / "reference" / f"paper_{what}.json").read_text(encoding="utf-8"))
    words = shlex.split(kept["command"])
    assert words[:3] == ["denoc", "paper", what]
    assert kept["schema"] == "denoc.paper/1"
    if what != "links":
        assert int(words[words.index("--seed") + 1]) == kept["numbers"]["seed"]


def test_pictures_are_there():
    for path in re.findall(r"\]\((images/\S+)\)", PAGE.read_text(encoding="utf-8")):
        assert (ROOT / "docs" / path).read_text(encoding="utf-8").startswith("<svg"), path


@pytest.mark.parametrize("page", ["docs/paper.md", "examples/paper/README.md"])
def test_commands_exist_with_their_options_and_files(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    commands = [line for block in re.findall(r"```sh\n(.*?)```", text, re.DOTALL) for line in block.splitlines()]
    checked = 0
    for line in commands:
        words = shlex.split(line, comments=True)
        if not words or words[0] != "denoc":
            continue
        verb = denoc.get_command(click.Context(denoc), words[1])
        known = {name for parameter in verb.params for name in parameter.opts}
        assert {word for word in words if word.startswith("--")} <= known, line
        for word in words:
            if word.startswith(("models/", "examples/")):
                assert (ROOT / word).is_file(), line
        checked += 1
    assert checked >= 8


def test_published_numbers_are_those_of_the_paper():
    paper = tomllib.loads((ROOT / "reference" / "paper.toml").read_text(encoding="utf-8"))
    published = sorted({one["hz"] for one in paper["frequency"]})
    drawn = {hertz for by_label in beside.SWING.values() for hertz in by_label.values()} | set(
        beside.VIBRATION.values()
    )
    assert sorted(drawn) == published
    assert paper["damping"]["xi"] == beside.PUBLISHED_XI
    assert paper["open_question"]["departure_s"] == PUBLISHED
