"""What is wrong with a scene, told all at once: file and line, key, the value given, what was expected."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from dcone_cosim.toml_lines import Path, key_lines, line_of


@dataclass(frozen=True)
class Mistake:
    """One thing wrong: where, what was given (None when something is missing), and what was expected.

    default    value that counts when nothing is given
    """

    path: Path
    given: object
    expected: str
    default: str = ""


def message(mistakes: Sequence[Mistake], text: str, source: str) -> str:
    """One text for all mistakes in a scene, in the order of its lines."""
    lines = key_lines(text)
    found = sorted(mistakes, key=lambda m: line_of(lines, m.path) or 0)
    rows = [f"{source}: {len(found)} mistake{'s' if len(found) > 1 else ''}"]
    for mistake in found:
        line = line_of(lines, mistake.path)
        where = f"line {line}: " if line is not None else ""
        value = f"= {shown(mistake.given)}" if mistake.given is not None else "missing"
        if mistake.given is None and mistake.default:
            value = f"left at {mistake.default}"
        rows.append(f"  {where}{'.'.join(mistake.path)} {value}: {mistake.expected}")
    return "\n".join(rows)


def lines_named(said: str, text: str, phase: str) -> str:
    """Lines of the scene on which the parameters stand that an FMU's words name: "line 4: ", or nothing."""
    lines = key_lines(text)
    found = set()
    for section, key in re.findall(r"\b([a-z_]+)\.([a-z_]+)", said):
        number = lines.get((phase, section, key)) or lines.get((section, key))
        if number is not None:
            found.add(number)
    numbers = ", ".join(map(str, sorted(found)))
    return f"line{'s' if len(found) > 1 else ''} {numbers}: " if found else ""


def shown(value: object) -> str:
    """A value as the scene has it, short."""
    if isinstance(value, str):
        text = f'"{value}"'.replace("\n", "\\n")
    elif isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, dict):
        return "a table"
    else:
        text = str(value).replace("'", '"')
    return text if len(text) <= 60 else text[:57] + "..."
