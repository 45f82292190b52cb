"""Whether a component that went back to a saved state is where it was: an FMU may say that it can, and not do it."""

from __future__ import annotations

from collections.abc import Sequence

from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.steppable import Readable, Row, Steppable

RESTORED_TO = 1e-9
"""How closely an output has to come back, relative to its size. Those of ours come back to the last bit; a solver that
works them out anew may differ by its tolerance."""


def save(component: Steppable, read: Readable) -> Row:
    """Save the state; returns the outputs that go with it. `read` must have been called since the last step."""
    component.save()
    return read.values.copy()


UNLESS = "it is then taken as its macro steps fall"
"""What becomes of an FMU that says that it cannot go back."""


def restore(component: Steppable, read: Readable, kept: Row, time: float, unless: str = UNLESS) -> None:
    """Go back to the state saved last, at `time` [s], and compare its outputs with those kept of it.

    Raises `FmuError` that names the first output that differs.
    """
    component.restore()
    found = differing(read.names, kept, read())
    if found is not None:
        name, before, after = found
        told = f"at t = {time:.9g} s its output {name} was {before:.12g} before, {after:.12g} after"
        raise _liar(component, told, unless)


def replay(component: Steppable, read: Readable, kept: Row, begin: float, end: float, unless: str = UNLESS) -> None:
    """Go back by the step just taken, from `begin` to `end` [s], take it again, and go back once more.

    A state that is only half restored, its outputs but not what they come from, shows in the second step alone.
    """
    first = read.values.copy()
    restore(component, read, kept, begin, unless)
    component.step(begin, end - begin)
    found = differing(read.names, first, read())
    if found is not None:
        name, before, after = found
        step = f"the step from {begin:.9g} s to {end:.9g} s"
        raise _liar(component, f"{step} gave its output {name} as {before:.12g} before, {after:.12g} after", unless)
    restore(component, read, kept, begin, unless)


def differing(names: Sequence[str], before: Row, after: Row) -> tuple[str, float, float] | None:
    """The first output that is not what it was: its name, and its value before and after."""
    if (before == after).all():
        return None
    for name, was, now in zip(names, before.tolist(), after.tolist(), strict=True):
        if not abs(now - was) <= RESTORED_TO * max(abs(was), abs(now)):
            return name, was, now
    return None


def _liar(component: Steppable, what: str, unless: str) -> FmuError:
    return FmuError(
        f"{component.name}: its state does not restore: {what}\n"
        "  (an FMU that cannot go back must say canGetAndSetFMUstate = false; "
        f"{unless})"
    )
