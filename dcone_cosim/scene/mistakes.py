"""What is wrong with a scene, told all at once: place, key, the value given, what was expected, the nearest match."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from dcone_cosim.errors import InputError
from dcone_cosim.names import did_you_mean, nearest
from dcone_cosim.scene.toml_lines import Lines, Path, dotted, key_lines, line_of

MOST = 1000
"""Mistakes after which nobody reads on."""
TOLD = 20
"""How many of them are told: the first."""


@dataclass(frozen=True)
class Mistake:
    """One thing wrong: where, what was given (None when something is missing), and what is said of it.

    default    value that counts when nothing is given
    name       one that is not known, and those that are, among which a likely one is looked for when it is told
    """

    path: Path
    given: object
    said: str
    default: str = ""
    name: str = ""
    known: Collection[str] = ()

    @property
    def expected(self) -> str:
        """What is said of it, with the known name that was probably meant."""
        return self.said + did_you_mean(self.name, self.known)

    @property
    def nearest(self) -> str | None:
        return nearest(self.name, self.known)


def unknown(path: Path, given: object, what: str, name: str, known: Iterable[str]) -> Mistake:
    """A name that is not known, among those that are."""
    names = known if isinstance(known, Collection) else list(known)
    return Mistake(path, given, what, name=name, known=names)


class Enough(Exception):
    """There are so many mistakes that no more are looked for."""


class Mistakes(list[Mistake]):
    """The mistakes found so far; `Enough` is raised with the last one that is taken."""

    def append(self, mistake: Mistake) -> None:
        super().append(mistake)
        if len(self) >= MOST:
            raise Enough


@dataclass(frozen=True)
class Override:
    """A key set on the command line: its path, and the argument as given, `capture.bullets.speed=4 m/s`."""

    path: Path
    argument: str


@dataclass(frozen=True)
class Places:
    """Where the keys of a scene were written: on a line of its file, or on the command line.

    source     names the file in messages
    text       of the file as it stands on disk
    """

    source: str
    text: str
    overrides: tuple[Override, ...] = ()

    @cached_property
    def lines(self) -> Lines:
        return key_lines(self.text)

    def override(self, path: Path) -> Override | None:
        """The argument that set this key, a part of it, or, for a table the file does not have, something in it or
        beside it: a table that only an argument speaks of lacks what it lacks because of that."""
        for override in reversed(self.overrides):
            shared = min(len(path), len(override.path))
            if path[:shared] == override.path[:shared] and (shared == len(override.path) or path not in self.lines):
                return override
        for override in reversed(self.overrides):
            table = override.path[:-1]
            if len(table) > 1 and path[: len(table)] == table and table not in self.lines:
                return override
        return None

    def line(self, path: Path) -> int | None:
        return None if self.override(path) else line_of(self.lines, path)

    def of(self, path: Path) -> str:
        """`line 12`, `--set capture.bullets.speed=4 m/s`, or nothing."""
        override = self.override(path)
        if override is not None:
            return f"--set {override.argument}"
        line = line_of(self.lines, path)
        return f"line {line}" if line is not None else ""


class SceneError(InputError):
    """A scene with mistakes, of which the first can be looked at each: by an editor, or a machine."""

    def __init__(self, mistakes: Sequence[Mistake], places: Places) -> None:
        found = sorted(_unlike(mistakes), key=lambda m: places.line(m.path) or 0)
        self.mistakes, self.places = tuple(found), places
        super().__init__(message(self.mistakes, places))

    @property
    def more(self) -> int:
        """How many mistakes are not told."""
        return max(0, len(self.mistakes) - TOLD)

    def rows(self) -> list[dict[str, Any]]:
        """The mistakes that are told, as plain data."""
        return [
            {
                "place": self.places.of(mistake.path),
                "line": self.places.line(mistake.path),
                "key": dotted(mistake.path),
                "given": None if mistake.given is None else shown(mistake.given),
                "expected": mistake.expected,
                "nearest": mistake.nearest,
            }
            for mistake in self.mistakes[:TOLD]
        ]


def _unlike(mistakes: Sequence[Mistake]) -> list[Mistake]:
    """Without those that say the same of the same key; values need not be hashable."""
    kept: dict[tuple[Path, str], Mistake] = {}
    for mistake in mistakes:
        kept.setdefault((mistake.path, mistake.said), mistake)
    return list(kept.values())


def message(mistakes: Sequence[Mistake], places: Places) -> str:
    """One text for the mistakes in a scene, of which the first are told."""
    count = f"{len(mistakes)} mistake{'s' if len(mistakes) > 1 else ''}"
    rows = [f"{places.source}: {count}{' and perhaps more' if len(mistakes) >= MOST else ''}"]
    for mistake in mistakes[:TOLD]:
        place = places.of(mistake.path)
        value = f"= {shown(mistake.given)}" if mistake.given is not None else "missing"
        if mistake.given is None and mistake.default:
            value = f"left at {mistake.default}"
        key, said = shortened(dotted(mistake.path), 120), shortened(mistake.expected, 1000)
        rows.append(f"  {place}{place and ': '}{key} {value}: {said}")
    if len(mistakes) > TOLD:
        rows.append(f"  and {len(mistakes) - TOLD} more")
    return "\n".join(rows)


def places_named(said: str, places: Places, *table: str) -> str:
    """Where the parameters stand that an FMU's words name: "line 4: ", "--set capture.net.side=3 m: ", or nothing.

    table     path of its table in the scene: a phase, or a component of one
    """
    lines, arguments = set(), []
    for section, key in re.findall(r"\b([a-z_]+)\.([a-z_]+)", said):
        spelt = ((section, key), ("parameters", section, key), ("parameters", f"{section}.{key}"))
        for path in (*((*table, *names) for names in spelt), (section, key)):
            override = places.override(path)
            if override is not None and override.path == path:
                arguments.append(f"--set {override.argument}")
                break
            if path in places.lines:
                lines.add(places.lines[path])
                break
    numbers = ", ".join(map(str, sorted(lines)))
    found = [f"line{'s' if len(lines) > 1 else ''} {numbers}"] if lines else []
    return "".join(f"{place}: " for place in [*found, *dict.fromkeys(arguments)])


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
    return shortened(text, 60)


def shortened(text: str, length: int) -> str:
    return text if len(text) <= length else text[: length - 3] + "..."
