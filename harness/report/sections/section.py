"""What a section is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol


class Section(Protocol):
    """A part of the page. ``template``: file in ``report/templates``; ``anchor``: its place in the page's address."""

    @property
    def anchor(self) -> str: ...

    @property
    def title(self) -> str: ...

    @property
    def template(self) -> str: ...

    def content(self, subject: Any, /) -> Mapping[str, Any] | None:
        """What the template needs, or None if the subject (results, a diagnosis) has nothing for this section."""
        ...
