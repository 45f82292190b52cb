"""The removal by every scheme: the first five tugs of Table 2, and steps that know nothing of communication points."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fmu_src.tethered_deorbit as package
from fmu_src.tethered_deorbit.interface import MODEL
from tests.consistency.test_table2 import REFERENCE
from tests.plain import PlainInstance, plain
from tests.tethered_deorbit.evidence import schemes as evidence
from tests.validation import Validated, other_code

__all__ = ["plain"]

uncompiled = pytest.mark.usefixtures("plain")
COARSE = {"solver.tolerance_orbit": 1e-3, "solver.tolerance_separation": 1e-8, "solver.tolerance_stretch": 1e-9}
"""As much as the reference asks for, and no more: plain Python is slow."""


def tow(scheme: str, parameters: dict[str, Any]) -> PlainInstance:
    terms = {"reel": "locked", "thrust": "along_track", "solver": scheme}
    return PlainInstance(MODEL, terms, (COARSE if scheme == "radau" else {}) | parameters)


@pytest.mark.parametrize(("scheme", "case"), [("dop853", "A"), ("gauss", "A"), ("radau", "B")])
@uncompiled
def test_first_five_tugs(validated: Validated, scheme: str, case: str) -> None:
    """Times to 1e-4 s, speeds and peaks to 1e-5, of the reference in quadruple precision; another thrust has others."""
    zeta, events, _ = REFERENCE[case]
    expected = np.array(events)

    def found(last: int, **changed: float) -> np.ndarray:
        i = tow(scheme, {"tether.damping_ratio": zeta} | {k.replace("__", "."): v for k, v in changed.items()})
        i.step(expected[last - 1, 0] + 1.5)
        count = int(i["tether.tug_count"])
        return np.array([i.array("tug_" + f)[:count][::-1] for f in ("time", "speed", "peak")]).T[:last]

    got = found(5)
    taylor, tow_of = other_code("quadruple-precision Taylor integration, absolute coordinates"), f"Table 2 by {scheme}"
    validated(taylor, f"{tow_of}: times of five tugs", got[:, 0], expected[:, 0], "s", abs=1e-4)
    validated(taylor, f"{tow_of}: speeds of five tugs", got[:, 1], expected[:, 1], "m/s", rel=1e-5)
    validated(taylor, f"{tow_of}: peaks of five tugs", got[:, 2], expected[:, 2], "N", rel=1e-5)
    difference = found(1, thrust__level=-0.0101) - expected[:1]
    assert abs(difference[:, 0]).max() > 1e-4
    assert abs(difference[:, 1:] / expected[:1, 1:]).max() > 1e-5


@pytest.mark.parametrize("scheme", ["gauss", "radau"])
@uncompiled
def test_the_same_bits_whatever_the_macro_step(scheme: str) -> None:
    """Through a tug: what the steps carry lies in the work memory, also that of iterations."""
    start = {"start.separation": 11.9999, "start.condition": 1, "thrust.level": -5.0, "tether.damping_ratio": 0.2}
    runs = [tow(scheme, COARSE | start) for _ in range(2)]
    runs[0].step(2.0)
    for _ in range(8):
        runs[1].step(0.25)
    assert runs[0]["tether.tug_count"] == 1
    for field in ("relative_position", "relative_velocity", "tug_time", "tug_peak", "tether_impulse", "solver_steps"):
        assert np.array_equal(runs[0].record[field], runs[1].record[field])
    other = tow(scheme, COARSE | start | {"thrust.level": -5.0000001})
    other.step(2.0)
    assert not np.array_equal(runs[0].record["relative_position"], other.record["relative_position"])


ORDERS = {"dop853": 8, "gauss": 8, "radau": 5}


@pytest.mark.parametrize("scheme", ORDERS)
@uncompiled
def test_loss_of_order_at_slack_and_taut(scheme: str) -> None:
    """Steps that end on the changes keep the order of smooth motion; stepped over, changes cost all but about two."""
    found = evidence.orders(scheme, 4)
    assert found["smooth"] == pytest.approx(ORDERS[scheme], abs=0.1)
    assert found["landed on"] > ORDERS[scheme] - 0.2
    assert found["stepped over"] < 3.0
    stored = json.loads(evidence.RESULT.read_text())["schemes"][scheme]["order"]
    assert stored["smooth"] == pytest.approx(found["smooth"], abs=0.02)
    assert stored["landed on"] == pytest.approx(found["landed on"], abs=0.2)


def test_stored_result() -> None:
    """It has the command that makes it; what the model's page says of each scheme is what it holds."""
    result = json.loads(evidence.RESULT.read_text())
    assert result["command"] == "python -m tests.tethered_deorbit.evidence.schemes"
    page = Path(package.__file__).with_name("README.md").read_text(encoding="utf-8")
    page = page[page.index("| scheme | order") :].partition("\n\n")[0]
    for scheme, found in result["schemes"].items():
        (row,) = [line.split(" | ") for line in page.splitlines() if line.startswith(f"| `{scheme}` | ")]
        assert row[1] == ", ".join(f"{found['order'][kind]:.1f}" for kind in ("smooth", "landed on", "stepped over"))
        assert float(row[4]) == pytest.approx(result["cost_of_a_step"][scheme], rel=0.1)
    stiff = {(row["scheme"], row["tolerances"]): row for row in result["stiff"]["rows"]}
    fast, slow = stiff["radau", "default"], stiff["dop853", "default"]
    assert fast["cpu_s"] < 0.1 * slow["cpu_s"]
    assert fast["error_of_mean_tension"] < 1e-6
    drift = {scheme: found["drift"] for scheme, found in result["schemes"].items()}
    for kind in ("whirling", "from tug to tug"):
        assert abs(drift["gauss"][kind]["per_day"]) < 0.01 * abs(drift["dop853"][kind]["per_day"])
