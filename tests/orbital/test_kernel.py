"""Kernels linked from parts: what is computed, what is compiled, and what is refused."""

import numpy as np
import pytest

from orbital.kernel import entry, kernel, view

pytestmark = pytest.mark.usefixtures("compiled")
RECORD = np.dtype([("x", "f8"), ("n", "i8")])


@kernel
def square(x):
    return x * x


@kernel
def shared(x):
    """Called from two others, and with `max`, of which numba makes a function of its own."""
    return square(max(x, 2.0)) + 1.0


@kernel
def left(x):
    return 2.0 * shared(x) + square(x)


@kernel
def right(x):
    return shared(x) - min(x, 1.0)


@view
def tail(work):
    return work[1:]


def make_entry():
    @entry(RECORD)
    def model_entry(command, records, work, time, step):
        p = records[0]
        p.x = left(p.x) + right(time)
        tail(work)[0] = step
        return command + p.n

    return model_entry


def expected(x, time):
    shared_x, shared_time = max(x, 2.0) ** 2 + 1.0, max(time, 2.0) ** 2 + 1.0
    return 2.0 * shared_x + x * x + shared_time - min(time, 1.0)


def test_an_entry_runs_all_that_is_below_it():
    records, work = np.zeros(1, RECORD), np.zeros(2)
    records[0] = (3.0, 4)
    assert make_entry()(7, records, work, 0.5, 0.25) == 11
    assert records["x"][0] == expected(3.0, 0.5)
    assert work.tolist() == [0.0, 0.25]


def test_an_entry_takes_nothing_but_its_signature():
    with pytest.raises(TypeError):
        make_entry()(7, np.zeros(1, RECORD), np.zeros(2, np.float32), 0.5, 0.25)


def test_kernels_below_are_lowered_once_and_never_made_into_machine_code():
    made = make_entry()
    made(7, np.zeros(1, RECORD), np.zeros(2), 0.5, 0.25)
    assert not right.dispatcher.overloads
    (part,) = shared._part.overloads.values()
    assert not hasattr(part.library, "get_pointer_to_function")
    lines = [line for line in part.library.get_llvm_str().splitlines() if line.startswith("define")]
    assert sum("define internal" not in line for line in lines) == 1, "neither what it calls nor a wrapper for Python"
    (whole,) = made.dispatcher.overloads.values()
    assert hasattr(whole.library, "get_pointer_to_function")


def test_the_text_of_an_entry_is_whole():
    """Every function but the C library's is defined in it, and the entry's is the one named."""
    name, text = make_entry().module_text()
    defined = {line.split("@")[1].split("(")[0].strip('"') for line in text.splitlines() if line.startswith("define")}
    declared = {line.split("@")[1].split("(")[0].strip('"') for line in text.splitlines() if line.startswith("declare")}
    assert name in defined
    assert not any(function.startswith("_Z") for function in declared)


def test_a_part_is_not_called_from_python():
    make_entry()(7, np.zeros(1, RECORD), np.zeros(2), 0.5, 0.25)
    with pytest.raises(MemoryError):
        shared._part(3.0)
    assert shared(3.0) == 10.0


@kernel
def chosen(x, which, doubled):
    return (2.0 if doubled else 1.0) * (x if which == 0 else float(which))


def make_choosing():
    @entry(RECORD)
    def model_entry(command, records, work, time, step):
        work[0] = chosen(time, 0, False)
        work[1] = chosen(time, 3, True)
        work[2] = chosen(time, command, True)
        return 0

    return model_entry


def test_a_part_is_compiled_once_whatever_values_are_known_where_it_is_called():
    work = np.zeros(3)
    make_choosing()(5, np.zeros(1, RECORD), work, 0.25, 0.0)
    assert work.tolist() == [0.25, 6.0, 10.0]
    ((_, which, doubled),) = chosen._part.overloads
    assert (str(which), str(doubled)) == ("int64", "bool")


@kernel
def of_all_kinds(n, x):
    """The same operators for integers and doubles, and for values known in advance."""
    return float(n // 3 + 7 % 3 + n * 2) + (x // 3.0 + 7.0 % 3.0 + x * 2) + n / 2 + abs(n) + abs(x)


def test_an_operator_gives_each_kind_of_number_its_own():
    for kinds in ((8, 8.5), (8.5, 8), (-8, -8.5)):
        assert of_all_kinds(*kinds) == of_all_kinds.py_func(*kinds)
