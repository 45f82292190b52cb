"""A foreign FMU whose parameter may change while it steps: a run of it goes on with another value.

The FMU of the C template has the pair drift apart, place = start + rate x time: with another rate from 50 s on, the
rows up to there are those of the first rate, and all after them those of the second.
"""

from __future__ import annotations

import json
from pathlib import Path

import pyarrow.parquet
import pytest

from dcone_cosim.errors import InputError
from tests.cases.conftest import SCENE
from tests.cosim.fmus.build import build
from tests.runs import put, tables

RATE = '"start.relative_velocity[2]"'
FASTER = "removal.start.relative_velocity=['0 m/s', '2 mm/s', '0 m/s']"


def tunable(xml: str) -> str:
    """Its description with a rate that may change."""
    head, name, rest = xml.partition(f"name={RATE}")
    assert name
    return head + name + rest.replace('variability="fixed"', 'variability="tunable"', 1)


def kept(folder: Path, *switches: str, isolate: bool = False, fixed: bool = False) -> Path:
    """A run of the FMU that has kept its state at 50 s."""
    build(folder, "removal", *switches, change=(lambda xml: xml) if fixed else tunable)
    scene = folder / "drift.toml"
    scene.write_text(SCENE.replace("isolate = false", f"isolate = {str(isolate).lower()}"))
    return put(scene, folder / "kept", save_at=("50 s",))


def separation(folder: Path) -> dict[float, float]:
    """Distance by time [m]."""
    table = pyarrow.parquet.read_table(folder / "removal.parquet", columns=["time", "separation"])
    return dict(zip(table["time"].to_pylist(), table["separation"].to_pylist(), strict=True))


@pytest.mark.parametrize("isolate", [False, True], ids=["in our process", "in its own"])
def test_a_run_goes_on_with_another_value(isolate: bool, tmp_path: Path) -> None:
    first = kept(tmp_path, "TUNES", isolate=isolate)
    on = put(first, tmp_path / "on", (FASTER,), go_on="50 s")
    found, before = separation(on), separation(first)
    assert list(found) == [10.0 * i for i in range(11)]
    for time, distance in found.items():
        assert distance == pytest.approx(10.0 + time * (1e-3 if time <= 50.0 else 2e-3), abs=1e-12)
        assert (distance == before[time]) == (time <= 50.0)
    told = json.loads((on / "provenance.json").read_text())["gone_on"]
    assert told["changed"] == {"start.relative_velocity[2]": 2e-3}
    assert tables(put(first, tmp_path / "same", go_on="50 s")) == tables(first), "and with none, as it was"


def test_what_is_changed_and_longer(tmp_path: Path) -> None:
    """With another duration too, and from a state that the changed run kept."""
    first = kept(tmp_path, "TUNES")
    on = put(first, tmp_path / "on", (FASTER, "removal.duration=200 s"), ("150 s",), "50 s")
    assert separation(on)[200.0] == pytest.approx(10.4, abs=1e-12)
    again = put(on, tmp_path / "again", go_on="150 s")
    assert tables(again) == tables(on)


def test_a_fixed_one_is_refused_and_so_is_one_that_is_not_taken(tmp_path: Path) -> None:
    for name, switches, fixed, told in (
        ("fixed", ("TUNES",), True, "fixed parameter"),
        ("lies", (), False, "no such Real can be set now"),
    ):
        folder = tmp_path / name
        folder.mkdir()
        first = kept(folder, *switches, fixed=fixed)
        with pytest.raises(InputError, match=told):
            put(first, folder / "on", (FASTER,), go_on="50 s")
        assert not (folder / "on").exists()
