"""One component of a scene, as far as it is known: what it is, which keys it has, and what the scene says of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path as File
from typing import TYPE_CHECKING, Any

from dcone_cosim import build
from dcone_cosim.scene.data import TableFile
from dcone_cosim.scene.expected import TEXT
from dcone_cosim.scene.toml_lines import Path
from dcone_cosim.scenes.keys import Key, Slot
from dcone_cosim.scenes.lines import keys_of

if TYPE_CHECKING:
    from dcone_cosim.fmu.archive import Archive


@dataclass
class ReadComponent:
    """A component with its keys.

    path         of its table: ("capture",), or ("removal", "components", "controller")
    model        of ours, which a scene may still describe when an FMU takes its place; None for any other FMU
    terms        of our model that the scene names
    fmu          the file, None for a model of ours
    reserved     keys of its table that are no parameters
    keys         by the name a scene gives them: "bullets.speed"
    slots        every scalar variable, for connections
    archive      of the FMU, closed again: its model description is read
    given        where the value of each variable was given
    following    groups whose term follows from the values
    refused      groups whose term does not go with others: nothing is said of their keys
    unsure       groups whose term follows from files that make no sense: nothing is said of their values
    texts        that the scene gives to Strings, by variable
    files        tables that our model reads, by name, which a scene gives as the path of a file or entry by entry
    tables       those that it gives as files
    sources      those of which parts make what their kernels read
    lines        that it has, by the table of the scene that says what they are made of
    """

    path: Path
    name: str
    model: build.Model | None = None
    terms: dict[str, str] = field(default_factory=dict)
    fmu: File | None = None
    reserved: frozenset[str] = frozenset()
    keys: dict[str, Key] = field(default_factory=dict)
    slots: dict[str, Slot] = field(default_factory=dict)
    archive: Archive | None = None
    given: dict[str, Path] = field(default_factory=dict)
    following: list[str] = field(default_factory=list)
    refused: set[str] = field(default_factory=set)
    unsure: set[str] = field(default_factory=set)
    texts: dict[str, str] = field(default_factory=dict)
    files: dict[str, build.Table] = field(default_factory=dict)
    tables: dict[str, TableFile] = field(default_factory=dict)
    sources: dict[str, Any] = field(default_factory=dict)
    unnamed: set[str] = field(default_factory=set)
    lines: dict[str, build.Line] = field(default_factory=dict)

    @property
    def groups(self) -> Mapping[str, build.Group]:
        return self.model.groups if self.model is not None else {}

    def selects(self, names: tuple[str, ...]) -> bool:
        """Whether a key chooses a term of our model."""
        return any(names == (group.table or name, group.selector) for name, group in self.groups.items())

    def instead(self, table: str, key: str, value: object) -> str:
        """Which key of a table chooses its term, in words, where one that is not known may have been meant for it: the
        key that chooses in another table, or a value that is one of its terms; else nothing."""
        elsewhere = {group.selector for model in build.CATALOGUE.values() for group in model.groups.values()}
        for name, group in self.groups.items():
            meant = key in elsewhere or (isinstance(value, str) and value in group.terms)
            if (group.table or name) == table and len(group.terms) > 1 and meant:
                return f": {group.selector} chooses, one of {', '.join(group.terms)}"
        return ""

    def holds(self, table: str) -> bool:
        """Whether a name is that of a table of keys."""
        return table in self.lines or any(name.startswith(table + ".") for name in (*self.keys, *self.files))

    def of_line(self, names: tuple[str, ...]) -> bool:
        """Whether a key says what a line is made of."""
        line = self.lines.get(names[0]) if len(names) == 2 else None
        return line is not None and names[1] in keys_of(line, self.keys)

    def defaults(self) -> dict[str, float]:
        numbers = [key for key in self.keys.values() if key.expected.kind != TEXT]
        return {n: s for key in numbers for n, s in zip(key.names, key.starts, strict=True)}

    def known(self) -> dict[str, Any]:
        """What its model may be asked with: those, and the numbers of its tables, as far as they could be read."""
        return {**self.defaults(), **{name: table.numbers for name, table in self.tables.items()}}

    def choices(self) -> dict[str, tuple[str, ...]]:
        return {key.names[0]: key.expected.choices for key in self.keys.values() if key.expected.choices}
