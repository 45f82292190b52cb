"""What a comparison of two runs is: all that is told, drawn and written of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from dcone_cosim.comparing.pairs import KeyPair, Pair
from dcone_cosim.results import RunResult


@dataclass(frozen=True)
class Comparison:
    """Two runs side by side.

    names    by which they are told apart
    tables   of both, and whether they hold the same bits
    """

    folders: tuple[Path | None, Path | None]
    names: tuple[str, str]
    runs: tuple[RunResult, RunResult]
    figures: list[Pair]
    keys: list[KeyPair]
    tables: Mapping[str, bool]
    notes: list[str] = field(default_factory=list)

    @property
    def title(self) -> str:
        return f"{self.names[0]} beside {self.names[1]}"
