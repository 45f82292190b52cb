"""What a run tells of a line that conducts, of which a part may be without a line."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from dcone_cosim.phases.removal_report import _of_environment
from dcone_cosim.results import PhaseResult
from tests.cosim.test_released import Rows

POWER = {"electrodynamic.power": [100.0, 200.0, 300.0, 0.0, 0.0], "electrodynamic.orbit_power": [110.0] * 3 + [0.0] * 2}


def means(**flags: list[bool]) -> dict[str, tuple[float, str]]:
    columns: dict[str, Any] = {name: np.asarray(column) for name, column in POWER.items()}
    columns |= {f"electrodynamic.{name}": np.ones(5) for name in ("emf", "current", "force")}
    columns |= {name.replace("__", "."): np.asarray(column) for name, column in flags.items()}
    rows = Rows({"time": 60.0 * np.arange(5.0)} | columns)
    result = cast(PhaseResult, SimpleNamespace(recorder=rows, start=0.0, end=240.0))
    found = _of_environment("removal", result, {})
    return {one.key.split("_", 1)[1]: (float(one.value), one.label) for one in found if one.unit == "W"}


@pytest.mark.parametrize("how", ["release__released", "break__broken"])
def test_its_powers_are_means_while_it_is_whole(how: str) -> None:
    """Not diluted by the rows after it was cut or broke; of a line that holds, of all rows."""
    parted = means(**{how: [False, False, False, True, True]})
    assert {key: value for key, (value, _) in parted.items()} == {"power": 200.0, "orbit_power": 110.0}
    assert all("until the line" in label for _, label in parted.values())
    whole = means(**{how: [False] * 5})
    assert whole["orbit_power"][0] == pytest.approx(110.0 * 2.5 / 4.0)
    assert "until" not in whole["power"][1]
    assert means() == whole
