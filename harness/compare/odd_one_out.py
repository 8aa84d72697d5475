"""When several engines answer and not all agree: which of them stands alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from harness.compare.quantities import relative

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Vote:
    """Who agrees with whom.

    majority: the largest group in which every two agree, if it is more than half of the engines; else empty.
    odd: those outside the majority; empty if there is none. sentence: for a table.
    differences: between every two engines, keys in the order asked.
    """

    majority: tuple[str, ...]
    odd: tuple[str, ...]
    sentence: str
    differences: Mapping[tuple[str, str], float]


def vote(
    values: Mapping[str, Array],
    allowed: float,
    difference: Callable[[Array, Array], float] | None = None,
) -> Vote:
    """Which engine is the odd one out.

    values: by engine; allowed: largest difference that counts as agreement; difference: of two values, by default the
    largest relative one over states (first axis). A value that is not finite agrees with nothing.
    """
    measure = difference or (lambda a, b: float(relative(a, b).max()))
    names = tuple(values)
    apart = {pair: measure(values[pair[0]], values[pair[1]]) for pair in combinations(names, 2)}

    def together(group: tuple[str, ...]) -> bool:
        # `<=` rather than `not >`: nan agrees with nothing.
        return all(apart[pair] <= allowed for pair in combinations(group, 2))

    if together(names):
        return Vote(names, (), "all agree", apart)
    if len(names) == 2:
        return Vote((), (), "two engines disagree; a third one would tell which is the odd one out", apart)
    for size in range(len(names) - 1, len(names) // 2, -1):
        groups = [group for group in combinations(names, size) if together(group)]
        # Two groups that overlap mean that agreement is not transitive here: nobody is clearly alone.
        if len(groups) == 1:
            odd = tuple(name for name in names if name not in groups[0])
            word = "odd one out" if len(odd) == 1 else "odd ones out"
            worst = min(value for pair, value in ((p, apart[p]) for p in apart) if (pair[0] in odd) != (pair[1] in odd))
            sentence = f"{word}: {' and '.join(odd)} ({' and '.join(groups[0])} agree, at least {worst:.1e} away)"
            return Vote(groups[0], odd, sentence, apart)
        if groups:
            break
    closest = min(apart, key=lambda pair: np.inf if np.isnan(apart[pair]) else apart[pair])
    return Vote((), (), f"no majority agrees; the closest are {closest[0]} and {closest[1]}", apart)
