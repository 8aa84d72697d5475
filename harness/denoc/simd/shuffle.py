"""Lane vectors whose lanes are neighbours, such as the bodies of a chain: lanes moved, summed up along the vector, copied to all.

Outward is from lane 7 to lane 0, inward from lane 0 to lane 7. Tuples of vectors are treated one vector like the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from harness.denoc.simd.vector import LANES, lane_vector

_INDEX = ir.IntType(32)
_NOTHING = ir.Constant(ir.VectorType(ir.DoubleType(), LANES), [0.0] * LANES)
_DOUBLINGS = (1, 2, 4)


def _shuffled(builder: Any, first: Any, second: Any, lanes: Sequence[int]) -> Any:
    """A vector of lanes of two others, those of the second counted on from the first's."""
    return builder.shuffle_vector(first, second, ir.Constant(ir.VectorType(_INDEX, LANES), list(lanes)))


def _outward(by: int) -> list[int]:
    return [k + by for k in range(LANES)]


def _inward(by: int) -> list[int]:
    return [k - by if k >= by else LANES + k for k in range(LANES)]


def _of_each(context: Any, builder: Any, kind: Any, values: Any, change: Any) -> Any:
    """A tuple of vectors with each of them changed."""
    parts = [change(k, builder.extract_value(values, k)) for k in range(kind.count)]
    return context.make_tuple(builder, kind, parts)


def _moved_outward_code(typingctx: Any, values: Any, behind: Any, by: Any) -> Any:
    """Every lane gets what stood ``by`` (a constant) lanes further in; the last ones get the first lanes of ``behind``."""
    if not isinstance(by, types.IntegerLiteral):
        return None
    lanes = _outward(by.literal_value)

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        if not isinstance(values, types.UniTuple):
            return _shuffled(builder, args[0], args[1], lanes)
        fill = [builder.extract_value(args[1], k) for k in range(values.count)]
        return _of_each(context, builder, values, args[0], lambda k, v: _shuffled(builder, v, fill[k], lanes))

    return values(values, behind, by), codegen


moved_outward: Any = intrinsic(_moved_outward_code)


def _running_sum(lanes: Any) -> Any:
    def typed(typingctx: Any, values: Any) -> Any:
        def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            def summed(k: int, vector: Any) -> Any:
                for by in _DOUBLINGS:
                    moved = _shuffled(builder, vector, _NOTHING, lanes(by))
                    vector = builder.fadd(vector, moved, flags=("contract",))
                return vector

            return _of_each(context, builder, values, args[0], summed)

        return values(values), codegen

    return intrinsic(typed)


summed_outward: Any = _running_sum(_outward)
"""Every lane with the sum of itself and all lanes further in, of a tuple of vectors."""
summed_inward: Any = _running_sum(_inward)
"""Every lane with the sum of itself and all lanes further out, of a tuple of vectors."""


def _spread_lane_code(typingctx: Any, values: Any, lane: Any) -> Any:
    """One lane (a constant) in every lane, of a vector or of each of a tuple."""
    if not isinstance(lane, types.IntegerLiteral):
        return None
    lanes = [lane.literal_value] * LANES

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        if not isinstance(values, types.UniTuple):
            return _shuffled(builder, args[0], args[0], lanes)
        return _of_each(context, builder, values, args[0], lambda k, v: _shuffled(builder, v, v, lanes))

    return values(values, lane), codegen


spread_lane: Any = intrinsic(_spread_lane_code)

# Pairs of lanes, of two vectors in turn; then which pairs of lanes, the even and the odd ones.
_LEFT, _RIGHT = [0, 8, 2, 10, 4, 12, 6, 14], [1, 9, 3, 11, 5, 13, 7, 15]
_EVEN, _ODD = [0, 1, 4, 5, 8, 9, 12, 13], [2, 3, 6, 7, 10, 11, 14, 15]


def _transpose(builder: Any, rows: Sequence[Any]) -> list[Any]:
    """The columns of eight vectors, by 24 moves of which each takes lanes of two vectors."""
    pairs = [[_shuffled(builder, rows[k], rows[k + 1], side) for k in (0, 2, 4, 6)] for side in (_LEFT, _RIGHT)]
    columns: list[Any] = [None] * LANES
    for right, (first, second, third, fourth) in enumerate(pairs):
        for odd, chosen in enumerate((_EVEN, _ODD)):
            upper, lower = _shuffled(builder, first, second, chosen), _shuffled(builder, third, fourth, chosen)
            for far, ends in enumerate((_EVEN, _ODD)):
                columns[right + 2 * odd + 4 * far] = _shuffled(builder, upper, lower, ends)
    return columns


def _transposed_code(typingctx: Any, values: Any) -> Any:
    """Eight vectors as a matrix, transposed: lane k of vector i becomes lane i of vector k."""
    if values != types.UniTuple(lane_vector, LANES):
        return None

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        rows = [builder.extract_value(args[0], k) for k in range(LANES)]
        return context.make_tuple(builder, values, _transpose(builder, rows))

    return values(values), codegen


transposed: Any = intrinsic(_transposed_code)


def _mirrored_code(typingctx: Any, rows: Any, columns: Any, diagonal: Any) -> Any:
    """A symmetric matrix of eight vectors: below the diagonal from ``rows``, above it from their transpose ``columns``."""
    if rows != types.UniTuple(lane_vector, LANES):
        return None

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        def row(k: int, vector: Any) -> Any:
            column = builder.extract_value(args[1], k)
            both = _shuffled(builder, vector, column, [j if j < k else LANES + j for j in range(LANES)])
            return _shuffled(builder, both, args[2], [LANES + j if j == k else j for j in range(LANES)])

        return _of_each(context, builder, rows, args[0], row)

    return rows(rows, rows, lane_vector), codegen


mirrored: Any = intrinsic(_mirrored_code)


def _store_rows_code(typingctx: Any, array: Any, index: Any, stride: Any, values: Any) -> Any:
    """Write a tuple of vectors to a one-dimensional array, the first from an index on, each ``stride`` behind the one before."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        place = builder.gep(context.make_array(sig.args[0])(context, builder, args[0]).data, [args[1]])
        for k in range(values.count):
            value = builder.extract_value(args[3], k)
            builder.store(value, builder.bitcast(place, value.type.as_pointer()), align=8)
            place = builder.gep(place, [args[2]])
        return context.get_dummy_value()

    return types.void(array, index, stride, values), codegen


store_rows: Any = intrinsic(_store_rows_code)


def _scatter_pairs_code(typingctx: Any, array: Any, index: Any, stride: Any, first: Any, second: Any) -> Any:
    """Write eight pairs of numbers to a one-dimensional array, lane by lane of two vectors, ``stride`` apart from an index on."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        place = builder.gep(context.make_array(sig.args[0])(context, builder, args[0]).data, [args[1]])
        sides = [_shuffled(builder, args[3], args[4], lanes) for lanes in (_LEFT, _RIGHT)]
        for lane in range(LANES):
            chosen = ir.Constant(ir.VectorType(_INDEX, 2), [lane // 2 * 2, lane // 2 * 2 + 1])
            pair = builder.shuffle_vector(sides[lane % 2], sides[lane % 2], chosen)
            builder.store(pair, builder.bitcast(place, pair.type.as_pointer()), align=8)
            place = builder.gep(place, [args[2]])
        return context.get_dummy_value()

    return types.void(array, index, stride, lane_vector, lane_vector), codegen


scatter_pairs: Any = intrinsic(_scatter_pairs_code)


def _first_lane_code(typingctx: Any, value: Any) -> Any:
    """The number in lane 0."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.extract_element(args[0], ir.Constant(_INDEX, 0))

    return types.float64(lane_vector), codegen


first_lane: Any = intrinsic(_first_lane_code)
