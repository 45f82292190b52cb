"""Whether a component that went back to a saved state is where it was: an FMU may say that it can, and not do it."""

from __future__ import annotations

from dcone_cosim.errors import FmuError
from dcone_cosim.steppable import Readable, Row, Steppable

RESTORED_TO = 1e-9
"""How closely a restored output has to be the one before, relative to its size. Ours come back to the last bit; a
solver that works its outputs out anew may differ by its tolerance."""


def save(component: Steppable, read: Readable) -> Row:
    """Save the state; returns the outputs that go with it. `read` must have been called since the last step."""
    component.save()
    return read.values.copy()


def restore(component: Steppable, read: Readable, kept: Row, time: float) -> None:
    """Restore the state saved last, and compare its outputs with those kept of it.

    time      to which it goes back [s], for the message

    Raises `FmuError` that names the first output that differs.
    """
    ahead = read.values.copy()
    component.restore()
    now = read()
    if (now == kept).all():
        return
    for name, before, after, was in zip(read.names, kept.tolist(), now.tolist(), ahead.tolist(), strict=True):
        if not abs(after - before) <= RESTORED_TO * max(abs(before), abs(after)):
            stays = "; it stays where the step it should forget had left it" if after == was else ""
            raise FmuError(
                f"{component.name}: its state does not restore: at t = {time:.9g} s its output {name} was {before!r} "
                f"when the state was saved, and is {after!r} after it was restored{stays}\n"
                "  (an FMU that cannot go back must say canGetAndSetFMUstate = false; "
                "it is then taken at the end of its macro steps)"
            )
