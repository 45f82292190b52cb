"""The figures of a run by name, each with its unit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

from dcone_cosim.findings import SAMPLE, Finding
from dcone_cosim.names import did_you_mean
from dcone_cosim.units import spoken

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Figure:
    """One figure of a run.

    name     "removal.first_tug_peak"
    value    SI, or a text
    unit     SI, "" for a pure number or a text
    label    what it is
    spread   standard deviation over mean, where it is one sample of a chaotic figure; 0 where all digits hold     [1]
    shown    as a person reads it, with the digits that hold
    """

    name: str
    value: float | int | str
    unit: str
    label: str
    spread: float
    shown: str

    def __float__(self) -> float:
        return float(self.value)

    @property
    def quantity(self) -> Any:
        """The same as an astropy Quantity."""
        return quantity(float(self), self.unit)

    def __str__(self) -> str:
        return self.shown


def quantity(value: Any, unit: str) -> Any:
    """A number or an array with a unit of FMI, such as "N.m.s", as an astropy Quantity."""
    from astropy import units

    return units.Quantity(value, units.Unit(spoken(unit) if not unit.startswith("1/") else unit))


class Summary(Mapping[str, Figure]):
    """The figures of a run, by PHASE.FIGURE; a table where it is shown."""

    def __init__(self, findings: Sequence[Finding]) -> None:
        self._figures = {
            f"{row.phase}.{row.key}": Figure(
                f"{row.phase}.{row.key}", row.value, row.unit, row.label, row.spread, row.shown()
            )
            for row in findings
        }

    def __getitem__(self, name: str) -> Figure:
        if name not in self._figures:
            raise KeyError(f"no figure {name!r}{did_you_mean(name, self._figures)}")
        return self._figures[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._figures)

    def __len__(self) -> int:
        return len(self._figures)

    def frame(self) -> pd.DataFrame:
        """All of them as a table: value (SI), unit, label, spread; by name."""
        import pandas as pd

        columns = ("value", "unit", "label", "spread")
        rows = {name: [getattr(row, column) for column in columns] for name, row in self._figures.items()}
        return pd.DataFrame.from_dict(rows, orient="index", columns=list(columns))

    def __repr__(self) -> str:
        width = max(map(len, self._figures), default=0)
        return "\n".join(f"{name:{width}}  {row.shown}" for name, row in self._figures.items())

    def _repr_html_(self) -> str:
        rows, before = [], ""
        for name, row in self._figures.items():
            phase = name.partition(".")[0]
            head = f"<b>{escape(phase)}</b>" if phase != before else ""
            before = phase
            cells = (head, escape(row.label), f'<div style="text-align:right">{escape(row.shown)}</div>')
            rows.append(f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}<td><code>{escape(name)}</code></td></tr>")
        some = any(row.spread for row in self._figures.values())
        foot = f"<p>{SAMPLE} one sample of a chaotic figure, with the digits that hold</p>" if some else ""
        return f"<table>{''.join(rows)}</table>{foot}"
