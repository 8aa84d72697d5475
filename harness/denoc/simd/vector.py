"""Eight lanes as one number: a numba type whose arithmetic is LLVM vector arithmetic.

A kernel is written once, as plain formulas. Called with ``float`` operands it is scalar code; called with what
``load`` returns, every operation acts on eight independent copies at once, whatever the loop vectoriser thinks of
the kernel's aliasing. LLVM splits the vectors into what the processor has (one AVX-512 register, two AVX2 registers,
four SSE or NEON registers). Lanes never mix: the result of a lane does not depend on its neighbours, bit by bit.

Multiply and add may be fused (``contract``); nothing is reordered.
"""

from __future__ import annotations

import math
import operator
from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.core.datamodel import PrimitiveModel
from numba.core.extending import intrinsic, overload, register_model
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numpy.typing import NDArray

from harness.denoc.compiling.known_types import remember
from harness.denoc.compiling.pipeline import Kernel, Part, ShortLoops

remember()

LANES = 8
"""Copies advanced together, L."""

_VECTOR = ir.VectorType(ir.DoubleType(), LANES)
_INTEGERS = ir.VectorType(ir.IntType(64), LANES)


# Kernels that only kernels call, and never from Python; the second kind is always put in place of its call.
_ONLY_KERNELS: Any = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "pipeline_class": Part}
inner: Any = njit(error_model="numpy", _nrt=False, **_ONLY_KERNELS)
in_place: Any = njit(error_model="numpy", _nrt=False, forceinline=True, **_ONLY_KERNELS)
# As ``inner``, for what makes arrays.
allocating: Any = njit(error_model="numpy", **_ONLY_KERNELS)
# Kernels that are called from Python, by several threads at once. Those that step in time have only loops too short to unroll;
# those of batches make no arrays.
ENTRY: Any = {"cache": True, "error_model": "numpy", "no_cfunc_wrapper": True, "nogil": True}
lane_stepper: Any = njit(pipeline_class=ShortLoops, **ENTRY)
batch_kernel: Any = njit(_nrt=False, pipeline_class=Kernel, **ENTRY)


class LaneVector(types.Type):
    """Numba type of eight doubles held in registers."""

    def __init__(self) -> None:
        super().__init__(name=f"LaneVector({LANES})")


lane_vector = LaneVector()


@register_model(LaneVector)
class _LaneVectorModel(PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _VECTOR)


def _splat(builder: Any, scalar: Any) -> Any:
    """The same double in every lane."""
    single = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), scalar, ir.Constant(ir.IntType(32), 0))
    mask = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(single, ir.Constant(_VECTOR, ir.Undefined), mask)


def _as_vector(builder: Any, kind: Any, value: Any) -> Any:
    return value if isinstance(kind, LaneVector) else _splat(builder, value)


def _register(operation: Any, method: str) -> None:
    """Teach numba one arithmetic operator on lane vectors, scalars being spread over the lanes."""
    pairs = [(lane_vector, lane_vector), (lane_vector, types.float64), (types.float64, lane_vector)]

    class Template(ConcreteTemplate):
        cases = tuple(signature(lane_vector, *pair) for pair in pairs)

    infer_global(operation)(Template)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        left, right = (_as_vector(builder, kind, value) for kind, value in zip(sig.args, args, strict=True))
        return getattr(builder, method)(left, right, flags=("contract",))

    for pair in pairs:
        lower_builtin(operation, *pair)(lower)


for _operation, _method in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
    (operator.iadd, "fadd"),
    (operator.isub, "fsub"),
    (operator.imul, "fmul"),
):
    _register(_operation, _method)


@infer_global(operator.neg)
class _NegTemplate(ConcreteTemplate):
    cases = (signature(lane_vector, lane_vector),)


@lower_builtin(operator.neg, lane_vector)
def _lower_neg(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.fneg(args[0], flags=("contract",))


def _load_code(typingctx: Any, array: Any, index: Any) -> Any:
    """Eight neighbouring doubles of a one-dimensional array, from ``index`` on; the bounds are not checked."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        place = builder.gep(data, [args[1]])
        return builder.load(builder.bitcast(place, _VECTOR.as_pointer()), align=8)

    return lane_vector(array, index), codegen


load: Any = intrinsic(_load_code)


def _store_code(typingctx: Any, array: Any, index: Any, value: Any) -> Any:
    """Write eight neighbouring doubles of a one-dimensional array, from ``index`` on; the bounds are not checked."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        place = builder.gep(data, [args[1]])
        builder.store(args[2], builder.bitcast(place, _VECTOR.as_pointer()), align=8)
        return context.get_dummy_value()

    return types.void(array, index, value), codegen


store: Any = intrinsic(_store_code)


def _stream_code(typingctx: Any, array: Any, index: Any, value: Any) -> Any:
    """As ``store``, past the caches, to where a cache line begins: for what is not read again soon. ``settle`` comes last."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        place = builder.bitcast(builder.gep(data, [args[1]]), _VECTOR.as_pointer())
        past = builder.module.add_metadata([ir.Constant(ir.IntType(32), 1)])
        builder.store(args[2], place, align=8 * LANES).set_metadata("nontemporal", past)
        return context.get_dummy_value()

    return types.void(array, index, value), codegen


stream: Any = intrinsic(_stream_code)


def _settle_code(typingctx: Any) -> Any:
    """What was streamed is there for other threads, too."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.fence("seq_cst")
        return context.get_dummy_value()

    return types.void(), codegen


settle: Any = intrinsic(_settle_code)


def _spread_code(typingctx: Any, scalar: Any) -> Any:
    """The same value in every lane."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _splat(builder, args[0])

    return lane_vector(types.float64), codegen


spread: Any = intrinsic(_spread_code)


def _spread_from_code(typingctx: Any, array: Any, index: Any) -> Any:
    """One number of a one-dimensional array in every lane; the bounds are not checked, nor is an index counted from the end."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        return _splat(builder, builder.load(builder.gep(data, [args[1]])))

    return lane_vector(array, index), codegen


spread_from: Any = intrinsic(_spread_from_code)


def _unary(name: str) -> Any:
    """An intrinsic that applies the LLVM function ``name`` lane by lane."""

    def typed(typingctx: Any, value: Any) -> Any:
        def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            kind = ir.FunctionType(_VECTOR, [_VECTOR])
            function = cgutils.get_or_insert_function(builder.module, kind, f"{name}.v{LANES}f64")
            return builder.call(function, args)

        return lane_vector(lane_vector), codegen

    typed.__name__ = name.replace("llvm.", "lanes_")
    return intrinsic(typed)


_lanes_sqrt = _unary("llvm.sqrt")
_lanes_fabs = _unary("llvm.fabs")
_lanes_rint = _unary("llvm.rint")


def square_root(x: Any) -> Any:
    """√x, lane by lane."""
    return math.sqrt(x)


def magnitude(x: Any) -> Any:
    """|x|, lane by lane."""
    return abs(x)


def nearest(x: Any) -> Any:
    """The nearest whole number, ties to even, lane by lane."""
    return float(round(x))


def choose(condition: Any, positive: Any, otherwise: Any) -> Any:
    """``positive`` where ``condition`` > 0, else ``otherwise`` (also where the condition is not a number)."""
    return positive if condition > 0.0 else otherwise


def scale_by_power(x: Any, exponent: Any) -> Any:
    """x · 2^exponent for whole exponents within −1022 … 1023, lane by lane."""
    return math.ldexp(x, int(exponent))


def _lanes_choose_code(typingctx: Any, condition: Any, positive: Any, otherwise: Any) -> Any:
    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        zero = ir.Constant(_VECTOR, [0.0] * LANES)
        test = builder.fcmp_ordered(">", args[0], zero)
        left, right = (_as_vector(builder, kind, value) for kind, value in zip(sig.args[1:], args[1:], strict=True))
        return builder.select(test, left, right)

    spread_or_vector = [kind if isinstance(kind, LaneVector) else types.float64 for kind in (positive, otherwise)]
    return lane_vector(lane_vector, *spread_or_vector), codegen


_lanes_choose: Any = intrinsic(_lanes_choose_code)


def _lanes_scale_by_power_code(typingctx: Any, x: Any, exponent: Any) -> Any:
    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        whole = builder.fptosi(args[1], _INTEGERS)
        biased = builder.add(whole, ir.Constant(_INTEGERS, [1023] * LANES))
        power = builder.bitcast(builder.shl(biased, ir.Constant(_INTEGERS, [52] * LANES)), _VECTOR)
        return builder.fmul(args[0], power)

    return lane_vector(lane_vector, lane_vector), codegen


_lanes_scale_by_power: Any = intrinsic(_lanes_scale_by_power_code)


def _opposite_if_odd_code(typingctx: Any, x: Any, counted: Any) -> Any:
    """x, with its sign changed where the last bit of ``counted`` is set, of lane vectors or floats."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        many = isinstance(sig.args[0], LaneVector)
        kind = _INTEGERS if many else ir.IntType(64)
        sign = builder.shl(builder.bitcast(args[1], kind), ir.Constant(kind, [63] * LANES if many else 63))
        return builder.bitcast(builder.xor(builder.bitcast(args[0], kind), sign), args[0].type)

    return x(x, x), codegen


opposite_if_odd: Any = intrinsic(_opposite_if_odd_code)


def _scalar_rint_code(typingctx: Any, x: Any) -> Any:
    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.call(builder.module.declare_intrinsic("llvm.rint", (ir.DoubleType(),)), args)

    return types.float64(types.float64), codegen


_scalar_rint: Any = intrinsic(_scalar_rint_code)


def _call_at_code(typingctx: Any, address: Any, q: Any, qd: Any, t: Any, parameters: Any) -> Any:
    """Call the compiled law ``double (double q, double qd, double t, double *p)`` that lies at an address.

    A law is thus data: another one needs no compilation of the kernels.
    """

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        double = ir.DoubleType()
        kind = ir.FunctionType(double, [double, double, double, double.as_pointer()])
        function = builder.inttoptr(args[0], kind.as_pointer())
        pointer = builder.inttoptr(args[4], double.as_pointer())
        return builder.call(function, [args[1], args[2], args[3], pointer])

    return types.float64(types.int64, types.float64, types.float64, types.float64, types.int64), codegen


call_at: Any = intrinsic(_call_at_code)


def _address_of_code(typingctx: Any, array: Any, index: Any) -> Any:
    """Address of one element of a one-dimensional array."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        return builder.ptrtoint(builder.gep(data, [args[1]]), cgutils.intp_t)

    return types.int64(array, index), codegen


address_of: Any = intrinsic(_address_of_code)


def _pointer_code(kind: Any) -> Any:
    def typed(typingctx: Any, address: Any) -> Any:
        def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return builder.inttoptr(args[0], context.get_value_type(sig.return_type))

        return types.CPointer(kind)(types.int64), codegen

    return typed


numbers_at: Any = intrinsic(_pointer_code(types.float64))
"""Pointer to doubles at an address."""
integers_at: Any = intrinsic(_pointer_code(types.int64))
"""Pointer to integers at an address."""


def _call_recursion_code(
    typingctx: Any, recursion: Any, tree: Any, nodes: Any, flags: Any, constants: Any, beams: Any, laws: Any, ws: Any,
    n: Any, user: Any, shaken: Any, loaded: Any,
) -> Any:  # fmt: skip
    """Call the recursion that lies at an address (``lanes.address``): all arguments integers, arrays by address."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        word = ir.IntType(64)
        kind = ir.FunctionType(ir.VoidType(), [word] * 11)
        builder.call(builder.inttoptr(args[0], kind.as_pointer()), args[1:])
        return context.get_dummy_value()

    return types.void(*[types.int64] * 12), codegen


call_recursion: Any = intrinsic(_call_recursion_code)


def aligned(count: int) -> NDArray[np.float64]:
    """Room for numbers that begins where a cache line does, made in Python: a vector that lies across two costs twice as much."""
    room = np.empty(count + LANES)
    skip = -room.ctypes.data % 64 // 8
    return room[skip : skip + count]


@allocating
def vectors(count: int) -> Any:
    """Zeros for vectors of eight lanes that begin where a cache line does: one that lies across two costs twice as much."""
    room = np.zeros((count + 1) * 8)
    skip = (64 - address_of(room, 0) % 64) % 64 // 8
    return room[skip : skip + count * 8]


def _either(function: Any, on_lanes: Any, on_scalar: Any) -> None:
    """One name for kernels: the lane version for lane vectors, the scalar version for floats."""

    @overload(function, strict=False)
    def pick(x: Any) -> Any:
        if isinstance(x, LaneVector):
            return lambda x: on_lanes(x)
        if isinstance(x, types.Float):
            return lambda x: on_scalar(x)
        return None


_either(square_root, _lanes_sqrt, math.sqrt)
_either(magnitude, _lanes_fabs, abs)
_either(nearest, _lanes_rint, _scalar_rint)


@overload(choose, strict=False)
def _choose(condition: Any, positive: Any, otherwise: Any) -> Any:
    if isinstance(condition, LaneVector):
        return lambda condition, positive, otherwise: _lanes_choose(condition, positive, otherwise)
    return lambda condition, positive, otherwise: positive if condition > 0.0 else otherwise


@overload(scale_by_power, strict=False)
def _scale_by_power(x: Any, exponent: Any) -> Any:
    if isinstance(x, LaneVector):
        return lambda x, exponent: _lanes_scale_by_power(x, exponent)
    return lambda x, exponent: math.ldexp(x, int(exponent))


# π in three parts whose products with a whole number below 2²⁰ are exact (Cody and Waite's reduction), so that
# the argument keeps its absolute accuracy up to |x| of about 3e6.
_PI_1 = 3.1415926534682512
_PI_2 = 1.2154201012607932e-10
_PI_3 = 4.044532497591901e-21
_OVER_PI = 1.0 / math.pi
_WHOLE = 1.5 * 2.0**52


@in_place
def sine_cosine(x: Any) -> Any:
    """Sine and cosine of x [rad], absolute error within 4e-16 for |x| ≤ 1e4, of a lane vector or a float.

    The argument is reduced to ±π/2 by whole multiples of π; the polynomials of degree 17 and 16, of least largest error there
    (Remez), are within 5e-19 and 2.1e-17 before rounding.
    """
    # Near 1.5·2⁵² numbers are whole, and the last bit says whether they are odd.
    counted = x * _OVER_PI + _WHOLE
    turns = counted - _WHOLE
    r = ((x - turns * _PI_1) - turns * _PI_2) - turns * _PI_3
    z = r * r
    # By pairs, pairs of pairs and so on (Estrin): a third of Horner's chain of operations that wait for each other.
    z2 = z * z
    z4 = z2 * z2
    s = (
        (0.00833333333333324 * z - 0.16666666666666666) + (2.755731921269515e-06 * z - 0.00019841269841221413) * z2
    ) + (
        (1.6058943367755482e-10 * z - 2.5052106976784173e-08)
        + (2.7215412333733785e-15 * z - 7.643053594994357e-13) * z2
    ) * z4
    c = (
        (-0.0013888888888869391 * z + 0.04166666666666652) + (-2.75573178829748e-07 * z + 2.480158729393883e-05) * z2
    ) + ((-1.1464742411851547e-11 * z + 2.0876634963576137e-09) + 4.627616150785057e-14 * z2) * z4
    return opposite_if_odd(r + r * (z * s), counted), opposite_if_odd(1.0 + z * (c * z - 0.5), counted)


@in_place
def exponential(x: Any) -> Any:
    """eˣ for x ≤ 0 (below −700 taken as −700), relative error within 4e-16, of a lane vector or a float."""
    x = choose(x + 700.0, x, -700.0)
    whole = nearest(x * 1.4426950408889634)
    r = (x - whole * 0.6931471803691238) - whole * 1.9082149292705877e-10
    p = r * 1.605904383682161e-10 + 2.08767569878681e-09
    p = p * r + 2.505210838544172e-08
    p = p * r + 2.755731922398589e-07
    p = p * r + 2.7557319223985893e-06
    p = p * r + 2.48015873015873e-05
    p = p * r + 0.0001984126984126984
    p = p * r + 0.001388888888888889
    p = p * r + 0.008333333333333333
    p = p * r + 0.041666666666666664
    p = p * r + 0.16666666666666666
    p = p * r + 0.5
    return scale_by_power(1.0 + r * (1.0 + r * p), whole)


def _gather_code(typingctx: Any, array: Any, index: Any, stride: Any) -> Any:
    """Eight doubles of a one-dimensional array, ``stride`` apart from ``index`` on; the bounds are not checked."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        value = ir.Constant(_VECTOR, ir.Undefined)
        place = builder.gep(data, [args[1]])
        for lane in range(LANES):
            number = builder.load(place)
            value = builder.insert_element(value, number, ir.Constant(ir.IntType(32), lane))
            place = builder.gep(place, [args[2]])
        return value

    return lane_vector(array, index, stride), codegen


gather: Any = intrinsic(_gather_code)


def _scatter_code(typingctx: Any, array: Any, index: Any, stride: Any, value: Any) -> Any:
    """Write eight doubles of a one-dimensional array, ``stride`` apart from ``index`` on; the bounds are not checked."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        place = builder.gep(data, [args[1]])
        for lane in range(LANES):
            builder.store(builder.extract_element(args[3], ir.Constant(ir.IntType(32), lane)), place)
            place = builder.gep(place, [args[2]])
        return context.get_dummy_value()

    return types.void(array, index, stride, value), codegen


scatter: Any = intrinsic(_scatter_code)


def _load_run_code(typingctx: Any, array: Any, index: Any, count: Any) -> Any:
    """``count`` vectors (a constant) that follow each other in a one-dimensional array from ``index`` on, as a tuple."""
    if not isinstance(count, types.IntegerLiteral):
        return None
    kind = types.UniTuple(lane_vector, count.literal_value)

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        start = builder.gep(data, [args[1]])
        vectors = []
        for k in range(kind.count):
            place = builder.gep(start, [ir.Constant(ir.IntType(64), LANES * k)])
            vectors.append(builder.load(builder.bitcast(place, _VECTOR.as_pointer()), align=8))
        return context.make_tuple(builder, kind, vectors)

    return kind(array, index, count), codegen


load_run: Any = intrinsic(_load_run_code)


def _run_writer(add: bool) -> Any:
    def typed(typingctx: Any, array: Any, index: Any, values: Any) -> Any:
        if not isinstance(values, types.UniTuple):
            return None

        def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            data = context.make_array(sig.args[0])(context, builder, args[0]).data
            start = builder.gep(data, [args[1]])
            for k in range(values.count):
                place = builder.gep(start, [ir.Constant(ir.IntType(64), LANES * k)])
                place = builder.bitcast(place, _VECTOR.as_pointer())
                value = builder.extract_value(args[2], k)
                if add:
                    value = builder.fadd(builder.load(place, align=8), value, flags=("contract",))
                builder.store(value, place, align=8)
            return context.get_dummy_value()

        return types.void(array, index, values), codegen

    return typed


store_run: Any = intrinsic(_run_writer(False))
"""Write a tuple of vectors to a one-dimensional array, one after the other from an index on."""
add_run: Any = intrinsic(_run_writer(True))
"""Add a tuple of vectors to what stands in a one-dimensional array from an index on."""
