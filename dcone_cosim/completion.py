"""What the shell offers when Tab is pressed: scenes and phases. Must answer at once, so nothing is read or checked."""

from __future__ import annotations

from pathlib import Path


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
    """Phases that there is a template for: the others ask the same of their FMUs."""
    templates = (Path(__file__).parent / "templates" / "c").glob("*.c")
    return sorted(path.stem for path in templates if path.stem != "fmu" and path.stem.startswith(incomplete))
