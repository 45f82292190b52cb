"""Figures of a run as pictures that a notebook shows where they stand."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from dcone_cosim.names import did_you_mean
from dcone_cosim.reports.figures import draw_all
from dcone_cosim.results import RunResult
from dcone_cosim.scratch import Scratch


@dataclass(frozen=True)
class Picture:
    """One figure: its file's name, and the PNG."""

    name: str
    png: bytes

    def save(self, path: str | Path) -> Path:
        """Write it to a file, whole; an earlier one gives way."""
        path = Path(path)
        with Scratch(path.absolute().parent) as folder:
            draft = folder / path.name
            draft.write_bytes(self.png)
            draft.replace(path)
        return path

    def _repr_png_(self) -> bytes:
        return self.png

    def __repr__(self) -> str:
        return f"<Picture {self.name}, {len(self.png):,} bytes>"


class Pictures(Sequence[Picture]):
    """The figures of a run, by place or by name; all of them where they are shown.

    notes    what could not be drawn, and why
    """

    def __init__(self, pictures: Sequence[Picture], notes: Sequence[str]) -> None:
        self._pictures, self.notes = tuple(pictures), tuple(notes)

    def __getitem__(self, which: int | str) -> Picture:  # type: ignore[override]
        if isinstance(which, str):
            found = {picture.name.removesuffix(".png"): picture for picture in self._pictures}
            name = which.removesuffix(".png")
            if name not in found:
                raise KeyError(f"no figure {which!r}{did_you_mean(name, found)}")
            return found[name]
        return self._pictures[which]

    def __len__(self) -> int:
        return len(self._pictures)

    def __iter__(self) -> Iterator[Picture]:
        return iter(self._pictures)

    def __repr__(self) -> str:
        return f"<{len(self)} figures: {', '.join(picture.name for picture in self)}>"

    def _repr_html_(self) -> str:
        parts = [
            f'<figure><img alt="{escape(p.name)}" src="data:image/png;base64,{base64.b64encode(p.png).decode()}"/>'
            "</figure>"
            for p in self._pictures
        ]
        return "".join([*parts, *(f"<p>{escape(note)}</p>" for note in self.notes)])


def drawn(run: RunResult) -> Pictures:
    """Draw the figures that there is data for."""
    with Scratch.temporary() as folder:
        notes = draw_all(run, folder, aside=False)
        files = sorted(folder.glob("*.png"))
        return Pictures([Picture(path.name, path.read_bytes()) for path in files], notes)
