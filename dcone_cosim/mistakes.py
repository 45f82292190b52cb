"""What is wrong with a scene, told all at once: file and line, key, the value given, what was expected."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from dcone_cosim.toml_lines import Path, key_lines, line_of


@dataclass(frozen=True)
class Mistake:
    """One thing wrong: where, what was given (None when something is missing), and what was expected."""

    path: Path
    given: object
    expected: str


def message(mistakes: Sequence[Mistake], text: str, source: str) -> str:
    """One text for all mistakes in a scene, in the order of its lines."""
    lines = key_lines(text)
    found = sorted(mistakes, key=lambda m: line_of(lines, m.path) or 0)
    rows = [f"{source}: {len(found)} mistake{'s' if len(found) > 1 else ''}"]
    for mistake in found:
        line = line_of(lines, mistake.path)
        where = f"line {line}: " if line is not None else ""
        value = "missing" if mistake.given is None else f"= {_shown(mistake.given)}"
        rows.append(f"  {where}{'.'.join(mistake.path)} {value}: {mistake.expected}")
    return "\n".join(rows)


def _shown(value: object) -> str:
    """A value as the scene has it, short."""
    if isinstance(value, str):
        text = f'"{value}"'
    elif isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, dict):
        return "a table"
    else:
        text = str(value).replace("'", '"')
    return text if len(text) <= 60 else text[:57] + "..."
