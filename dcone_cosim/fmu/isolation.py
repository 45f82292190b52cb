"""An FMU in a process of its own: its crash, its exit or its hanging is an error, not ours.

`IsolatedComponent` offers what a `Component` does; the component itself lives in a child (`isolated_child`), which runs
a fresh interpreter. Both sides send `frames` over the child's first two streams, each a call or an answer.
What the FMU writes goes to the third stream, of which the last words are kept; nothing of it reaches our own streams.

A communication step is one exchange: once the FMU steps, what has no answer (inputs, a state to be kept or gone back
to) waits for the next call that has one, and what was read after one step comes along with the next. A state never
leaves the child. The numbers are the same to the last bit.

Cost     tests/benchmarks/test_isolation_cost.py
"""

from __future__ import annotations

import math
import os
import subprocess
import threading
import time as clock
from collections.abc import Mapping, Sequence
from contextlib import suppress
from types import TracebackType
from typing import Any

import numpy as np

from dcone_cosim import interrupts
from dcone_cosim.child import how_it_ended, kill
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.children import FAREWELL, next_child
from dcone_cosim.fmu.frames import NEXT_CALL, Garbled, Incoming, from_fields, receive, send
from dcone_cosim.fmu.steppable import CallError, Row, Terminated, VariableInfo

LAST_WORDS = 600
"""Characters that an error quotes at most of the last three lines an FMU wrote."""
START = 120.0
"""How long the child's interpreter may take to start on a busy computer; the FMU has no part in it [s]."""
KEEPING = frozenset({"read", "reader", "get", "save", "release", "as_kept", "cpu"})
"""Calls after which what was read before still holds."""
ANSWERS = {"get": dict, "read": bytes, "reader": list, "step": list, "state_size": int, "cpu": float, "as_kept": dict}
"""What a call is answered with; all others with nothing."""


class IsolatedComponent:
    """One instance of an FMU in a process of its own, with the face of a `Component`.

    timeout    longest time one call to the FMU may take, its instantiation included [s]
    """

    def __init__(self, archive: Archive, name: str, timeout: float = 60.0) -> None:
        self.name = name
        self.archive = archive
        self.timeout = timeout
        self.variables: Mapping[str, VariableInfo] = archive.variables
        self.can_save = archive.can_save
        self.can_vary_step = archive.can_vary_step
        self.can_interpolate = archive.can_interpolate
        self.time = 0.0
        self._times: dict[str, float] = {}
        self._readers = 0
        self._cpu = 0.0
        self._gone: FmuError | None = None
        self._closed = self._late = False
        self._fresh: dict[int, bytes] = {}
        self._wanted: set[int] = set()
        self._waiting: list[tuple[object, ...]] = []
        self._stepping = False
        self._deadline = math.inf
        self._noise = b""
        self._over = threading.Event()
        self._child = next_child()
        assert self._child.stdout is not None
        self._answers = Incoming(self._child.stdout.fileno(), self._is_over)
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()
        threading.Thread(target=self._guard, daemon=True).start()
        try:
            self._ask(" could not be started", "hello")
            about = str(archive.path), str(archive.folder), name, archive.tolerance
            self._ask(" could not be instantiated", "instantiate", *about)
        except BaseException:
            self.close()
            raise

    def set(self, values: Mapping[str, float]) -> None:
        """Set variables by name."""
        self._tell("set", {name: float(value) for name, value in values.items()})

    def set_texts(self, texts: Mapping[str, str]) -> None:
        """Set variables of kind String by name."""
        self._ask("", "set_texts", dict(texts))

    def set_rates(self, rates: Mapping[str, float]) -> None:
        """Let inputs move at these rates [SI/s] over the next step."""
        self._tell("set_rates", {name: float(rate) for name, rate in rates.items()})

    def get(self, names: Sequence[str]) -> dict[str, float]:
        found: dict[str, float] = self._ask("", "get", list(names))
        return found

    def reader(self, names: Sequence[str]) -> IsolatedReader:
        order: list[str] = self._ask("", "reader", list(names))
        self._readers += 1
        return IsolatedReader(self, self._readers - 1, tuple(order))

    def initialise(self, start: float, stop: float | None = None) -> None:
        """Take the parameters as set and begin at `start` [s]."""
        self.enter_initialisation(start, stop)
        self.exit_initialisation()

    def enter_initialisation(self, start: float, stop: float | None = None) -> None:
        """Take the parameters as set and prepare to begin at `start` [s]."""
        self.time = float(start)
        self._ask(" at the start of its initialisation", "enter_initialisation", start, stop)

    def exit_initialisation(self) -> None:
        """Begin, with what was set meanwhile."""
        self._ask(" at the end of its initialisation", "exit_initialisation")

    def step(self, time: float, size: float) -> None:
        """Advance from `time` by `size` [s]."""
        wanted, self._wanted = tuple(self._wanted), set()
        self._stepping = True
        try:
            fresh = self._ask(
                f" at t = {time:.9g} s in a step of {size:.6g} s", "step", float(time), float(size), wanted
            )
        except Terminated as end:
            self.time = end.time
            raise
        self.time = time + size
        self._fresh.update({number: data for number, data in fresh})

    def save(self, key: str = "") -> None:
        """Keep the present state, replacing the one kept before under this key; it stays in the child."""
        self._tell("save", key)
        self._times[key] = self.time

    def restore(self, key: str = "") -> None:
        """Go back to the state kept last under this key."""
        self._tell("restore", key)
        self.time = self._times[key]

    def release(self, key: str = "") -> None:
        """Nobody goes back to what was kept under this key any more."""
        if self._times.pop(key, None) is not None:
            self._tell("release", key)

    def reset(self) -> None:
        """Back to how it was when it was made, in the same process; readers made before are of no more use."""
        self._stepping = False
        self._waiting.clear()
        self._wanted.clear()
        self._times.clear()
        self._readers = 0
        self._ask(" in fmi2Reset", "reset")
        self.time = 0.0

    def state_size(self) -> int:
        """Bytes of a serialised state."""
        return int(self._ask("", "state_size"))

    def as_kept(self) -> dict[str, Any]:
        """The present state as bytes, for an instance of another process."""
        found: dict[str, Any] = self._ask("", "as_kept")
        return found

    def take_up(self, kept: Mapping[str, Any]) -> None:
        """Be in a state that `as_kept` gave; this instance must have begun."""
        self._ask(" as it takes up a state", "take_up", dict(kept))
        self.time = float(kept["time"])

    def cpu_apart(self) -> float:
        """CPU time of its process [s]; what was known last when that is gone."""
        with suppress(FmuError):
            self._cpu = self._ask("", "cpu")
        return self._cpu

    def close(self) -> None:
        """Free the FMU and end its process; one that does not end by itself is killed."""
        if self._closed:
            return
        self._closed = True
        if self._gone is not None:
            return
        if self._deadline == math.inf:  # otherwise a call was interrupted and may still be going on
            with suppress(OSError, subprocess.TimeoutExpired):
                send(self._child.stdin, [("close",)])  # type: ignore[arg-type]
                self._child.wait(min(FAREWELL, self.timeout))
        self._end()

    def __enter__(self) -> IsolatedComponent:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def _tell(self, *call: object) -> None:
        """A call without an answer: made at once before the first step, which is what others expect of a refusal; later
        with the next that has one, and its refusal is then told there."""
        if not self._stepping:
            self._ask("", *call)
            return
        self._alive()
        if call[0] not in KEEPING:
            self._fresh.clear()
        self._waiting.append(call)

    def _alive(self) -> None:
        if self._gone is not None:
            raise self._gone
        if self._closed:
            raise FmuError(f"{self.name}: the instance is closed")

    def _ask(self, where: str, *call: object) -> Any:
        """Send what waits and this call; returns its answer. `where` tells the time of one that is not answered."""
        self._alive()
        if call[0] not in KEEPING:
            self._fresh.clear()
        calls, self._waiting = [*self._waiting, call], []
        self._deadline = clock.monotonic() + (START if call[0] == "hello" else self.timeout)
        try:
            send(self._child.stdin, calls)  # type: ignore[arg-type]
            error, answer, remarks = _checked(str(call[0]), receive(self._answers))
        except (OSError, EOFError, Garbled) as reason:
            self._gone = self._died(where, isinstance(reason, Garbled), [str(name) for name, *_ in calls[:-1]])
            raise self._gone from None
        self._deadline = math.inf
        for remark in remarks:
            self.archive.remark(remark)
        if error is not None:
            raise error
        return answer

    def _is_over(self) -> bool:
        """Whether the child is gone, or as good as."""
        return self._late or self._child.poll() is not None

    def _died(self, where: str, garbled: bool, before: Sequence[str]) -> CallError:
        """Why there is no answer: killed since it was late or wrote nonsense, ended by a signal, or by its own exit.

        before     names of the calls that went along, of which it may have been one
        """
        alive = True
        if not (self._late or garbled):
            with suppress(subprocess.TimeoutExpired):
                self._child.wait(FAREWELL)
                alive = False
        self._end()
        code = self._child.returncode
        if self._late:
            limit = interrupts.PATIENCE if interrupts.noted() else self.timeout
            said = f"it did not answer within {limit:g} s and was killed (its key timeout says how long it may take)"
        elif garbled:
            said = "its process wrote into the stream of our answers, which cannot be read any more, and was killed"
        elif alive:
            said = "its process closed the stream of our answers, and was killed"
        else:
            said = f"its process {how_it_ended(code)}"
        noise = self._noise.rpartition(NEXT_CALL)[2].decode("utf-8", "replace")
        lines = [line.strip() for line in noise.splitlines() if line.strip()]
        if lines:
            said += f"; its last words: {'; '.join(lines[-3:])[-LAST_WORDS:]}"
        detail = f"{self.archive.path.name}, run in a process of its own"
        if before:
            detail += f"; with it went {', '.join(dict.fromkeys(before))}"
        return CallError(self.name, where or f" at t = {self.time:.9g} s", said, detail, "Dead")

    def _end(self) -> None:
        """Kill what is left of the child and of its own children, and close the streams."""
        self._over.set()
        kill(self._child)
        self._child.wait()
        self._listener.join(1.0)
        for stream in (self._child.stdin, self._child.stdout):
            with suppress(OSError):
                stream.close()  # type: ignore[union-attr]

    def _listen(self) -> None:
        """Keep the last of what the FMU writes."""
        stream = self._child.stderr
        assert stream is not None
        with stream:
            while data := os.read(stream.fileno(), 65536):
                self._noise = (self._noise + data)[-4 * LAST_WORDS :]

    def _guard(self) -> None:
        """Kill a child that is late: whoever waits for it then finds it gone."""
        while not self._over.wait(min(0.2, 0.1 * self.timeout)):
            if clock.monotonic() > self._deadline or (self._deadline < math.inf and interrupts.overdue()):
                self._late = True
                kill(self._child)
                return


class IsolatedReader:
    """Reads a fixed set of variables of an isolated FMU into one row.

    What was read after one step comes along with the answer to the next, so that step and reading cost one message.
    """

    def __init__(self, component: IsolatedComponent, number: int, names: tuple[str, ...]) -> None:
        self.names = names
        self.values: Row = np.zeros(len(names))
        self._component = component
        self._number = number

    def __call__(self) -> Row:
        component = self._component
        component._wanted.add(self._number)
        data = component._fresh.get(self._number)
        if data is None:
            data = component._ask("", "read", self._number)
            component._fresh[self._number] = data
        self.values[:] = np.frombuffer(data)
        return self.values


def _checked(call: str, frame: Any) -> tuple[FmuError | None, Any, list[str]]:
    """The error or None, the answer, and remarks; `Garbled` when it is no answer to this call."""
    match frame:
        case [None, answer, list(remarks)] if isinstance(answer, ANSWERS.get(call, type(None))):
            return None, answer, [str(remark) for remark in remarks]
        case [list(fields), None, list(remarks)]:
            return from_fields(fields), None, [str(remark) for remark in remarks]
    raise Garbled
