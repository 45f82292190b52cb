"""What is told of a phase that its FMU ended itself."""

from __future__ import annotations

from collections.abc import Iterator

from dcone_cosim.findings import Finding
from dcone_cosim.results import PhaseResult


def of_end(phase: str, result: PhaseResult) -> Iterator[Finding]:
    """What is told of a phase that its FMU ended itself."""
    if result.ended_by:
        yield Finding(phase, "ended_at", "the FMU ended at", result.ended_at, "s")
        yield Finding(phase, "ended_by", "it says", result.ended_by)
