"""Sun, Moon and Greenwich against astropy's built-in ephemeris, which needs no file."""

from __future__ import annotations

from typing import Any

import erfa
import numpy as np
import pytest
from astropy.coordinates import get_body_barycentric, solar_system_ephemeris
from astropy.time import Time, TimeDelta
from astropy.utils import iers

from orbital.sky import greenwich_angle, moon_place, sun_place

J2000 = Time("2000-01-01 12:00", scale="utc")
STARTS = ("1975-03-01", "2026-11-30", "2049-06-01")
DAY = 86400.0


def seconds(time: Any) -> Any:
    """UTC since J2000, in days of 86400 s."""
    return ((time.utc.jd1 - J2000.jd1) + (time.utc.jd2 - J2000.jd2)) * DAY


def true_place(body: str, times: Any, epoch: Any) -> Any:
    with solar_system_ephemeris.set("builtin"):
        there, here = (get_body_barycentric(name, times) for name in (body, "earth"))
    turn = erfa.pmat06(epoch.tt.jd1, epoch.tt.jd2)
    return (turn @ (there.xyz - here.xyz).to_value("m")).T


@pytest.mark.filterwarnings("ignore:.*dubious year")
@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize(
    ("body", "place", "most", "mean"), [("sun", sun_place, 0.0105, 0.005), ("moon", moon_place, 0.02, 0.008)]
)
def test_sun_and_moon_stand_where_astropy_has_them(body: str, place: Any, most: float, mean: float, start: str) -> None:
    with iers.conf.set_temp("auto_download", False):
        epoch = Time(start, scale="utc")
        times = epoch + TimeDelta(np.random.default_rng(7).uniform(0.0, 3.0 * 365.25, 400) * DAY, format="sec")
        expected = true_place(body, times, epoch)
    found = np.zeros((400, 3))
    for row, time in zip(found, seconds(times), strict=True):
        place(row, time, float(seconds(epoch)))
    far, true = np.linalg.norm(found, axis=1), np.linalg.norm(expected, axis=1)
    chord = np.linalg.norm(found / far[:, None] - expected / true[:, None], axis=1)
    off = np.degrees(2.0 * np.arcsin(0.5 * chord))
    assert off.max() < most
    assert np.sqrt(np.mean(off**2)) < mean
    assert np.max(np.abs(far / true - 1.0)) < 1.2e-4


def test_greenwich_turns_as_astropy_has_it() -> None:
    with iers.conf.set_temp("auto_download", False), iers.conf.set_temp("auto_max_age", None):
        for start in ("2010-01-01", "2026-03-20"):
            epoch = Time(start, scale="utc")
            times = epoch + TimeDelta(np.linspace(0.0, 90.0, 31) * DAY, format="sec")
            expected = times.sidereal_time("mean", "greenwich").rad
            found = np.array([greenwich_angle(float(t), float(seconds(epoch))) for t in seconds(times)])
            off = np.degrees(np.remainder(found - expected + np.pi, 2.0 * np.pi) - np.pi)
            assert np.abs(off).max() < 0.015
