"""A run at hand: its columns, figures, events and ledger, whether it was run just now or read back from a folder."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dcone_cosim.api.pictures import Pictures, drawn
from dcone_cosim.api.summary import Summary, quantity
from dcone_cosim.drafts import atomic_folder, check_free
from dcone_cosim.errors import SUCCESS
from dcone_cosim.names import did_you_mean
from dcone_cosim.phases import kind_of
from dcone_cosim.reports import summary
from dcone_cosim.reports.figures import draw_all
from dcone_cosim.reports.warnings import warnings
from dcone_cosim.results import RunResult
from dcone_cosim.run_folder import fill, tables_of

if TYPE_CHECKING:
    import pandas as pd


class Run(Mapping[str, "pd.DataFrame"]):
    """What a run found.

        run["removal"]["tether.tension"]     a column, in SI; run["removal"].attrs["units"] tells the units
        run["tugs"], run["nodes"]            every tug; snapshots of the net
        run.quantity("removal", "altitude")  a column as an astropy Quantity
        run.summary["removal.first_tug_peak"].value

    Its tables are those of a run folder, by the same names.

    result    all of it, as the master leaves it
    folder    that it was read from or saved to, None for a run that is nowhere yet
    notes     what to tell of it
    """

    def __init__(
        self,
        result: RunResult,
        facts: Mapping[str, Mapping[str, Any]],
        started: datetime | None = None,
        notes: tuple[str, ...] = (),
        folder: Path | None = None,
    ) -> None:
        self.result, self.notes, self.folder = result, notes, folder
        self._facts, self._started = facts, started if started is not None else datetime.now(UTC)
        self._arrow = dict(tables_of(result))
        self._frames: dict[str, pd.DataFrame] = {}
        self._pictures: Pictures | None = None

    @property
    def title(self) -> str:
        return self.result.scene.title

    @property
    def status(self) -> str:
        """ "completed", or how it ended; `message` says why."""
        return self.result.status

    @property
    def message(self) -> str:
        return self.result.message

    @property
    def succeeded(self) -> bool:
        return self.result.exit_code == SUCCESS

    @property
    def warnings(self) -> tuple[str, ...]:
        """What one may not expect of it."""
        return tuple(warnings(self.result))

    def __getitem__(self, name: str) -> pd.DataFrame:
        if name not in self._arrow:
            raise KeyError(f"no table {name!r}{did_you_mean(name, self._arrow)}")
        if name not in self._frames:
            table = self._arrow[name]
            frame = table.to_pandas()
            frame.attrs = json.loads(table.schema.metadata[b"PANDAS_ATTRS"])
            self._frames[name] = frame
        return self._frames[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrow)

    def __len__(self) -> int:
        return len(self._arrow)

    def unit(self, table: str, column: str) -> str:
        """Of a column, SI; "1" for a pure number."""
        units: dict[str, str] = self[table].attrs["units"]
        if column not in units:
            raise KeyError(f"{table} has no column {column!r}{did_you_mean(column, units)}")
        return units[column]

    def quantity(self, table: str, column: str) -> Any:
        """A column as an astropy Quantity."""
        unit = self.unit(table, column)
        return quantity(self[table][column].to_numpy(), "" if unit == "1" else unit)

    @property
    def summary(self) -> Summary:
        """The figures that `dcone run` prints."""
        return Summary(summary.findings(self.result))

    @property
    def events(self) -> pd.DataFrame:
        """What happened: phase, event, time by the phase's own clock, and of a tug its peak and speed."""
        import pandas as pd

        found = [
            vars(event) for name, r in self.result.phases.items() for event in kind_of(name).events(self.result, r)
        ]
        frame = pd.DataFrame(found, columns=["phase", "what", "time", "peak", "speed"])
        frame.attrs["units"] = {"time": "s", "peak": "N", "speed": "m/s"}
        frame.attrs["clocks"] = {name: kind_of(name).clock(self.result) for name in self.result.phases}
        return frame

    @property
    def ledger(self) -> pd.DataFrame:
        """The balance at every hand-over: a row for each conserved quantity; empty without a hand-over."""
        import pandas as pd

        rows = [
            {"handed_to": name, **row.as_dict()}
            for name, handover in self.result.handovers.items()
            for row in handover.rows
        ]
        return pd.DataFrame(rows)

    def figures(self) -> Pictures:
        """The figures of a run folder, as pictures: drawn once, shown in a notebook."""
        if self._pictures is None:
            self._pictures = drawn(self.result)
        return self._pictures

    def save(self, folder: str | Path, force: bool = False, csv: bool = False, figures: bool = True) -> Path:
        """Write the run folder that `dcone run -o` writes, whole or not at all; returns where it is.

        force    replace the run that is there
        csv      write the columns as CSV too;  figures  draw the figures
        """
        folder = Path(folder)
        check_free(folder, force)
        with atomic_folder(folder, force) as draft:
            if self.folder is not None:
                shutil.copytree(self.folder, draft.path, dirs_exist_ok=True)
            else:
                told = summary.as_dict(self.result)
                draw = (lambda path: draw_all(self.result, path, False)) if figures else None
                fill(draft.path, self.result, self._facts, told, self._started, csv, draw)
        self.folder = draft.folder
        return draft.folder

    def __repr__(self) -> str:
        return f"<Run of {self.result.scene.name}, {self.status}: {', '.join(self)}>"

    def _repr_html_(self) -> str:
        told = [
            f"<b>{escape(self.title)}</b><p>{escape(self.status)}{escape(self.message and f': {self.message}')}</p>"
        ]
        told += [f"<p>warning: {escape(warning)}</p>" for warning in self.warnings]
        tables = ", ".join(f"{escape(name)} ({table.num_rows:,} rows)" for name, table in self._arrow.items())
        return "".join([*told, self.summary._repr_html_(), f"<p>tables: {tables}</p>"])
