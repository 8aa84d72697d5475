"""What numba is made to remember of operators is what it would find if it were asked again."""

from __future__ import annotations

import operator

import pytest
from numba import types
from numba.core.errors import TypingError
from numba.core.registry import cpu_target
from numba.core.types.functions import BaseFunction

from harness.denoc.compiling.known_types import remember
from harness.denoc.simd.vector import lane_vector

PAIRS = [
    (types.float64, types.float64),
    (types.int64, types.float64),
    (lane_vector, types.float64),
    (lane_vector, lane_vector),
]


def test_this_numba_lets_itself_be_taught() -> None:
    assert remember()


@pytest.mark.parametrize("operation", [operator.add, operator.mul, operator.truediv])
@pytest.mark.parametrize("pair", PAIRS)
def test_remembered_signatures_are_those_found_afresh(operation: object, pair: tuple[types.Type, types.Type]) -> None:
    remember()
    context = cpu_target.typing_context
    context.refresh()
    function = context.resolve_value_type(operation)
    first = function.get_call_type(context, pair, {})
    again = function.get_call_type(context, pair, {})
    afresh = BaseFunction.get_call_type.__wrapped__(function, context, pair, {})
    assert first == again == afresh


def test_types_that_do_not_fit_are_refused_every_time() -> None:
    remember()
    context = cpu_target.typing_context
    context.refresh()
    function = context.resolve_value_type(operator.add)
    for _ in range(2):
        with pytest.raises(TypingError):
            function.get_call_type(context, (lane_vector, types.unicode_type), {})
