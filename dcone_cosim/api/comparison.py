"""Two runs at hand side by side."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from dcone_cosim.api.pictures import Picture
from dcone_cosim.api.result import Run
from dcone_cosim.api.running import load_run
from dcone_cosim.comparing import commands, comparison, plot, show
from dcone_cosim.errors import InputError
from dcone_cosim.scratch import Scratch

if TYPE_CHECKING:
    import pandas as pd


class Comparison:
    """What differs between two runs: `figures` and `scenes` are tables, `picture` shows their histories."""

    def __init__(self, found: comparison.Comparison) -> None:
        self._found = found

    @property
    def figures(self) -> pd.DataFrame:
        """Every figure of both: first, second, difference (second less first), percent, unit, scatter."""
        import pandas as pd

        return pd.DataFrame([row.as_dict() for row in self._found.figures]).set_index("figure")

    @property
    def scenes(self) -> pd.DataFrame:
        """Keys in which the scenes differ, as each says them."""
        import pandas as pd

        rows = [(pair.key, pair.one, pair.other) for pair in self._found.keys]
        return pd.DataFrame(rows, columns=["key", "first", "second"]).set_index("key")

    @property
    def same_tables(self) -> list[str]:
        """Tables that have the same bits in both."""
        return [name for name, same in self._found.tables.items() if same]

    def picture(self) -> Picture:
        """Tension of the tows and mouth area of the captures; `InputError` where they have neither in common."""
        found = self._found
        with Scratch.temporary() as folder:
            path = folder / "compare.png"
            reason = plot.draw(list(zip(found.names, found.runs, strict=True)), found.title, path)
            if reason:
                raise InputError(reason)
            return Picture(path.name, path.read_bytes())

    def _repr_html_(self) -> str:
        heads = "".join(f"<th>{escape(head)}</th>" for head in ("", *self._found.names, "difference", "%", ""))
        keys = "".join(
            f"<tr><td>{escape(pair.key)}</td><td>{escape(pair.one)}</td><td>{escape(pair.other)}</td></tr>"
            for pair in self._found.keys
        )
        rows = "".join(
            f"<tr><td>{escape(row.name)}</td>{''.join(f'<td>{escape(cell)}</td>' for cell in show.cells(row))}</tr>"
            for row in self._found.figures
            if not row.same
        )
        return f"<table>{keys}</table><table><tr>{heads}</tr>{rows}</table>"

    def __repr__(self) -> str:
        differing = sum(not row.same for row in self._found.figures)
        return f"<Comparison: {self._found.title}, {differing} of {len(self._found.figures)} figures differ>"


def compare(one: Run | str | Path, other: Run | str | Path) -> Comparison:
    """Set two runs side by side, at hand or in their folders."""
    first, second = (given if isinstance(given, Run) else load_run(given) for given in (one, other))
    told = zip((first, second), ("first", "second"), strict=True)
    names = [which if run.folder is None else run.folder.absolute().name for run, which in told]
    if names[0] == names[1]:
        names = [f"{name} ({which})" for name, which in zip(names, ("first", "second"), strict=True)]
    return Comparison(
        commands.beside((first.folder, second.folder), (names[0], names[1]), (first.result, second.result))
    )
