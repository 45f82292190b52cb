"""A run folder as the command line writes it, from a result at hand."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from dcone_cosim.drafts import atomic_folder
from dcone_cosim.results import RunResult
from dcone_cosim.run_folder import fill


def write(result: RunResult, folder: Path, summary: dict[str, Any], force: bool = False, **more: Any) -> Path:
    """Write the folder; returns where it is: another name when this one was taken."""
    with atomic_folder(folder, force) as draft:
        fill(draft.path, result, {}, summary, datetime.now(UTC), **more)
    return draft.folder
