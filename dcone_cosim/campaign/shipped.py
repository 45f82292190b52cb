"""Campaigns by name: those that come with the program, or files."""

from __future__ import annotations

from pathlib import Path

from dcone_cosim import campaigns
from dcone_cosim.errors import InputError
from dcone_cosim.names import did_you_mean

SHIPPED = Path(campaigns.__file__).parent


def shipped() -> dict[str, Path]:
    """The campaigns that come with the program, by name."""
    return {path.stem: path for path in sorted(SHIPPED.glob("*.toml"))}


def find(name: Path) -> Path:
    """The file of a campaign; `InputError` for none."""
    known = shipped()
    if str(name) in known:
        return known[str(name)]
    if name.is_file():
        return name
    if name.is_dir():
        raise InputError(f"{name} is a folder; expected a campaign file, or `dcone campaign show {name}`")
    raise InputError(f"no campaign named {str(name)!r}{did_you_mean(str(name), known)}")
