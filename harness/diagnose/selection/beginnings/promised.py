"""Where its score test promises most."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.selection.beginning import Addition, Beginning


def _starts(addition: Addition) -> list[NDArray[np.float64]]:
    return [addition.beside(addition.promised)]


BEGINNING = Beginning("where its score test promises most", _starts, likeliest=True)
