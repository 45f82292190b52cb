"""The table of the air against pymsis itself, at places and times of its own, with no network."""

from __future__ import annotations

import socket
from typing import Any

import numpy as np
import pytest
from astropy import units
from astropy.coordinates import EarthLocation

from fmu_src.interface import Undesigned
from fmu_src.tethered_deorbit import air_table
from fmu_src.tethered_deorbit.environment.msis import make_density
from fmu_src.tethered_deorbit.interface import MODEL
from orbital.constants import EARTH_EQUATORIAL_RADIUS
from orbital.sky import greenwich_angle, sun_place
from tests.plain import plain
from tests.tethered_deorbit import low
from tests.validation import Validated, other_code

__all__ = ["plain"]
J2000 = np.datetime64("2000-01-01T12:00:00")


def by_pymsis(time: Any, longitude: Any, latitude: Any, altitude: Any) -> Any:
    """Degrees, km; [kg/m^3]."""
    import pymsis

    n = len(time)
    dates = J2000 + np.round(time).astype("timedelta64[s]")
    out = pymsis.calculate(
        dates,
        longitude,
        latitude,
        altitude,
        f107s=np.full(n, 150.0),
        f107as=np.full(n, 140.0),
        aps=np.full((n, 7), 12.0),
    )
    return out[:, 0]


def over_ellipsoid(east: float, north: float, height: float) -> Any:
    """Place from the centre [m], by astropy: geodetic [rad], [m]."""
    at = EarthLocation.from_geodetic(east * units.rad, north * units.rad, height * units.m)
    return np.array([axis.to_value("m") for axis in at.geocentric])


@pytest.mark.parametrize("height", [100e3, 400e3, 1000e3])
def test_height_over_the_ellipsoid(height: float) -> None:
    for north in np.radians([-90.0, -51.0, 0.0, 12.0, 45.0, 89.0]):
        x, _, z = over_ellipsoid(0.0, north, height)
        up, radius = np.arctan2(z, x), np.hypot(x, z)
        assert air_table.geodetic(up, radius) == pytest.approx((north, height), rel=1e-9, abs=1e-9)
        assert radius - air_table.ground(up) == pytest.approx(height, abs=6.0)


def test_mean_over_a_polar_orbit() -> None:
    """As `orbital.decay` asks for it, by the distance from the centre: against places of such an orbit of its own."""
    pytest.importorskip("pymsis")
    indices = {"air.f107": 150.0, "air.f107_average": 140.0, "air.ap": 12.0}
    profile = air_table.mean_profile(indices | {"orbit.epoch": low.EPOCH, "orbit.inclination": np.pi / 2.0})
    rng, n = np.random.default_rng(5), 2000
    north, radius = rng.uniform(-np.pi, np.pi, n), EARTH_EQUATORIAL_RADIUS + 400e3
    at = EarthLocation.from_geocentric(radius * np.cos(north), np.zeros(n), radius * np.sin(north), unit="m")
    time, longitude = low.EPOCH + rng.uniform(0.0, 86400.0, n), rng.uniform(-180.0, 180.0, n)
    expected = by_pymsis(time, longitude, at.lat.deg, at.height.to_value("km"))
    assert profile(np.array([400e3]))[0] == pytest.approx(float(np.mean(expected)), rel=0.03)


@pytest.mark.usefixtures("plain")
def test_density_is_that_of_pymsis(validated: Validated, monkeypatch: pytest.MonkeyPatch) -> None:
    """At 400 places and times of the epoch's day: 10 % at most beside what it says of longitude, 3 % in the mean. The
    Sun stands where it does, so that noon, east and north are what they are."""

    def refused(*_: Any, **__: Any) -> Any:
        raise AssertionError("nothing is downloaded")

    monkeypatch.setattr(socket, "socket", refused)
    rows = low.table()
    rng, n = np.random.default_rng(3), 400
    time = low.EPOCH + rng.uniform(-8e3, 7.6e4, n)
    longitude, latitude = rng.uniform(-180.0, 180.0, n), np.degrees(np.arcsin(rng.uniform(-1.0, 1.0, n)))
    altitude = rng.uniform(105.0, 995.0, n)
    expected = by_pymsis(time, longitude, latitude, altitude)
    density = make_density(lambda record: rows)
    record = MODEL.interface(low.TERMS).make_record().view(np.recarray)
    record.state_pole[0] = 0.0, 0.0, 1.0
    found = np.zeros(n)
    for k in range(n):
        sun_place(record.state_sun[0], float(time[k]), low.EPOCH)
        east = greenwich_angle(float(time[k]), low.EPOCH) + np.radians(longitude[k])
        up = np.radians(latitude[k])
        found[k] = density(record, over_ellipsoid(east, up, 1e3 * altitude[k]))
    off = np.log(found / expected)
    mean = float(np.exp(np.mean(off)))
    validated(other_code("pymsis"), "density at 400 places, 105 to 995 km: mean ratio", mean, 1.0, "1", abs=0.01)
    assert np.abs(off).max() < 0.2
    assert np.sqrt(np.mean(off**2)) < 0.045
    night = np.exp(rows[31, 0])
    assert found.min() < night < found.max()


@pytest.mark.usefixtures("plain")
def test_beyond_the_table_it_goes_on_straight() -> None:
    rows, record = low.table(), MODEL.interface(low.TERMS).make_record().view(np.recarray)
    record.state_pole[0], record.state_sun[0] = (0.0, 0.0, 1.0), (1e11, 0.0, 3e10)
    density = make_density(lambda record: rows)

    def at(height: float) -> float:
        way = np.array([0.6, 0.5, 0.6244997998])
        ground = air_table.ground(np.arcsin(way[2:]))[0]
        return float(np.log(density(record, way * (ground + height))))

    for edge, step in ((100e3, -1e3), (1000e3, 1e3)):
        slope = (at(edge + 1e-3 * step) - at(edge)) / 1e-3
        inside = (at(edge) - at(edge - 1e-3 * step)) / 1e-3
        assert slope == pytest.approx(inside, rel=1e-3)
        assert at(edge + 20.0 * step) - at(edge) == pytest.approx(20.0 * slope, rel=1e-3)


def test_a_tow_in_this_air() -> None:
    """The FMU's own kernel reads the same table; the drag is that of it."""
    i = low.tow(electrodynamic__electron_density=0.0)
    start = i["center.semi_major_axis"]
    for _ in range(4):
        i.step(1500.0)
        time = np.array([low.EPOCH + i.time])
        x = i.array("center_position")
        at = EarthLocation.from_geocentric(*x, unit="m")
        east = np.degrees(np.arctan2(x[1], x[0]) - greenwich_angle(float(time[0]), low.EPOCH))
        expected = by_pymsis(
            time, np.array([east % 360.0]), np.array([at.lat.deg]), np.array([at.height.to_value("km")])
        )
        assert i["air.density"] == pytest.approx(float(expected[0]), rel=0.12)
    assert i["electrodynamic.current"] == 0.0
    assert 0.0 < start - i["center.semi_major_axis"] < 200.0


def test_without_pymsis_it_says_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "pymsis", None)
    with pytest.raises(Undesigned, match=r"pip install 'dcone-cosim\[air\]'"):
        air_table.table(low.EPOCH, 150.0, 150.0, 15.0)
