"""A check written in the case's own file, for what the ready-made ones do not fit."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from harness.cases.case import Bench, Row, Series


@dataclass(frozen=True)
class Measured:
    """Whatever ``function`` yields from the bench, under the name ``quantity``."""

    quantity: str
    function: Callable[[Bench], Iterable[Row | Series]]

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        return self.function(bench)
