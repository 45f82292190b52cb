"""What a sizing comes to: an answer in sentences, and the parts of its report as tables."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dcone_cosim.errors import SUCCESS
from dcone_cosim.sizing.section import Section
from dcone_cosim.sizing.study import Study

if TYPE_CHECKING:
    import pandas as pd


@dataclass
class Sizing:
    """What a sizing came to.

    said        the answer in sentences
    sections    parts of the report, in their order
    study       all that was found, of a scene
    folder      where it is, None for nowhere
    """

    title: str
    said: list[str]
    sections: list[Section]
    study: Study | None = None
    folder: Path | None = None
    notes: list[str] = field(default_factory=list)

    @property
    def exit_code(self) -> int:
        return SUCCESS

    def __getitem__(self, key: str) -> pd.DataFrame:
        """A part as a table of pandas, SI: `sizing["required"]`; units in `attrs["units"]`."""
        return next(one for one in self.sections if one.key == key).frame()

    def keys(self) -> list[str]:
        """Names of the parts."""
        return [one.key for one in self.sections]

    def told(self) -> dict[str, Any]:
        """For machines."""
        return {"title": self.title, "said": self.said, "parts": {one.key: one.told() for one in self.sections}}
