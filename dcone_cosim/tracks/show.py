"""Tracks and fits as tables on the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dcone_cosim.tracks.comparing import overall
from dcone_cosim.units import spoken

if TYPE_CHECKING:
    from rich.console import Console

    from dcone_cosim.tracks.commands import Laid


def show(laid: Laid, console: Console) -> None:
    """Values and their intervals, where there was a fit; then how far each marker is off."""
    from rich.table import Table
    from rich.text import Text

    if laid.fit is not None:
        values = Table(box=None, pad_edge=False)
        for head in ("value", "start", "found", "from", "to (about 95 %)"):
            values.add_column(head, justify="left" if head == "value" else "right")
        values.add_column("")
        for one in laid.fit.estimates:
            fitted = (f"{number:.6g}" for number in (one.start, one.value, one.low, one.high))
            unit = laid.content["values"][one.name]["unit"]
            values.add_row(Text(one.name), *fitted, spoken(unit) if unit != "1" else "")
        console.print(values)
        console.print(
            f"a coordinate is off by {laid.fit.before:.4g} m before, {laid.fit.after:.4g} m after; "
            f"runs scatter by {laid.fit.scatter:.2g} m",
            highlight=False,
        )
    table = Table(box=None, pad_edge=False)
    for head in ("marker", "instants", "rms [m]", "largest [m]", "at [s]"):
        table.add_column(Text(head), justify="left" if head == "marker" else "right")  # not markup: units stay
    for found in laid.found:
        row = found.told()
        numbers = [f"{row[key]:.4g}" if key in row else "" for key in ("rms", "largest", "largest_at")]
        table.add_row(Text(row["marker"]), f"{row['compared']} of {row['compared'] + row['left_out']}", *numbers)
    console.print(table)
    console.print(f"all together {overall(laid.found):.4g} m", highlight=False)
