"""The table of all cases, and which figures of it are shown."""

from __future__ import annotations

import math

import pandas as pd

from dcone_cosim.cases.case import Value
from dcone_cosim.cases.chief import chief
from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.show import failures, short
from dcone_cosim.cases.table import Column, Entry, as_arrow, columns, timings, write

UNITS = {"removal.tugs": "1", "removal.tension_mean": "N", "capture.t80": "s"}


def entry(number: int, given: Value, **more: float | int | str) -> Entry:
    figures = {name.replace("__", "."): value for name, value in more.items()}
    return Entry(Row(f"k{number}", "completed", 0, "", figures, UNITS, {"cpu": 0.5}), {"removal.x": given})


ENTRIES = [
    entry(0, Value("1 m", 1.0, "m"), capture__t80=4.0, removal__tugs=3, removal__tension_mean=0.5),
    entry(1, Value("2 m", 2.0, "m"), removal__tugs=5, removal__tension_mean="not told"),
    entry(2, Value("3 m", 3.0, "m"), removal__tugs=5, removal__tension_mean=math.nan, removal__end="towed"),
    Entry(Row("k3", "FMU failed", 5, "it broke\nhere"), {"removal.x": Value("4 m", 4.0, "m")}),
]


def column(name: str) -> Column:
    return next(column for column in columns(ENTRIES) if column.name == name)


def test_columns_and_their_kinds() -> None:
    names = [column.name for column in columns(ENTRIES)]
    assert names == [
        *("removal.x", "given.removal.x", "status", "exit_code", "message", "capture.t80", "removal.tugs"),
        *("removal.tension_mean", "removal.tension_mean.told", "removal.end", "key"),
    ]
    assert column("removal.tugs").values == [3, 5, 5, None]
    assert column("removal.tension_mean.told").values == [None, "not told", None, None]
    assert column("removal.end").values == [None, None, "towed", None]
    assert column("removal.x").unit == "m"


def test_what_is_not_there_is_not_the_same_as_what_is_no_number() -> None:
    table = as_arrow(columns(ENTRIES))
    tension = table["removal.tension_mean"]
    assert [value.is_valid for value in tension] == [True, False, True, False]
    assert math.isnan(tension[2].as_py())
    assert (str(table.schema.field("removal.tugs").type), str(tension.type)) == ("int64", "double")


def test_the_order_of_columns_does_not_hang_on_which_case_came_first() -> None:
    for entries in (ENTRIES, ENTRIES[::-1]):
        names = [column.name for column in columns(entries)]
        assert names.index("removal.tugs") < names.index("removal.tension_mean") < names.index("removal.end")


def test_values_of_different_units_have_no_number() -> None:
    names = [c.name for c in columns([entry(0, Value("1 m", 1.0, "m")), entry(1, Value("1 s", 1.0, "s"))])]
    assert "removal.x" not in names
    assert "given.removal.x" in names


def test_a_figure_called_as_a_key_is_told_apart() -> None:
    names = [c.name for c in columns([entry(0, Value("1 m", 1.0, "m"), removal__x=7.0)])]
    assert names.count("removal.x") == 1
    assert "result.removal.x" in names


def test_files(tmp_path) -> None:
    write(ENTRIES, tmp_path)
    table = pd.read_parquet(tmp_path / "table.parquet")
    assert table.attrs["units"]["removal.tension_mean"] == "N"
    assert table["message"][3] == "it broke\nhere"
    again = pd.read_csv(tmp_path / "table.csv")
    assert again["removal.x [m]"].tolist() == [1.0, 2.0, 3.0, 4.0]
    assert again["message"][3] == "it broke\nhere"
    assert [c.name for c in timings(ENTRIES)] == ["key", "cpu"]
    assert timings(ENTRIES)[1].values == [0.5, 0.5, 0.5, None]


def test_chief_figures_are_those_that_change() -> None:
    cases = [
        entry(n, Value(f"{n} m", float(n), "m"), removal__tugs=3, removal__steps=n, removal__later=n / 2,
              removal__tension_mean=1.0 + n, removal__end="towed")
        for n in range(2)
    ]  # fmt: skip
    assert [c.name for c in chief(columns(cases), 6)] == ["removal.tension_mean", "removal.later"]
    assert [c.name for c in chief(columns(cases), 1)] == ["removal.tension_mean"]


def test_failures_are_told_with_their_values() -> None:
    assert failures(ENTRIES) == ["removal.x = 4 m: it broke\nhere"]
    many = [Entry(Row(str(n), "lost", 1, "gone"), {}, n) for n in range(8)]
    assert failures(many)[-1] == "and 3 more failed; the table has the reason of each"
    assert failures(many)[0] == "seed 0: gone"


def test_short() -> None:
    assert short("17.6135912115 m") == "17.6136 m"
    assert short("0.05") == "0.05"
    assert short('["0 m/s","2 mm/s"]') == '["0 m/s","2 mm/s"]'
