"""The report as one HTML file that opens without a network."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from harness.cases.gate import Judgement
from harness.cases.results import Results
from harness.report.figures.canvas import titled
from harness.report.figures.kinds import KINDS, kind_of
from harness.report.sections.distances import Distances
from harness.report.sections.gate import Gate
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


def html(
    results: Results,
    title: str = "DeNOC validation",
    *,
    judgement: Judgement | None = None,
    models: Mapping[str, Path] | None = None,
) -> str:
    """The page: styles, pictures and figures inlined, no script needed, every text escaped.

    judgement: of a gate, goes first. models: the file of each case, for the line that changed.
    """
    sections = sections_for(results)
    if judgement is not None:
        title, sections = "DeNOC gate", [Gate(judgement, models or {}), *sections]
    return page(title, results, sections, results.created)


def page(title: str, subject: Any, sections: Sequence[Section], created: str = "") -> str:
    """A page from sections about a subject, in order; sections without content are left out.

    The scripts of what has plots or sortable tables are inlined, once; without them all is there to read.
    """
    environment = Environment(
        loader=PackageLoader("harness.report", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["titled"] = lambda svg, described: Markup(titled(svg, described))
    parts = []
    for section in sections:
        content = section.content(subject)
        if content is not None:
            body = environment.get_template(section.template).render(title=section.title, **content)
            parts.append((section.anchor, section.title, Markup(body)))
    whole = "".join(body for _, _, body in parts)
    styles, scripts = [_read("templates/style.css")], []
    if 'class="plot"' in whole:
        styles.append(_read("vendored/uPlot.min.css"))
        scripts += [_read("vendored/uPlot.iife.min.js"), _read("templates/plots.js")]
    if 'class="animation"' in whole:
        scripts.append(_read("templates/animation.js"))
    if 'class="sortable' in whole:
        scripts += [_read("vendored/sortable.auto.min.js"), _read("templates/tables.js")]
    return environment.get_template("page.html").render(
        title=title, parts=parts, styles=styles, scripts=scripts, created=created
    )


def _read(name: str) -> Markup:
    return Markup(resources.files("harness.report").joinpath(name).read_text(encoding="utf-8"))
