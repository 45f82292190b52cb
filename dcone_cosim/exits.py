"""The way out: what an error says, which exit code it has, and that a reader who leaves early disturbs nothing.

Expected failures become one message on stderr, and with `--json` the same as an object on stdout.
"""

from __future__ import annotations

import ctypes
import gc
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, NoReturn

import typer

from dcone_cosim import placed
from dcone_cosim.errors import BAD_INPUT, FAILED_AFTER, DconeError
from dcone_cosim.names import check_text


@contextmanager
def reader_may_leave() -> Iterator[None]:
    """Output that nobody reads any more (`dcone run mission | head -1`) is dropped: the work itself is done."""
    try:
        yield
        sys.stdout.flush()
    except BrokenPipeError:
        _to_nowhere()


STDOUT, STDERR = 1, 2
"""File descriptors: binaries know no others."""


@contextmanager
def noise_apart() -> Iterator[None]:
    """What the binary of an FMU prints goes to stderr: stdout is for results alone."""
    try:
        kept = os.dup(STDOUT)
    except OSError:
        yield  # closed from the start
        return
    sys.stdout.flush()
    try:
        os.dup2(STDERR, STDOUT)
        yield
    finally:
        with suppress(OSError, AttributeError, TypeError):
            ctypes.CDLL(None).fflush(None)  # what C still holds back belongs to the noise
        os.dup2(kept, STDOUT)
        os.close(kept)


def _open_streams() -> None:
    """Streams that are closed as we start (`>&-`) lead nowhere, before another file is given their number."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w"))


def _to_nowhere() -> None:
    """What is still buffered for stdout goes nowhere, so that closing it at the end does not fail."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def complain(text: str) -> None:
    with suppress(OSError):
        typer.echo(text, err=True)


def details(error: DconeError) -> dict[str, Any]:
    """What a machine may want beside the message: the first mistakes of a scene one by one, and how many more."""
    rows = getattr(error, "rows", None)
    return {"mistakes": rows(), "more": getattr(error, "more", 0)} if rows is not None else {}


def _fail(text: str, exit_code: int, **more: Any) -> NoReturn:
    """One message on stderr, and with --json the same as an object on stdout."""
    complain(f"dcone: {text}")
    _answer(text, exit_code, **more)
    try:
        sys.stdout.flush()
    except OSError:
        _to_nowhere()
    sys.exit(exit_code)


def _answer(text: str, exit_code: int, **more: Any) -> None:
    if "--json" in sys.argv[1:]:
        import json

        with suppress(OSError):
            typer.echo(json.dumps({"error": text, "exit_code": exit_code, **more}))


BY_SIGINT, BY_SIGTERM = 130, 143
"""Exit codes, as shells give them, of what was interrupted before there was anything to keep."""


def _check_arguments(arguments: list[str]) -> None:
    """Refuse what is not UTF-8 before any work: results tell of their places and settings in files of text."""
    for argument in arguments:
        check_text(argument)


def _terminate(*_: object) -> NoReturn:
    sys.exit(BY_SIGTERM)


def run(app: Callable[..., Any]) -> NoReturn:
    """Run the command line and leave: an expected failure is one message and an exit code, never a traceback."""
    _open_streams()
    placed.forget()
    before = _on_terminate(_terminate)
    try:
        _check_arguments(sys.argv[1:])
        code = app(standalone_mode=False)
    except DconeError as error:
        _fail(str(error), error.exit_code, **details(error))
    except KeyboardInterrupt:
        code = BY_SIGINT
    except OSError as error:
        _fail(_of_system(error), FAILED_AFTER if placed.any_there() else BAD_INPUT)
    except Exception as error:
        code = _of_arguments(error)
    except SystemExit as stop:
        if stop.code == BY_SIGTERM:
            _fail("terminated; " + placed.told(), BY_SIGTERM)
        if stop.code != 1:
            raise
        # typer ends so when the reader of a help text has left
        _to_nowhere()
        code = 0
    finally:
        _on_terminate(before)
        gc.freeze()  # or the interpreter looks through all that was imported once more as it ends: 0.15 s
    if code == BY_SIGINT:
        _fail("interrupted; " + placed.told(), BY_SIGINT)
    sys.exit(code or 0)


def _on_terminate(handler: Any) -> Any:
    """Set what SIGTERM does, so that temporary folders are removed then too; returns what it did before."""
    try:
        return signal.signal(signal.SIGTERM, handler)
    except ValueError:
        return signal.SIG_DFL


def _of_system(error: OSError) -> str:
    """What the system refused, in one line that names the file."""
    files = " -> ".join(str(f) for f in (error.filename, error.filename2) if f is not None)
    reason = error.strerror or str(error) or type(error).__name__
    return f"{files}: {reason}; {placed.told()}" if files else f"{reason}; {placed.told()}"


def _of_arguments(error: Exception) -> int:
    """Exit code of a wrong command line, once it is told; any other exception is a fault of ours and goes on."""
    show, message = getattr(error, "show", None), getattr(error, "format_message", None)
    if show is None or message is None:
        raise error
    show()
    code = int(getattr(error, "exit_code", BAD_INPUT))
    _answer(message(), code)
    return code
