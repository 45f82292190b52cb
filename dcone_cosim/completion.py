"""What the shell offers when Tab is pressed: scenes and phases. Must answer at once, so nothing is read or checked."""

from __future__ import annotations

from pathlib import Path

PHASE_NAMES = ("capture", "removal")


def scenes_like(incomplete: str) -> list[str]:
    """Scenes that come with the program, and TOML files and folders that begin so."""
    shipped = [path.stem for path in (Path(__file__).parent / "scenes").glob("*.toml")]
    above = Path(incomplete.rpartition("/")[0] or ("/" if incomplete.startswith("/") else ""))
    try:
        beside = [path for path in above.iterdir() if path.suffix == ".toml" or path.is_dir()]
    except OSError:
        beside = []
    files = [f"{path}/" if path.is_dir() else str(path) for path in beside if not path.name.startswith(".")]
    return sorted(name for name in (*shipped, *files) if name.startswith(incomplete))


def phases_like(incomplete: str) -> list[str]:
    return [name for name in PHASE_NAMES if name.startswith(incomplete)]
