"""What goes between us and the child of `isolation`: frames of JSON, since foreign code may write into the stream.

A frame is a mark, a length and a text. It holds names, numbers, lists and tables of them, and rows of doubles as bytes;
reading one runs nothing and makes nothing else. Numbers keep every bit: JSON has them as the shortest text that reads
back as the same double, with NaN and Infinity as words.

They go through pipes. What takes time there is not to carry them but to be woken up, on two quiet cores some 50 us for
a call and its answer: whoever waits looks again and again for a moment first, which leaves 3.5 us, and where cores are
busy gains nothing. Shared memory would leave 0.3 us, of an exchange whose texts alone take 10: it does not pay.
tests/benchmarks/test_isolation_cost.py measures all of them.
"""

from __future__ import annotations

import base64
import json
import os
import select
import struct
import time as clock
from collections.abc import Callable
from typing import Any, BinaryIO, Protocol

from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.steppable import CallError, Terminated

MARK = b"dcF1"
LARGEST = 64 * 2**20
"""Bytes of a frame: the parameters of millions of nodes."""
NEXT_CALL = b"\x1e\n"
"""Between an FMU's messages during one call and those during the next, on the stream of what it writes."""
MOMENT = 1e-4
"""How long to look again and again for what comes before sleeping until it is there [s]."""
LONGEST_PAUSE = 63
"""Looks that are left out at most after one in vain."""
LOOK = 0.1
"""How often to see meanwhile whether the other side is still there [s]."""
_HEAD = struct.Struct("<4sI")
_BYTES = "base64"


class Readable(Protocol):
    """A stream that frames are read from."""

    def read(self, size: int, /) -> bytes: ...


class Garbled(Exception):
    """What came is no frame, or no answer to what was asked."""


class Incoming:
    """The end of a pipe that frames are read from.

    is_over    whether nothing more will come although the pipe is open: somebody that a dead process has left behind
               may still hold its other end
    """

    def __init__(self, descriptor: int, is_over: Callable[[], bool] = lambda: False) -> None:
        self._descriptor, self._is_over = descriptor, is_over
        self._data = b""
        self._pause = self._left_out = 0
        if os.name != "nt":
            poll = select.poll()
            poll.register(descriptor, select.POLLIN)
            self._poll = poll.poll

    def read(self, size: int) -> bytes:
        """Up to `size` bytes, at least one; none at the end."""
        if not self._data:
            self._data = self._next()
        found, self._data = self._data[:size], self._data[size:]
        return found

    def _next(self) -> bytes:
        """What has come, at least a byte; none at the end."""
        if os.name != "nt" and not self._look():
            over = False
            while not select.select([self._descriptor], [], [], 0.0 if over else LOOK)[0]:
                if over:
                    return b""
                over = self._is_over()
        return os.read(self._descriptor, 1 << 20)

    def _look(self) -> bool:
        """Look again and again for a moment; false when nothing has come.

        After a look in vain the next ones are left out, ever more of them: it is for answers that come at once, and
        takes the processor from whoever else needs it, be it the other side.
        """
        if self._left_out > 0:
            self._left_out -= 1
            return False
        until = clock.perf_counter() + MOMENT
        while not self._poll(0):
            if clock.perf_counter() > until:
                self._pause = min(2 * self._pause + 1, LONGEST_PAUSE)
                self._left_out = self._pause
                return False
        self._pause = 0
        return True


def send(stream: BinaryIO, content: object) -> None:
    data = _encode(content).encode()
    stream.write(_HEAD.pack(MARK, len(data)) + data)
    stream.flush()


def receive(stream: Readable) -> Any:
    """Content of the next frame; tuples come as lists. EOFError when the other side is gone, else `Garbled`."""
    mark, size = _HEAD.unpack(_exactly(stream, _HEAD.size))
    if mark != MARK or size > LARGEST:
        raise Garbled
    try:
        return _decode(_exactly(stream, size).decode())
    except (ValueError, TypeError, RecursionError):
        raise Garbled from None


def as_fields(error: FmuError) -> list[object]:
    """An error as plain values."""
    if not isinstance(error, CallError):
        return ["FmuError", str(error)]
    kind = "Terminated" if isinstance(error, Terminated) else "CallError"
    return [kind, error.name, error.where, error.said, error.detail, error.status, error.reached]


def from_fields(fields: Any) -> FmuError:
    """The error again, of its own class; `Garbled` when these are not the fields of one."""
    match fields:
        case ["FmuError", str(text)]:
            return FmuError(text)
        case ["Terminated", str(name), str(where), str(said), str(detail), str(status), float(reached)]:
            return Terminated(name, where, said, detail, status, reached)
        case ["CallError", str(name), str(where), str(said), str(detail), str(status), float() | None as reached]:
            return CallError(name, where, said, detail, status, reached)
    raise Garbled


def _as_table(value: object) -> dict[str, str]:
    if not isinstance(value, bytes):
        raise TypeError(f"{type(value).__name__} has no place in a frame")
    return {_BYTES: base64.b64encode(value).decode()}


def _from_table(table: dict[str, Any]) -> Any:
    return base64.b64decode(table[_BYTES], validate=True) if table.keys() == {_BYTES} else table


def _exactly(stream: Readable, size: int) -> bytes:
    data = stream.read(size)
    while len(data) < size:
        more = stream.read(size - len(data))
        if not more:
            raise EOFError
        data += more
    return data


_encode = json.JSONEncoder(default=_as_table).encode
_decode = json.JSONDecoder(object_hook=_from_table).decode
