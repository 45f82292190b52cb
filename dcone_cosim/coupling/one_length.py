"""FMUs that take steps of one length only (canHandleVariableCommunicationStepSize = false), and what that forbids."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def divides(step: float, whole: float) -> bool:
    """Whether steps of this length fill the whole one; as finely as macro steps are counted, to 1e-9 of a step."""
    return round(whole / step) >= 1 and abs(whole / step - round(whole / step)) <= 1e-9


def one_length(names: Sequence[str]) -> str:
    """What is said of FMUs by instance name: "the FMU of a takes steps of one length"."""
    several = len(names) > 1
    return f"the FMU{'s' if several else ''} of {', '.join(names)} take{'' if several else 's'} steps of one length"


def uncontrolled(components: Iterable[tuple[str, bool, bool]]) -> list[str]:
    """Why the steps of these components cannot be controlled by their error; empty when they can.

    components   instance name, whether its state can be saved, whether its steps may differ in length
    """
    of = list(components)
    fixed = 'use control = "fixed"'
    lacking = [name for name, can_save, _ in of if not can_save]
    even = [name for name, _, can_vary in of if not can_vary]
    why = []
    if lacking:
        those = f"the FMU{'s' if len(lacking) > 1 else ''} of {', '.join(lacking)}"
        states = "their states" if len(lacking) > 1 else "its state"
        why.append(f"rolls steps back, but {those} cannot save {states}; {fixed}")
    if even:
        why.append(f"makes steps of different lengths, but {one_length(even)}; {fixed}")
    return why
