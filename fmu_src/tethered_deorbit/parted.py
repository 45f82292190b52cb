"""A line that is whole no more, broken or cut: it is never taut again."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from fmu_src.tethered_deorbit.law import Reel
from orbital.kernel import kernel


def make_loose(terms: Mapping[str, str]) -> Callable[..., Any]:
    """Kernel (record) -> bool: whether the line of these terms has parted."""
    breaks, released = "break" in terms, "release" in terms

    @kernel
    def loose(record: Any) -> bool:
        """Whether the line is broken or cut.

        Checked  tests/tethered_deorbit/test_parted.py
        """
        if breaks:
            if record[0].state_broken:
                return True
        if released:
            if record[0].state_released:
                return True
        return False

    return loose


def make_parted(reel: Reel, parted: Any) -> Reel:
    """The reel with a line that pulls as long as it is whole.

    parted    kernel (record) -> bool
    """

    @kernel
    def taut(record: Any, length: float, rate: float) -> bool:
        """Whether a whole line pulls.

        Checked  tests/tethered_deorbit/test_ends.py, tests/tethered_deorbit/test_release.py
        """
        return not parted(record) and bool(reel.taut(record, length, rate))

    @kernel
    def onset(record: Any, length: float, rate: float, since: float) -> float:
        """That of a whole line; of one that has parted, never.

        Checked  tests/tethered_deorbit/test_ends.py, tests/tethered_deorbit/test_release.py
        """
        return -1.0 if parted(record) else float(reel.onset(record, length, rate, since))

    @kernel
    def onset_rate(record: Any, length: float, rate: float, acceleration: float, since: float) -> float:
        """Its time derivative.

        Checked  tests/tethered_deorbit/test_ends.py, tests/tethered_deorbit/test_release.py
        """
        return 0.0 if parted(record) else float(reel.onset_rate(record, length, rate, acceleration, since))

    return reel._replace(taut=taut, onset=onset, onset_rate=onset_rate)
