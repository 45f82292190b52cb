"""Faults put on purpose into parts that came later: a conducting line, contact by a spring, bent threads, the hull."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from dcone_cosim.criteria import Evidence
from dcone_cosim.phases.capture_criteria import criteria as of_capture
from dcone_cosim.phases.removal_criteria import criteria as of_removal
from fmu_src.tethered_deorbit.interface import MODEL
from tests.plain import PlainInstance, plain
from tests.tethered_deorbit import low

__all__ = ["plain"]
CONDUCTING = {"reel": "locked", "electrodynamic": "dipole"}
LINE = {
    "start.condition": 3, "start.relative_position[1]": 4990.0, "tether.rest_length": 5000.0,
    "orbit.epoch": low.EPOCH, "orbit.altitude": 500e3, "orbit.inclination": 0.9, "tether.youngs_modulus": 1e9,
    "electrodynamic.resistance": 150.0,
}  # fmt: skip


def conducted(**values: float) -> Evidence:
    """Twenty minutes of a line that conducts, soft so that its steps are long."""
    i = PlainInstance(MODEL, CONDUCTING, LINE | {name.replace("__", "."): value for name, value in values.items()})
    outputs = [n for n, _, v, _ in i.interface.scalars() if v.causality == "output"]
    settable = [n for n, _, v, _ in i.interface.scalars() if v.causality in ("parameter", "input")]
    rows = []
    for _ in range(11):
        rows.append([i.time, *(i[name] for name in outputs)])
        i.step(120.0)
    columns = dict(zip(("time", *outputs), np.array(rows, dtype=float).T, strict=True))
    terms = {**CONDUCTING, "environment": "central", "target": "point", "chaser": "point"}
    return Evidence(columns, {name: float(i[name]) for name in settable}, terms, 1200.0)


def red(criteria: Callable[[Evidence], Any], evidence: Evidence, of: set[str]) -> set[str]:
    """Of these criteria those that are broken; all of them were looked at."""
    found = {one.key: one for one in criteria(evidence) if one.key in of}
    assert found.keys() == of
    return {key for key, one in found.items() if not one.value <= one.stable}


@pytest.mark.usefixtures("plain")
def test_a_current_that_flows_the_wrong_way_is_red() -> None:
    """It would drive the pair on: a resistance below zero, which no scene can have. So is a work a fifth too large."""
    asked = {"generates", "orbit_taken"}
    sound = conducted()
    assert float(np.abs(sound.columns["electrodynamic.orbit_power"]).min()) > 1.0
    assert red(of_removal, sound, asked) == set()
    assert red(of_removal, conducted(electrodynamic__resistance=-150.0), asked) == {"generates"}
    columns = dict(sound.columns)
    columns["electrodynamic.orbit_power"] = 1.2 * columns["electrodynamic.orbit_power"]
    assert red(of_removal, Evidence(columns, sound.values, sound.terms, 1200.0), asked) == {"orbit_taken"}


def wrapped(**changed: Any) -> Evidence:
    """What a run with contact, bent threads and an index tells at three instants: a ball's hull, one metre off."""
    radius = np.array([2.0, 1.5, 1.2])
    columns: dict[str, Any] = {
        "time": np.array([0.0, 1.0, 2.0]),
        "energy.kinetic": np.full(3, 9.0),
        "energy.remainder": np.zeros(3),
        "contact.loss": np.array([0.0, 1.0, 2.0]),
        "wrap.passed": np.zeros(3),
        "wrap.passed_slack": np.zeros(3),
        "quality.hull_volume": 4.0 / 3.0 * np.pi * radius**3,
        "quality.hull_surface": 4.0 * np.pi * radius**2,
        "quality.offset": np.ones(3),
        **{f"catch.position[{axis}]": np.full(3, float(axis == 2)) for axis in (1, 2, 3)},
        **{f"target.position[{axis}]": np.zeros(3) for axis in (1, 2, 3)},
    }
    columns |= {name.replace("__", "."): value for name, value in changed.items()}
    terms: Mapping[str, str] = {"contact": "penalty", "gravity": "hill"}
    return Evidence(columns, {}, terms, 2.0)


@pytest.mark.parametrize(
    ("changed", "broken"),
    [
        ({}, set()),
        ({"contact__loss": np.array([0.0, 1.0, 0.8])}, {"contact_takes"}),
        ({"wrap__passed": np.array([0.0, 0.0, 1.0])}, {"through"}),
        ({"wrap__passed_slack": np.array([0.0, 0.0, 1.0])}, {"through"}),
        ({"quality__hull_volume": np.array([34.0, 14.0, 7.0])}, {"hull"}),
        ({"quality__hull_volume": np.array([33.0, 14.0, -7.0])}, {"hull"}),
        ({"quality__offset": np.array([1.0, 1.0, 1.001])}, {"offset"}),
    ],
)
def test_what_gives_energy_goes_through_or_is_of_no_body_is_red(changed: dict[str, Any], broken: set[str]) -> None:
    """A dashpot of the wrong sign gives back what it took; a hull fuller than a ball, or turned inside out."""
    asked = {"contact_takes", "through", "hull", "offset"}
    assert red(of_capture, wrapped(**changed), asked) == broken
