"""The report's files, by format."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from harness.cases.gate import Judgement, SelfTest
from harness.cases.results import Results
from harness.errors import InputError
from harness.system.suggest import did_you_mean
from harness.whole_files import write_folder


def _html(results: Results) -> str:
    # matplotlib takes a second to load, and only pictures need it.
    from harness.report.html import html

    return html(results)


def _markdown(results: Results) -> str:
    from harness.report.markdown import markdown

    return markdown(results)


def _csv(results: Results) -> str:
    from harness.report.table_csv import table_csv

    return table_csv(results)


def _junit(results: Results) -> bytes:
    from harness.report.junit import junit

    return junit(results)


FILES: dict[str, tuple[str, Callable[[Results], str | bytes]]] = {
    "json": ("results.json", lambda results: results.to_text()),
    "md": ("results.md", _markdown),
    "csv": ("results.csv", _csv),
    "junit": ("junit.xml", _junit),
    "html": ("report.html", _html),
}


# Every picture of the page as a file of its own; only when asked for.
PICTURES = "svg"


def write_reports(
    results: Results,
    folder: str | Path,
    formats: Sequence[str] | None = None,
    *,
    judgement: Judgement | None = None,
    trials: SelfTest | None = None,
    models: Mapping[str, Path] | None = None,
) -> list[Path]:
    """Write the formats asked for (all by default) into a folder; returns their paths.

    judgement: of a gate, for what it has to say in JUnit XML, first on the page, and in gate.md besides. trials: of its planted
    defects, for gate.md. models: the file of each case, for the line that changed.
    Raises InputError for an unknown format or a folder that cannot be written to.
    """
    for name in formats or ():
        if name not in FILES and name != PICTURES:
            raise InputError(f"no format is named {name!r}", mend=did_you_mean(name, (*FILES, PICTURES)))
    chosen = {name: FILES[name] for name in (formats or FILES) if name != PICTURES}
    files: dict[str, str | bytes] = {
        file: render(results) if judgement is None or file != "report.html" else "" for file, render in chosen.values()
    }
    if judgement is not None:
        from harness.report.gate import markdown
        from harness.report.junit import junit

        files["junit.xml"] = junit(results, judgement)
        files["gate.md"] = markdown(results, judgement, trials, files=models)
        if "report.html" in files:
            from harness.report.html import html

            files["report.html"] = html(results, judgement=judgement, models=models)
    if PICTURES in (formats or ()):
        from harness.report.pictures import pictures

        files.update(pictures(results))
    return write_folder(folder, files)
