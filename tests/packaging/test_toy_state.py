"""The shim alone, on the toy: saved states, whole and damaged, and reset."""

import ctypes

import pytest

from tests.packaging.raw import DISCARD, ERROR, OK, Count

HEADER = (
    (0, "no saved state"),
    (8, "no saved state"),
    (24, "belongs to another library"),
    (72, "version"),
    (80, "phase"),
)
"""What is said of a state whose header is wrong at a byte."""


def test_a_state_carries_everything_even_to_another_instance(make):
    one = make()
    one.start({"room": 50, "end": 3.0}, stop=9.0)
    one.set({"push": 1.5, "go": True})
    one.step(0.0, 1.0)
    one.ramp("push", 1.0)
    data = one.serialise(one.save())
    one.step(1.0, 1.0)
    two = make()
    status, state = two.deserialise(data)
    assert status == OK
    assert two.restore(state) == OK
    assert two.step(1.0, 1.0) == OK
    assert two.get("x", "y", "sum", "push") == one.get("x", "y", "sum", "push")
    assert two.step(2.0, 2.0) == DISCARD  # the end came along
    two.drop(state)


def damaged(data, at, new):
    return data[:at] + new + data[at + len(new) :]


def test_a_damaged_state_is_refused_wherever_it_is_damaged(make):
    raw = make()
    raw.start({"room": 7})
    state = raw.save()
    data = raw.serialise(state)
    assert len(data) == 152 + 8 * (31 + 7)
    for at in range(0, len(data), 3):
        status, other = raw.deserialise(damaged(data, at, bytes([data[at] ^ 0x41])))
        assert status == ERROR, at
        assert not other.value
    for size in (0, 1, 151, 152, len(data) - 1, len(data) - 8):
        assert raw.deserialise(data[:size])[0] == ERROR
    assert raw.deserialise(data + b"\0" * 8)[0] == ERROR
    for at, words in (*HEADER, (128, "size")):
        raw.deserialise(damaged(data, at, (2**40 + 3).to_bytes(8, "little")))
        assert words in raw.last, at
    assert raw.deserialise(data)[0] == OK  # the twin: as it was, it is taken
    raw.drop(state)


def test_a_state_in_memory_is_checked_too(make):
    raw = make()
    raw.start()
    state = raw.save()
    memory = (ctypes.c_char * 152).from_address(state.value)
    whole = memory.raw
    for at, words in (*HEADER, (128, "memory")):
        memory[:] = damaged(whole, at, (33).to_bytes(8, "little"))
        assert raw.restore(state) == ERROR
        assert words in raw.last, at
    memory[:] = whole
    assert raw.restore(state) == OK
    too_small = ctypes.create_string_buffer(10)
    assert raw.call("SerializeFMUstate", state, too_small, Count(10)) == ERROR
    raw.drop(state)
    assert not state.value
    assert raw.drop(state) == OK


@pytest.mark.parametrize("left", [0, 1, 0xDEADBEEF, 2**64 - 1])
def test_a_state_is_written_over_whatever_the_pointer_held(make, left):
    """An uninitialised variable of the importer's is neither freed nor read; a refusal leaves it as it was."""
    raw = make()
    raw.start()
    state = raw.save()
    data = raw.serialise(state)
    pointer = ctypes.c_void_p(left)
    assert raw.call("DeSerializeFMUstate", data[:-8], Count(len(data) - 8), ctypes.byref(pointer)) == ERROR
    assert (pointer.value or 0) == left
    assert raw.call("DeSerializeFMUstate", data, Count(len(data)), ctypes.byref(pointer)) == OK
    assert raw.restore(pointer) == OK
    raw.drop(pointer)
    raw.drop(state)


def test_reset_is_a_fresh_instance_bit_for_bit(make):
    used, fresh = make(), make()
    used.start({"room": 90, "gain": 7.0}, stop=5.0)
    used.set({"push": 3.0, "go": True})
    used.ramp("push", 1.0)
    used.step(0.0, 1.0)
    used.call("Reset")
    assert used.serialise(used.save()) == fresh.serialise(fresh.save())
    used.set({"gain": 7.0})
    assert used.serialise(used.save()) != fresh.serialise(fresh.save())
