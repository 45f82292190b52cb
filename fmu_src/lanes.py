"""Several numbers side by side in a kernel: a value type for numba that becomes one vector instruction each.

    lanes = of("double")
    d = lanes.load(memory, b) - lanes.load(memory, a)
    taut = lanes.bits(d * d > lanes.splat(squared))

`+ - * /` and `< <= >` work lane by lane, and so do the functions below. What is written is what is computed: nothing is
reassociated, fused or approximated, so the bits are those of the same sums and products taken one by one, on every
processor; a vector wider than the machine's becomes several. Loads and stores want no alignment, but stores that cross
32 bytes take twice as long. With NUMBA_BOUNDSCHECK=1 in the environment they are held to the array, like numba's own
indexing: IndexError.

Checked  tests/net_capture/test_lanes.py
"""

from __future__ import annotations

import operator
from functools import cache
from typing import Any, NamedTuple

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, models, register_model

BYTES = 32
"""Of one vector: four doubles or eight singles."""
REALS = {"double": (types.float64, ir.DoubleType(), "f64", 4), "single": (types.float32, ir.FloatType(), "f32", 8)}


class LanesType(types.Type):
    """Numbers of one precision side by side."""

    def __init__(self, precision: str) -> None:
        self.precision = precision
        super().__init__(f"lanes({precision})")


class FlagsType(types.Type):
    """Truth values side by side, for numbers of one precision."""

    def __init__(self, precision: str) -> None:
        self.precision = precision
        super().__init__(f"flags({precision})")


def _vector(precision: str) -> ir.VectorType:
    _, element, _, width = REALS[precision]
    return ir.VectorType(element, width)


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: LanesType) -> None:
        super().__init__(manager, kind, _vector(kind.precision))


@register_model(FlagsType)
class _FlagsModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: FlagsType) -> None:
        super().__init__(manager, kind, ir.VectorType(ir.IntType(1), REALS[kind.precision][3]))


def _operator(function: Any, operand: Any, result: Any, emit: Any) -> None:
    """Teach numba an operator of two values of a lanes type."""

    @infer_global(function)
    class _Template(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            if len(args) == 2 and isinstance(args[0], operand) and args[0] == args[1]:
                return signature(result(args[0].precision), *args)
            return None

    @lower_builtin(function, operand, operand)
    def _lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return emit(builder, *args)


for _function, _name in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    _operator(_function, LanesType, LanesType, lambda b, x, y, name=_name: getattr(b, name)(x, y))
for _function, _sign in ((operator.lt, "<"), (operator.le, "<="), (operator.gt, ">")):
    _operator(_function, LanesType, FlagsType, lambda b, x, y, sign=_sign: b.fcmp_ordered(sign, x, y))
_operator(operator.and_, FlagsType, FlagsType, lambda b, x, y: b.and_(x, y))


class Lanes(NamedTuple):
    """The functions of one precision.

    width               numbers in a vector [1]
    reals(memory)       the doubles' memory as an array of this precision; only to be used where it was called
    load(reals, i)      numbers i, i + 1, ... of an array
    store(reals, i, x)  write them there
    splat(x)            a number in every lane
    ramp()              0, 1, 2, ...
    where(flags, x, y)  x where true, otherwise y
    root(x)             square root
    slide(x, y)         the last of y, then all but the last of x
    bits(flags)         bit i is lane i, as uint64
    flags(bits)         lane i is bit i
    lane(x, i)          one of them, as float64
    """

    width: int
    reals: Any
    load: Any
    store: Any
    splat: Any
    ramp: Any
    where: Any
    root: Any
    slide: Any
    bits: Any
    flags: Any
    lane: Any


def _element(context: Any, builder: Any, array_type: Any, array: Any, index: Any, count: int = 1) -> Any:
    """Pointer to the first of `count` elements."""
    made = context.make_array(array_type)(context, builder, array)
    if context.enable_boundscheck:
        for i in (0, count - 1):
            cgutils.do_boundscheck(context, builder, builder.add(index, index.type(i)), made.nitems)
    return builder.gep(made.data, [index])


def _vector_at(context: Any, builder: Any, sig: Any, args: Any, precision: str) -> Any:
    first = _element(context, builder, sig.args[0], args[0], args[1], REALS[precision][3])
    return builder.bitcast(first, _vector(precision).as_pointer())


@cache
def of(precision: str) -> Lanes:
    """Lanes of "double" or "single" precision."""
    real, element, suffix, width = REALS[precision]
    vector, lanes, flags = _vector(precision), LanesType(precision), FlagsType(precision)
    size = BYTES // width

    @intrinsic
    def load(context: Any, reals: Any, index: Any) -> Any:
        def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return builder.load(_vector_at(context, builder, sig, args, precision), align=size)

        return lanes(reals, types.int64), emit

    @intrinsic
    def store(context: Any, reals: Any, index: Any, value: Any) -> Any:
        def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            builder.store(args[2], _vector_at(context, builder, sig, args, precision), align=size)
            return context.get_dummy_value()

        return types.void(reals, types.int64, lanes), emit

    @intrinsic
    def splat(context: Any, value: Any) -> Any:
        def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            number = args[0] if precision == "double" else builder.fptrunc(args[0], element)
            first = builder.insert_element(ir.Constant(vector, ir.Undefined), number, ir.Constant(ir.IntType(32), 0))
            places = ir.Constant(ir.VectorType(ir.IntType(32), width), [0] * width)
            return builder.shuffle_vector(first, ir.Constant(vector, ir.Undefined), places)

        return lanes(types.float64), emit

    @intrinsic
    def ramp(context: Any) -> Any:
        def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return ir.Constant(vector, [float(i) for i in range(width)])

        return lanes(), emit

    @intrinsic
    def where(context: Any, condition: Any, yes: Any, no: Any) -> Any:
        def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return builder.select(*args)

        return lanes(flags, lanes, lanes), emit

    @intrinsic
    def root(context: Any, value: Any) -> Any:
        def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            kind = ir.FunctionType(vector, [vector])
            function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.sqrt.v{width}{suffix}")
            return builder.call(function, args)

        return lanes(lanes), emit

    @intrinsic
    def slide(context: Any, value: Any, before: Any) -> Any:
        def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            places = [2 * width - 1, *range(width - 1)]
            return builder.shuffle_vector(args[0], args[1], ir.Constant(ir.VectorType(ir.IntType(32), width), places))

        return lanes(lanes, lanes), emit

    @intrinsic
    def bits(context: Any, value: Any) -> Any:
        def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return builder.zext(builder.bitcast(args[0], ir.IntType(width)), ir.IntType(64))

        return types.uint64(flags), emit

    @intrinsic
    def flags_of(context: Any, value: Any) -> Any:
        def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            # one bit kept in each lane, as wide as its number: cheaper for a processor than bits strewn over lanes
            whole = ir.IntType(256 // width)
            place, word = ir.IntType(32), ir.VectorType(whole, width)
            unknown = ir.Constant(word, ir.Undefined)
            first = builder.insert_element(unknown, builder.trunc(args[0], whole), ir.Constant(place, 0))
            spread = builder.shuffle_vector(first, unknown, ir.Constant(ir.VectorType(place, width), [0] * width))
            kept = builder.and_(spread, ir.Constant(word, [1 << i for i in range(width)]))
            return builder.icmp_unsigned("!=", kept, ir.Constant(word, [0] * width))

        return flags(types.uint64), emit

    @intrinsic
    def lane(context: Any, value: Any, index: Any) -> Any:
        def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            number = builder.extract_element(args[0], builder.trunc(args[1], ir.IntType(32)))
            return number if precision == "double" else builder.fpext(number, ir.DoubleType())

        return types.float64(lanes, types.int64), emit

    return Lanes(width, _viewed_as(real), load, store, splat, ramp, where, root, slide, bits, flags_of, lane)


def _viewed_as(kind: Any) -> Any:
    """Intrinsic `(memory) -> array`: an array of doubles as one of numbers of another kind."""
    per_double = 8 // (kind.bitwidth // 8)

    @intrinsic
    def viewed(context: Any, memory: Any) -> Any:
        result = types.Array(kind, 1, "C")

        def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            given = context.make_array(sig.args[0])(context, builder, args[0])
            array = context.make_array(result)(context, builder)
            count = builder.mul(given.nitems, ir.Constant(given.nitems.type, per_double))
            size = ir.Constant(given.nitems.type, 8 // per_double)
            data = builder.bitcast(given.data, array.data.type)
            context.populate_array(
                array, data=data, shape=[count], strides=[size], itemsize=size, meminfo=None, parent=None
            )
            return array._getvalue()

        return result(memory), emit

    return viewed


whole = _viewed_as(types.int64)
"""`whole(memory)`: an array of doubles as one of 64-bit whole numbers, for counts and numbers of nodes."""


@intrinsic
def lowest(context: Any, bits: Any) -> Any:
    """Number of the lowest bit that is set; undefined for none."""

    def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.cttz(args[0], ir.Constant(ir.IntType(1), 1))

    return types.uint64(types.uint64), emit


@intrinsic
def highest(context: Any, bits: Any) -> Any:
    """Number of the highest bit that is set; undefined for none."""

    def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        zeros = builder.ctlz(args[0], ir.Constant(ir.IntType(1), 1))
        return builder.sub(ir.Constant(ir.IntType(64), 63), zeros)

    return types.uint64(types.uint64), emit


@intrinsic
def population(context: Any, bits: Any) -> Any:
    """How many bits are set."""

    def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.ctpop(args[0])

    return types.int64(types.uint64), emit


@intrinsic
def peek(context: Any, array: Any, index: Any) -> Any:
    """One element, without the test for an index that counts from the end: in a loop it costs as much as the load."""

    def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.load(_element(context, builder, sig.args[0], *args))

    return array.dtype(array, types.int64), emit


@intrinsic
def poke(context: Any, array: Any, index: Any, value: Any) -> Any:
    """Write one element, see `peek`."""

    def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.store(args[2], _element(context, builder, sig.args[0], *args[:2]))
        return context.get_dummy_value()

    return types.void(array, types.int64, array.dtype), emit
