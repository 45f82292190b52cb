"""Two runs side by side on the terminal, and as plain data for machines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dcone_cosim.comparing.comparison import Comparison
from dcone_cosim.comparing.pairs import MISSING, Pair
from dcone_cosim.findings import SAMPLE

if TYPE_CHECKING:
    from rich.console import Console


def show(found: Comparison, console: Console) -> None:
    from rich.table import Table
    from rich.text import Text

    heads = (Text(found.names[0]), Text(found.names[1]))
    keys = Table(title="scenes differ in", title_justify="left", box=None, pad_edge=False)
    for head in ("key", *heads):
        keys.add_column(head, overflow="fold")
    for pair in found.keys:
        keys.add_row(Text(pair.key), Text(pair.one), Text(pair.other))
    if found.keys:
        console.print(keys)
    else:
        console.print("the scenes say the same", highlight=False)
    table = Table(title="figures", title_justify="left", box=None, pad_edge=False)
    table.add_column("", overflow="fold")
    for head in (*heads, "difference", "%"):
        table.add_column(head, justify="right", overflow="fold")
    table.add_column("", no_wrap=True)
    for row in found.figures:
        if not row.same:
            table.add_row(Text(row.name), *map(Text, cells(row)))
    differing = sum(not row.same for row in found.figures)
    if differing:
        console.print(table)
    console.print(f"{differing} of {len(found.figures)} figures differ", highlight=False)
    if any(row.scatter and not row.same for row in found.figures):
        console.print(f"{SAMPLE} single samples of chaotic figures: +- the standard deviation of the difference")
    same = [name for name, equal in found.tables.items() if equal]
    console.print(f"tables with the same bits: {', '.join(same) or 'none'}", highlight=False)


def cells(row: Pair) -> tuple[str, str, str, str, str]:
    """Both values, their difference, the same in percent, and the unit."""
    mark, read = SAMPLE if row.scatter else "", row.read
    one, other = (
        MISSING if v is None else v if isinstance(v, str) else f"{mark}{read.from_si(v):.6g}"
        for v in (row.one, row.other)
    )
    if row.difference is None:
        return one, other, "", "", "" if isinstance(row.one, str) or isinstance(row.other, str) else read.name
    scatter = f" +- {read.from_si(row.scatter):.2g}" if row.scatter else ""
    percent = "" if row.percent is None else f"{row.percent:+.3g}"
    return one, other, f"{read.from_si(row.difference):+.4g}{scatter}", percent, read.name


def as_dict(found: Comparison) -> dict[str, Any]:
    return {
        "first": str(found.folders[0]),
        "second": str(found.folders[1]),
        "scenes": [{"key": pair.key, "first": pair.one, "second": pair.other} for pair in found.keys],
        "figures": [row.as_dict() for row in found.figures],
        "same_tables": found.tables,
    }
