"""The report as one HTML file that opens without a network."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import resources
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from harness.cases.results import Results
from harness.report.figures.kinds import KINDS, kind_of
from harness.report.sections.distances import Distances
from harness.report.sections.notes import Notes
from harness.report.sections.section import Section
from harness.report.sections.story import Story
from harness.report.sections.summary import Summary
from harness.report.sections.table import Table
from harness.report.sections.versions import Versions


def sections_for(results: Results) -> list[Section]:
    """The page's parts in order; a kind of picture nobody foresaw comes after the known ones."""
    known = [kind.figure for kind in KINDS]
    unforeseen = dict.fromkeys(line.figure for line in results.series if line.figure not in known)
    kinds = [*KINDS, *(kind_of(figure) for figure in unforeseen)]
    return [Summary(), Distances(), *(Story(kind) for kind in kinds), Notes(), Table(), Versions()]


def html(results: Results, title: str = "DeNOC validation") -> str:
    """The page: styles, pictures and figures inlined, no script needed, every text escaped."""
    return page(title, results, sections_for(results), results.created)


def page(title: str, subject: Any, sections: Sequence[Section], created: str = "") -> str:
    """A page from sections about a subject, in order; sections without content are left out."""
    environment = Environment(
        loader=PackageLoader("harness.report", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    parts = []
    for section in sections:
        content = section.content(subject)
        if content is not None:
            body = environment.get_template(section.template).render(title=section.title, **content)
            parts.append((section.anchor, section.title, Markup(body)))
    style = resources.files("harness.report").joinpath("templates/style.css").read_text(encoding="utf-8")
    return environment.get_template("page.html").render(title=title, parts=parts, style=Markup(style), created=created)
