"""How fast cases come, and how long the rest will take."""

from __future__ import annotations

import time as clock


class Pace:
    """Counts cases as they are done.

    total      how many there are
    """

    def __init__(self, total: int) -> None:
        self.total = total
        self.done = self.failed = self.found = 0
        self._began = clock.perf_counter()

    def count(self, succeeded: bool, found: bool = False) -> None:
        """One more; `found`: its row was there already, which tells nothing of the rate."""
        self.done += 1
        self.found += found
        self.failed += not succeeded

    @property
    def rate(self) -> float:
        """Cases run per second, 0 before the first [1/s]."""
        return (self.done - self.found) / max(clock.perf_counter() - self._began, 1e-9)

    def told(self) -> str:
        """What stands beside the bar: "12 of 100, 2.1 per s, 41 s to go, 1 failed"."""
        parts = [f"{self.done} of {self.total}"]
        if self.done > self.found:
            rate = self.rate
            parts.append(f"{rate:.3g} per s" if rate >= 1.0 else f"{60.0 * rate:.3g} per min")
            if self.done < self.total:
                parts.append(f"{spoken((self.total - self.done) / rate)} to go")
        if self.found:
            parts.append(f"{self.found} of them there before")
        if self.failed:
            parts.append(f"{self.failed} failed")
        return ", ".join(parts)


def spoken(seconds: float) -> str:
    """A time to wait: "41 s", "12 min", "3.5 h", "2.1 days"."""
    for limit, unit, size in ((100.0, "s", 1.0), (6000.0, "min", 60.0), (172800.0, "h", 3600.0)):
        if seconds < limit:
            return f"{seconds / size:.{0 if size < 3600.0 else 1}f} {unit}"
    return f"{seconds / 86400.0:.1f} days"
