"""The field by its coefficients against ppigrf's own, with no network."""

from __future__ import annotations

import datetime
import socket
import sys
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.interface import Undesigned
from fmu_src.tethered_deorbit import field_table
from fmu_src.tethered_deorbit.environment.electrodynamic import make_igrf, point_greenwich
from fmu_src.tethered_deorbit.interface import MODEL
from orbital.sky import greenwich_angle
from tests.plain import plain
from tests.tethered_deorbit import low
from tests.validation import Validated, other_code

__all__ = ["plain"]
TERMS = {"reel": "locked", "electrodynamic": "igrf"}


def by_ppigrf(place: Any) -> Any:
    """In axes that turn with the Earth [T]."""
    from ppigrf import igrf_gc

    r = np.linalg.norm(place)
    theta, phi = np.arccos(place[2] / r), np.arctan2(place[1], place[0])
    date = datetime.datetime(2000, 1, 1, 12) + datetime.timedelta(seconds=low.EPOCH)
    radial, south, east = (
        float(np.ravel(part)[0]) for part in igrf_gc(r / 1e3, np.degrees(theta), np.degrees(phi), date)
    )
    s, c, u, v = np.sin(theta), np.cos(theta), np.sin(phi), np.cos(phi)
    return 1e-9 * (
        radial * np.array([s * v, s * u, c]) + south * np.array([c * v, c * u, -s]) + east * np.array([-u, v, 0.0])
    )


@pytest.mark.usefixtures("plain")
def test_the_field_is_that_of_ppigrf(validated: Validated, monkeypatch: pytest.MonkeyPatch) -> None:
    """To 0.3 % at 500 to 1200 km, of which the degrees beyond ten are most; in turned axes as well."""
    pytest.importorskip("ppigrf")

    def refused(*_: Any, **__: Any) -> Any:
        raise AssertionError("nothing is downloaded")

    monkeypatch.setattr(socket, "socket", refused)
    rows = field_table.table(low.EPOCH)
    igrf = make_igrf(lambda record: rows)
    record = MODEL.interface(TERMS).make_record().view(np.recarray)
    record["orbit_epoch"] = low.EPOCH
    rng, off = np.random.default_rng(5), []
    for k in range(40):
        way = rng.normal(size=3)
        place = way / np.linalg.norm(way) * rng.uniform(6.87e6, 7.57e6)
        time, elapsed = float(rng.uniform(0.0, 5000.0)), 30.0 * (k % 2)
        turning = np.array([2e-3, -3e-3, 1e-3])
        record["state_turning"][0] = turning
        back = Rotation.from_rotvec(turning * elapsed)
        record.state_pole[0] = back.inv().apply([0.0, 0.0, 1.0])
        point_greenwich(record, time, elapsed)
        igrf(record, back.inv().apply(place))
        earth = Rotation.from_euler("z", greenwich_angle(low.EPOCH + time, low.EPOCH))
        expected = earth.apply(by_ppigrf(earth.inv().apply(place)))
        found = back.apply(record.state_field[0])
        off.append(np.linalg.norm(found - expected) / np.linalg.norm(expected))
    validated(other_code("ppigrf"), "the Earth's field at 40 places: what it is off by", off, 0.0, "1", abs=3e-3)


def test_what_it_cannot_know_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("ppigrf")
    with pytest.raises(Undesigned, match=r"orbit\.epoch.*1900 to 2030"):
        field_table.table(1.2e9)
    monkeypatch.setitem(sys.modules, "ppigrf", None)
    with pytest.raises(Undesigned, match=r"pip install 'dcone-cosim\[field\]'"):
        field_table.table(low.EPOCH)
