"""One way to close the loops of a mechanism, as the one in which a window begins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Assembly:
    """A state (2n,) at which a window begins.

    stated: what it would be where the model places itself. ways: how many assemblies there are with what was recorded; alike: how
    many follow the recording as well, this one included.
    """

    state: Array
    stated: Array
    ways: int = 1
    alike: int = 1

    @property
    def elsewhere(self) -> bool:
        """Whether it is not where the model places itself."""
        return self.state is not self.stated
