"""What may go wrong in a way the user can act on, each with the exit code the command line returns for it."""

from __future__ import annotations

SUCCESS = 0
FAILED_AFTER = 1
BAD_INPUT = 2
CAPTURE_FAILED = 3
HANDOFF_FAILED = 4
FMU_FAILED = 5
INTERRUPTED = 6
CASES_FAILED = 7
OVERLOADED = 8
"""The run came to its end, and a line of it bore more than it can: in truth it would have broken."""


class DconeError(Exception):
    """An expected failure: its text is meant for the user, without a traceback."""

    exit_code = 1


class InputError(DconeError):
    """A scene, an argument or a folder that cannot be used as given; nothing is left behind."""

    exit_code = BAD_INPUT


class HandoffError(DconeError):
    """A hand-off that was refused, or whose ledger does not close."""

    exit_code = HANDOFF_FAILED


class FmuError(DconeError):
    """An FMU that cannot be loaded or that stopped: carries its own message, instance and time."""

    exit_code = FMU_FAILED


class Interrupted(DconeError):
    """A run that was asked to end: Ctrl-C or SIGTERM. What it had reached is kept."""

    exit_code = INTERRUPTED
