"""Numbers side by side against numpy, bit for bit, in both precisions."""

import operator
from fractions import Fraction

import numpy as np
import pytest

from fmu_src.lanes import lowest, of, peek, poke, whole
from orbital.kernel import kernel

REALS = {"double": np.float64, "single": np.float32}
BITS = {"double": np.uint64, "single": np.uint32}
WIDTH = {"double": 4, "single": 8}


@pytest.fixture(params=["double", "single"])
def precision(request):
    return request.param


def numbers(precision, count, seed=1):
    """Numbers of every size, with zeros of both signs, the smallest and the largest, infinity and not a number."""
    kind = REALS[precision]
    info = np.finfo(kind)
    rng = np.random.default_rng(seed)
    found = (rng.standard_normal(count) * 10.0 ** rng.integers(-12, 12, count)).astype(kind)
    special = [0.0, -0.0, 1.0, -1.0, info.max, -info.max, info.tiny, info.smallest_subnormal, np.inf, -np.inf, np.nan]
    places = rng.choice(count, len(special), replace=False)
    found[places] = np.array(special, dtype=kind)
    return found


def memory_of(values):
    """The same numbers in an array of doubles, as a model has its work memory."""
    return np.concatenate([values, np.zeros(-len(values) % 2, values.dtype)]).view(np.float64).copy()


def assert_same_bits(found, expected):
    assert found.dtype == expected.dtype
    nan = np.isnan(expected)
    np.testing.assert_array_equal(np.isnan(found), nan)
    kind = BITS["double" if found.dtype == np.float64 else "single"]
    np.testing.assert_array_equal(found[~nan].view(kind), expected[~nan].view(kind))


def test_width_is_of_32_bytes(precision):
    assert of(precision).width == WIDTH[precision] == 32 // np.dtype(REALS[precision]).itemsize


@pytest.mark.parametrize("offset", range(9))
def test_load_and_store_at_any_place(precision, offset):
    lanes = of(precision)
    load, store, reals = lanes.load, lanes.store, lanes.reals

    @kernel
    def copy(source, target, i, j):
        store(reals(target), j, load(reals(source), i))

    values = numbers(precision, 32)
    source, target = memory_of(values), memory_of(np.full(32, 7.0, REALS[precision]))
    copy(source, target, offset, 11 - offset)
    expected = np.full(32, 7.0, REALS[precision])
    expected[11 - offset : 11 - offset + lanes.width] = values[offset : offset + lanes.width]
    assert_same_bits(target.view(REALS[precision]), expected)
    assert_same_bits(source.view(REALS[precision]), values)


def binary(precision, function):
    """Every pair of numbers, a vector at a time, by the kernel."""
    lanes = of(precision)
    load, store, reals, width = lanes.load, lanes.store, lanes.reals, lanes.width

    @kernel
    def run(a, b, out, count):
        for i in range(0, count, width):
            store(reals(out), i, function(load(reals(a), i), load(reals(b), i)))

    grid = numbers(precision, 32)
    a, b = np.repeat(grid, 32), np.tile(grid, 32)
    out = np.zeros_like(memory_of(a))
    run(memory_of(a), memory_of(b), out, len(a))
    return a, b, out.view(REALS[precision])


@pytest.mark.parametrize("name", ["add", "sub", "mul", "truediv"])
def test_operators_are_those_of_numpy(precision, name):
    function = getattr(operator, name)
    a, b, found = binary(precision, function)
    with np.errstate(all="ignore"):
        assert_same_bits(found, function(a, b))


def test_product_and_sum_are_rounded_one_by_one(precision):
    """A fused multiply and add would keep the product's last bits: exact fractions say that it shows here."""

    one = REALS[precision](1.0)
    tail = np.finfo(REALS[precision]).eps
    lanes = of(precision)
    load, store, reals = lanes.load, lanes.store, lanes.reals

    @kernel
    def run(a, b, c, out):
        store(reals(out), 0, load(reals(a), 0) * load(reals(b), 0) + load(reals(c), 0))

    a = np.full(lanes.width, one + tail)
    b = np.full(lanes.width, one - tail)
    c = np.full(lanes.width, -one)
    out = np.zeros(4)
    run(memory_of(a), memory_of(b), memory_of(c), out)
    assert Fraction(float(a[0])) * Fraction(float(b[0])) + Fraction(float(c[0])) == -(Fraction(float(tail)) ** 2) != 0
    assert_same_bits(out.view(REALS[precision]), a * b + c)
    assert not out.any()


@pytest.mark.parametrize("name", ["lt", "le", "gt"])
def test_comparisons_choose_and_tell_their_bits(precision, name):
    function = getattr(operator, name)
    lanes = of(precision)
    load, store, reals, width = lanes.load, lanes.store, lanes.reals, lanes.width
    where, bits, flags = lanes.where, lanes.bits, lanes.flags

    @kernel
    def run(a, b, chosen, again, told, count):
        for i in range(0, count, width):
            x = load(reals(a), i)
            y = load(reals(b), i)
            which = function(x, y)
            store(reals(chosen), i, where(which, x, y))
            told[i // width] = bits(which)
            store(reals(again), i, where(flags(told[i // width]), x, y))

    grid = numbers(precision, 32, 2)
    a, b = np.repeat(grid, 32), np.tile(grid, 32)
    chosen, again = np.zeros_like(memory_of(a)), np.zeros_like(memory_of(a))
    told = np.zeros(len(a) // width, dtype=np.uint64)
    run(memory_of(a), memory_of(b), chosen, again, told, len(a))
    with np.errstate(invalid="ignore"):
        which = function(a, b)
    assert_same_bits(chosen.view(REALS[precision]), np.where(which, a, b))
    assert_same_bits(again.view(REALS[precision]), np.where(which, a, b))
    weights = np.uint64(1) << np.arange(width, dtype=np.uint64)
    np.testing.assert_array_equal(told, (which.reshape(-1, width) * weights).sum(axis=1, dtype=np.uint64))
    assert 0 < which.sum() < len(a)


def test_flags_of_both(precision):
    lanes = of(precision)
    bits, flags = lanes.bits, lanes.flags

    @kernel
    def both(a, b):
        return bits(flags(a) & flags(b))

    full = (1 << lanes.width) - 1
    for a in range(full + 1):
        assert both(np.uint64(a), np.uint64(0b10110101)) == a & 0b10110101 & full
    # what is above the lanes is not looked at
    assert both(np.uint64(1 << 40 | 3), np.uint64(1 << 40 | 1)) == 1


def test_root_is_correctly_rounded(precision):
    lanes = of(precision)
    load, store, reals, root, width = lanes.load, lanes.store, lanes.reals, lanes.root, lanes.width

    @kernel
    def run(a, out, count):
        for i in range(0, count, width):
            store(reals(out), i, root(load(reals(a), i)))

    values = numbers(precision, 1024)
    out = np.zeros_like(memory_of(values))
    run(memory_of(values), out, len(values))
    with np.errstate(invalid="ignore"):
        assert_same_bits(out.view(REALS[precision]), np.sqrt(values))


def test_splat_ramp_and_lane(precision):
    lanes = of(precision)
    store, reals, splat, ramp, lane, width = (
        lanes.store,
        lanes.reals,
        lanes.splat,
        lanes.ramp,
        lanes.lane,
        lanes.width,
    )

    @kernel
    def run(x, out, told):
        store(reals(out), 0, splat(x))
        store(reals(out), width, ramp())
        for i in range(width):
            told[i] = lane(splat(x) + ramp(), i)

    value = 0.1
    out, told = np.zeros(16), np.zeros(width)
    run(value, out, told)
    kind = REALS[precision]
    found = out.view(kind)
    assert_same_bits(found[:width], np.full(width, value, dtype=kind))
    assert_same_bits(found[width : 2 * width], np.arange(width, dtype=kind))
    assert not found[2 * width :].any()
    # a lane comes back as a double, and exactly
    np.testing.assert_array_equal(told, (kind(value) + np.arange(width, dtype=kind)).astype(np.float64))
    assert (told[0] == value) == (precision == "double")


def test_lowest_bit():
    @kernel
    def run(bits):
        return lowest(bits)

    for low in range(64):
        for above in (0, 1 << 63, (1 << 64) - (1 << low)):
            assert run(np.uint64(1 << low | (above >> low << low))) == low


def test_views_share_the_memory(precision):
    """Reals and whole numbers of the same doubles, where numpy's views have them, and as many."""
    reals = of(precision).reals

    @kernel
    def run(memory, counts):
        counts[0] = reals(memory).size
        counts[1] = whole(memory).size
        reals(memory)[3] = 2.5
        whole(memory)[5] = -7
        part = reals(memory)[reals(memory).size - 2 :]
        part[1] = 9.0

    memory, counts = np.zeros(8), np.zeros(2, dtype=np.int64)
    run(memory, counts)
    kind = REALS[precision]
    expected = np.zeros(8)
    expected.view(kind)[3] = 2.5
    expected.view(np.int64)[5] = -7
    expected.view(kind)[-1] = 9.0
    assert counts.tolist() == [16 if precision == "single" else 8, 8]
    np.testing.assert_array_equal(memory.view(np.uint64), expected.view(np.uint64))


@pytest.mark.parametrize("access", ["load", "store", "peek", "poke"])
def test_under_numbas_bounds_check_nothing_beyond_the_array_is_touched(precision, access, monkeypatch):
    """The first and the last place are allowed, one further at either end is an IndexError."""
    monkeypatch.setattr("numba.core.config.BOUNDSCHECK", 1)
    lanes = of(precision)
    reals, load, store, splat, lane = lanes.reals, lanes.load, lanes.store, lanes.splat, lanes.lane

    @kernel
    def loads(memory, i):
        return lane(load(reals(memory), i), 0)

    @kernel
    def stores(memory, i):
        store(reals(memory), i, splat(2.5))

    @kernel
    def peeks(memory, i):
        return peek(reals(memory), i)

    @kernel
    def pokes(memory, i):
        poke(reals(memory), i, 2.5)

    run = {"load": loads, "store": stores, "peek": peeks, "poke": pokes}[access]
    whole_memory = np.zeros(24)
    memory = whole_memory[8:16]
    last = 64 // np.dtype(REALS[precision]).itemsize - (lanes.width if access in ("load", "store") else 1)
    run(memory, 0)
    run(memory, last)
    for i in (-1, last + 1):
        with pytest.raises(IndexError):
            run(memory, i)
    assert not whole_memory[:8].any()
    assert not whole_memory[16:].any()


def test_slide_moves_the_lanes_on_by_one(precision):
    """The last of the vector before comes first."""
    lanes = of(precision)
    reals, load, store, slide, width = lanes.reals, lanes.load, lanes.store, lanes.slide, lanes.width

    @kernel
    def run(memory, out):
        a = load(reals(memory), width)
        store(reals(out), 0, slide(a, load(reals(memory), 0)))

    values = numbers(precision, 32)[: 2 * width]
    out = np.zeros(8)
    run(memory_of(values), out)
    assert_same_bits(out.view(REALS[precision])[:width], values[width - 1 : 2 * width - 1])
