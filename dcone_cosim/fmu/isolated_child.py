"""The child of `isolation`: one FMU, and a loop that does to it what the parent asks.

Its first two streams carry the calls and the answers (see `child`). It ends when it is told to, when the stream of
calls ends, or when its parent is gone.
"""

from __future__ import annotations

import os
import signal
import time
import traceback
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

from dcone_cosim.child import end_with_parent, own_streams
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.component import Archive, Component, Reader
from dcone_cosim.fmu.frames import NEXT_CALL, Incoming, as_fields, receive, send
from dcone_cosim.fmu.messages import listeners

CALLS = frozenset(
    {
        *("set", "set_texts", "set_rates", "get", "enter_initialisation", "exit_initialisation"),
        *("save", "restore", "release", "state_size", "as_kept", "take_up", "reset"),
    }
)
"""Calls that go straight to the component."""


class Server:
    """Makes the calls of a frame one after the other, until one fails.

    The answer to them: the fields of an error or None, the result of the last call, and remarks that are new.
    """

    def __init__(self) -> None:
        self.component: Component | None = None
        self.readers: list[Reader] = []
        self._said = False
        self._remarked = 0

    def answer(self, call: str, *arguments: Any) -> Any:
        if call == "hello":
            return None
        if call == "instantiate":
            path, folder, name, tolerance = arguments
            self.component = Component(Archive(Path(path), Path(folder), tolerance), name)
            return None
        assert self.component is not None
        if call == "step":
            begin, size, wanted = arguments
            self.component.step(begin, size)
            return [(number, data) for number in wanted if (data := self._read_ahead(number)) is not None]
        if call == "read":
            return self.readers[arguments[0]]().tobytes()
        if call == "reader":
            self.readers.append(self.component.reader(arguments[0]))
            return self.readers[-1].names
        if call == "reset":
            self.readers.clear()
        if call == "cpu":
            return time.process_time()
        if call not in CALLS:
            raise FmuError(f"an isolated FMU has no call {call!r}")
        return getattr(self.component, call)(*arguments)

    def _read_ahead(self, number: int) -> bytes | None:
        """What will probably be read next; an error is left to the reading itself."""
        with suppress(FmuError):
            return self.readers[number]().tobytes()
        return None

    def pass_on(self, text: str) -> None:
        """Write a message where the parent finds it, should this process die."""
        self._said = True
        with suppress(OSError):
            os.write(2, (text + "\n").encode())

    def separate(self) -> None:
        """Before a call: what was said during others is no news any more."""
        if self._said:
            self._said = False
            with suppress(OSError):
                os.write(2, NEXT_CALL)

    def remarks(self) -> list[str]:
        """What has been remarked on since this was asked last."""
        if self.component is None:
            return []
        found = list(self.component.archive.remarks)[self._remarked :]
        self._remarked += len(found)
        return found

    def answers(self, asked: Sequence[Any]) -> tuple[Any, Any, list[str]]:
        result = None
        for call in asked:
            self.separate()
            try:
                result = self.answer(*call)
            except FmuError as error:
                return as_fields(error), None, self.remarks()
            except Exception:
                text = f"{call[0]} failed in the child process:\n{traceback.format_exc()}"
                return as_fields(FmuError(text)), None, self.remarks()
        return None, result, self.remarks()

    def serve(self, calls: Incoming, answers: BinaryIO) -> None:
        while True:
            try:
                asked = receive(calls)
            except EOFError:
                return
            if asked == [["close"]]:
                self.separate()
                if self.component is not None:
                    self.component.close()
                return
            send(answers, self.answers(asked))


def main() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    calls, answers = own_streams()
    end_with_parent()
    server = Server()
    listeners.append(server.pass_on)
    with suppress(BrokenPipeError):
        server.serve(Incoming(calls), os.fdopen(answers, "wb"))
    os._exit(0)


if __name__ == "__main__":
    main()
