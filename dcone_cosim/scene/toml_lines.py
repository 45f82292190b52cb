"""On which line of a TOML text a key or an element of a list stands, so that a mistake can be pointed at.

Python's own parser tells no positions. This one walks over a text that is valid already, and needs to know only where
keys, strings, lists and inline tables begin and end.
"""

from __future__ import annotations

import re
import tomllib
from contextlib import suppress
from functools import lru_cache
from typing import Any

Path = tuple[str | int, ...]
"""Keys from the top of the document; a number is the place in a list, counted from 0."""
Lines = dict[Path, int]

_TRIVIA = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_BLANK = re.compile(r"[ \t]*")
_KEY = re.compile(r"""[A-Za-z0-9_-]+|"(?:\\.|[^"\\\n])*"|'[^'\n]*'""")
_STRING = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}|' r"'''.*?'{3,5}|" r'"(?:\\.|[^"\\\n])*"|' r"'[^'\n]*'",
    re.DOTALL,
)
_OTHER = re.compile(r"[^,\]}\n#]+")

DEEPEST = 64
"""Parts of the longest key that is read. The time a parser takes for a key goes with the square of its parts."""
_PART = r"""(?:[A-Za-z0-9_-]++|"(?:\\.|[^"\\\n])*+"|'[^'\n]*+')"""
_DEEP = re.compile(rf"(?<![A-Za-z0-9_-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{DEEPEST}}}")


class _Lost(Exception):
    """The text is not what a valid one would be."""


class _Walk:
    """One pass over a text.

    named      line of every key that is written out, and of every element of a list
    implied    line on which a table is first spoken of: by a dotted key, or as a part of another table's name
    """

    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0
        self.named: Lines = {}
        self.implied: Lines = {}
        self._line, self._counted = 1, 0
        self._last: dict[Path, int] = {}

    def document(self) -> None:
        table: Path = ()
        while self._skip(_TRIVIA) < len(self.text):
            if self.text.startswith("[", self.at):
                table = self._header()
            else:
                self._pair(table)

    def line(self) -> int:
        self._line += self.text.count("\n", self._counted, self.at)
        self._counted = self.at
        return self._line

    def _skip(self, pattern: re.Pattern[str]) -> int:
        match = pattern.match(self.text, self.at)
        if match is None:
            raise _Lost
        self.at = match.end()
        return self.at

    def _take(self, mark: str) -> None:
        if not self.text.startswith(mark, self.at):
            raise _Lost
        self.at += len(mark)

    def _dotted(self) -> list[str]:
        parts = []
        while True:
            begin = self._skip(_BLANK)
            raw = self.text[begin : self._skip(_KEY)]
            parts.append(next(iter(tomllib.loads(f"{raw}=0"))))
            self._skip(_BLANK)
            if not self.text.startswith(".", self.at):
                return parts
            self.at += 1

    def _mark(self, above: Path, parts: list[str]) -> Path:
        """Note where a key stands; its parts may run through lists of tables, of which the last element is meant."""
        path, line = above, self.line()
        for part in parts[:-1]:
            path = self._within((*path, part))
            self.implied.setdefault(path, line)
        path = (*path, parts[-1])
        self.named.setdefault(path, line)
        return path

    def _within(self, path: Path) -> Path:
        return (*path, self._last[path]) if path in self._last else path

    def _header(self) -> Path:
        double = self.text.startswith("[[", self.at)
        self.at += 1 + double
        path = self._mark((), self._dotted())
        self._take("]]" if double else "]")
        if double:
            self._last[path] = self._last.get(path, -1) + 1
            path = (*path, self._last[path])
            self.named[path] = self.line()
        return path

    def _pair(self, table: Path) -> None:
        path = self._mark(table, self._dotted())
        self._take("=")
        self._skip(_BLANK)
        self._value(path)

    def _value(self, path: Path) -> None:
        if self.text.startswith("[", self.at):
            self._list(path)
        elif self.text.startswith("{", self.at):
            self.at += 1
            while self._more("}"):
                self._pair(path)
        else:
            self._skip(_STRING if self.text.startswith(('"', "'"), self.at) else _OTHER)

    def _list(self, path: Path) -> None:
        self.at += 1
        place = 0
        while self._more("]"):
            self.named[(*path, place)] = self.line()
            self._value((*path, place))
            place += 1

    def _more(self, end: str) -> bool:
        """Step to the next element; false behind the closing bracket."""
        self._skip(_TRIVIA)
        if self.text.startswith(",", self.at):
            self.at += 1
            self._skip(_TRIVIA)
        if self.at == len(self.text):
            raise _Lost
        if self.text.startswith(end, self.at):
            self.at += 1
            return False
        return True


def deep_key(text: str) -> int | None:
    """Line of the first key with more than `DEEPEST` parts, None when there is none; that takes as many dots in it."""
    if all(line.count(".") < DEEPEST for line in text.split("\n")):
        return None
    match = _DEEP.search(text)
    return None if match is None else text.count("\n", 0, match.start()) + 1


@lru_cache(maxsize=4)
def key_lines(text: str) -> Lines:
    """Line of every table, key and element of a list, counted from 1, by path; as far as the text is valid TOML. Many
    scenes of one text have one table of them, which nobody changes."""
    walk = _Walk(text)
    with suppress(_Lost, RecursionError, tomllib.TOMLDecodeError):
        walk.document()
    return walk.implied | walk.named


def line_of(lines: Lines, path: Path) -> int | None:
    """Line of a key, or of the nearest table that encloses it."""
    for length in range(len(path), 0, -1):
        if path[:length] in lines:
            return lines[path[:length]]
    return None


def dotted(path: Path) -> str:
    """A path as one would write it: `removal.connections[2]`, elements counted from 1, odd names in quotes."""
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part + 1}]"
        else:
            bare = re.fullmatch(r"[A-Za-z0-9_-]+", part)
            text += ("." if text else "") + (part if bare else f'"{part}"')
    return text


def given_at(document: Any, path: Path) -> Any:
    """What a scene says at that place, or None."""
    for part in path:
        if isinstance(document, dict):
            document = document.get(str(part))
        elif isinstance(document, list) and isinstance(part, int) and part < len(document):
            document = document[part]
        else:
            return None
    return document
