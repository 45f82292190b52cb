"""A tiny model of this project's own kind, whose part brings tables: it looks up what its input stands for.

Its kernels are numba's, so that it runs in this process and as an FMU, which is built in a few seconds.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fmu_src import tables
from fmu_src.interface import INITIALISE, SIZE, STEP, Group, Interface, Model, Term, Variable
from fmu_src.packaging import c_header, compile, link, platforms, start_values, table_file
from fmu_src.tables import Table
from orbital.kernel import entry, kernel

KEY, GUID = "{library of the lookup}", "{lookup}"
CURVE = Table("curve.knots", "1", "rows of an input and what it stands for, the inputs rising", dimensions=2)
GRID = Table("box.numbers", "m", "numbers of a box", dimensions=3)
MODEL = Model(
    name="lookup",
    summary="An input is looked up.",
    base=(Variable("grain", "N", "parameter", "added to the sum", 0.0),),
    groups={
        "curve": Group(
            {
                "linear": Term(
                    "straight between the rows of a table",
                    (
                        Variable("by_curve", "N/m", "state", "slope"),
                        Variable("u", "m", "input", "looked up"),
                        Variable("y", "N", "output", "what it stands for", partials=(("u", "by_curve"),)),
                        Variable("sum", "N", "output", "of y after every step"),
                    ),
                    tables=(CURVE,),
                )
            }
        ),
        "box": Group(
            {
                "grid": Term(
                    "shows the ends of a box of numbers",
                    (
                        Variable("corner", "m", "output", "its last number"),
                        Variable("total", "m", "output", "all of them"),
                    ),
                    tables=(GRID,),
                )
            },
            optional=True,
        ),
    },
    faults=(),
    module="tests.packaging.lookup",
    stop_time=10.0,
    macro_step=0.5,
)
CURVE_ALONE, BOTH = {"curve": "linear"}, {"curve": "linear", "box": "grid"}
KNOTS = np.array([[-1.0, 0.3], [0.0, 0.1], [0.7, 2.0], [1.5, -1.0 / 3.0]])
OTHER_KNOTS = np.array([[-1.0, 0.3], [2.0, 9.0]])
BOX = np.arange(24.0).reshape(2, 3, 4) / 7.0


def make_entry(terms: Mapping[str, str]) -> Any:
    """The entry; `sum` counts y at the start and after every step."""
    interface = MODEL.interface(terms)
    has_box = "box" in terms
    curve = tables.make_reader(interface.tables, CURVE.name)
    box = tables.make_reader(interface.tables, GRID.name) if has_box else None

    @kernel
    def look_up(p):
        rows = curve(p)
        k = 0
        while k < rows.shape[0] - 2 and p.u > rows[k + 1, 0]:
            k += 1
        p.by_curve = (rows[k + 1, 1] - rows[k, 1]) / (rows[k + 1, 0] - rows[k, 0])
        p.y = rows[k, 1] + (p.u - rows[k, 0]) * p.by_curve

    @kernel
    def show_box(p):
        numbers = box(p)
        p.corner = numbers[numbers.shape[0] - 1, numbers.shape[1] - 1, numbers.shape[2] - 1]
        p.total = 0.0
        for k in range(numbers.shape[2]):
            layer = numbers[:, :, k]
            for i in range(numbers.shape[0]):
                for j in range(numbers.shape[1]):
                    p.total += layer[i, j] / (1.0 + i + 10.0 * j + 100.0 * k)

    @entry(interface.dtype)
    def model_entry(command, instance, work, time, step):
        p = instance[0]
        if command == SIZE:
            p.work_size = 0
            return 0
        look_up(p)
        if command == INITIALISE:
            p.sum = p.grain + p.y
            if has_box:
                show_box(p)
        if command == STEP:
            p.sum += p.y
        return 0

    return model_entry


def given(terms: Mapping[str, str], curve: Any = KNOTS, grid: Any = BOX) -> Interface:
    """The interface with its tables."""
    interface = MODEL.interface(terms)
    numbers = named(curve, grid)
    return interface.with_tables({table.name: numbers[table.name] for table in interface.tables})


def named(curve: Any = KNOTS, grid: Any = BOX) -> dict[str, Any]:
    """Both tables by name."""
    return {CURVE.name: curve, GRID.name: grid}


def build(folder: Path, terms: Mapping[str, str], target: platforms.Target | None = None, key: str = KEY) -> Path:
    """Its library, for this machine or another, in the folder of an FMU that has neither values nor tables yet."""
    place = folder / "binaries" / platforms.host().places[0].folder
    place.mkdir(parents=True)
    ir, header, library = folder / "model.ll", folder / "model.h", place / "lookup.so"
    compile.emit(MODEL, terms, ir, folder / "kernels")
    header.write_text(c_header.header(MODEL.interface(terms), "lookup", key))
    link.link(ir, header, library, [target] if target else platforms.host().places[0].targets)
    return library


def furnish(folder: Path, interface: Interface, key: str = KEY, guid: str = GUID) -> None:
    """Write values and tables into the folder of an FMU."""
    for path, content in (
        (start_values.PATH, start_values.content(interface, key, guid)),
        (table_file.PATH, table_file.content(interface)),
    ):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(content)
