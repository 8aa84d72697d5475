"""How results show themselves in a notebook, and become data frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from markupsafe import Markup, escape


def html_table(heads: Sequence[str], rows: Sequence[Sequence[Any]], *, title: str = "", note: str = "") -> str:
    """A table as HTML with every text escaped; cells that are numbers stand to the right.

    title: above it. note: below it.
    """
    head = Markup("").join(Markup('<th scope="col" style="text-align:left">{}</th>').format(text) for text in heads)
    body = Markup("").join(Markup("<tr>{}</tr>").format(Markup("").join(map(_cell, row))) for row in rows)
    return str(
        (Markup("<p><strong>{}</strong></p>").format(title) if title else Markup(""))
        + Markup("<table><thead><tr>{}</tr></thead><tbody>{}</tbody></table>").format(head, body)
        + (Markup("<p>{}</p>").format(note) if note else Markup(""))
    )


def _cell(value: Any) -> Markup:
    if isinstance(value, float):
        return Markup('<td style="text-align:right">{}</td>').format(f"{value:.4g}")
    if isinstance(value, int):
        return Markup('<td style="text-align:right">{}</td>').format(value)
    return Markup('<td style="text-align:left">{}</td>').format(escape("" if value is None else value))


def text_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Aligned columns of text, two spaces apart, a rule under the heads."""
    every = [tuple(heads), *(tuple(row) for row in rows)]
    widths = [max(len(row[k]) for row in every) for k in range(len(heads))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in every]
    return "\n".join([lines[0], "-" * min(max(map(len, lines)), 160), *lines[1:]])


def frame(columns: Mapping[str, Any], *, index: str | None = None) -> Any:
    """A ``pandas.DataFrame`` of columns of equal length. index: the column that becomes the index.

    Raises ImportError where pandas is not installed.
    """
    try:
        import pandas
    except ImportError:
        raise ImportError("a data frame needs pandas (pip install pandas)") from None
    made = pandas.DataFrame(dict(columns))
    return made if index is None else made.set_index(index)
