"""What a run tells of the chaser's thruster and wheels, against sums over its rows."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from dcone_cosim.phases.chaser_report import of_chaser
from dcone_cosim.results import PhaseResult
from tests.cosim.test_released import Rows

G0 = 9.80665


def told(columns: dict[str, Any], **values: float) -> dict[str, float]:
    count = len(next(iter(columns.values())))
    rows = Rows({"time": 100.0 * np.arange(count)} | {name: np.asarray(column) for name, column in columns.items()})
    result = cast(PhaseResult, SimpleNamespace(recorder=rows))
    given = {key.replace("__", "."): value for key, value in values.items()}
    return {found.key: float(found.value) for found in of_chaser("removal", result, given)}


def test_an_electric_thruster_with_a_plume() -> None:
    """20 N for 300 s and 10 N for 100 s more, every 100 s; the share on the target falls by halves."""
    used = np.array([0.0, 20.0 * 100, 20.0 * 200, 20.0 * 300, 20.0 * 300 + 10.0 * 100]) / (1500.0 * G0)
    share = np.array([0.8, 0.4, 0.2, 0.1, 0.05])
    found = told(
        {
            "chaser.propellant": used,
            "thrust.force": [-20.0, -20.0, -20.0, -10.0, -10.0],
            "plume.share": share,
            "plume.on_line": [True, True, False, False, True],
            "engine.propellant_left": 50.0 - used,
            "engine.limited": [False, False, True, False, False],
        },
        thrust__specific_impulse=1500.0,
        engine__efficiency=0.5,
    )
    assert found["thrust_impulse"] == pytest.approx(7000.0)
    # jet power F v/2 over the efficiency
    assert found["engine_energy"] == pytest.approx(7000.0 * 1500.0 * G0 / 2.0 / 0.5)
    assert found["plume_impulse"] == pytest.approx(2000.0 * (0.6 + 0.3 + 0.15) + 1000.0 * 0.075)
    assert found["plume_on_line"] == pytest.approx((2000.0 + 1000.0) / 7000.0)
    assert found["propellant_left"] == pytest.approx(50.0 - 7000.0 / (1500.0 * G0))
    assert found["engine_limited"] == pytest.approx(0.2)


def test_wheels() -> None:
    axes = {f"aocs.torque[{k}]": [0.0, 0.03 * k, 0.0] for k in (1, 2, 3)}
    axes |= {f"aocs.momentum[{k}]": [0.0, 1.0, 2.0] for k in (1, 2, 3)}
    found = told({**axes, "aocs.deviation": [0.0, 0.2, 0.1], "aocs.limited": [False, True, True]})
    assert found["aocs_torque"] == pytest.approx(0.03 * np.sqrt(14.0))
    assert found["aocs_momentum"] == pytest.approx(2.0 * np.sqrt(3.0))
    assert found["aocs_deviation"] == 0.2
    assert found["aocs_limited"] == pytest.approx(2.0 / 3.0)


def test_of_a_plain_tow_nothing_is_added() -> None:
    assert told({"chaser.propellant": [0.0, 1.0]}, thrust__specific_impulse=220.0) == {}
