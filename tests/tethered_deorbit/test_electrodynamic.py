"""A line that conducts: power, forces on its ends, and what they do to the orbit."""

from __future__ import annotations

import numpy as np
import pytest
from astropy.time import Time, TimeDelta
from astropy.utils import iers
from scipy.spatial.transform import Rotation

from fmu_src.tethered_deorbit.environment.perturbed import make_perturbing
from fmu_src.tethered_deorbit.interface import MODEL
from orbital.constants import EARTH_ROTATION_RATE
from tests.plain import plain
from tests.tethered_deorbit import low
from tests.validation import Validated, other_code

__all__ = ["plain"]
SPIN = np.array([0.0, 0.0, EARTH_ROTATION_RATE])
MASSES = np.array([2000.0, 1000.0])
STATE = np.array([5e6, -4e6, 3e6, 5e3, 5e3, -1e3, 3e3, -1e3, 4e3, 0.01, 0.02, -0.005])


def field(place: np.ndarray, seconds: float) -> np.ndarray:
    """The dipole of IGRF-13 by its potential, with Greenwich by astropy."""
    with iers.conf.set_temp("auto_download", False), iers.conf.set_temp("auto_max_age", None):
        at = Time("2000-01-01 12:00", scale="utc") + TimeDelta(low.EPOCH + seconds, format="sec")
        # the model counts days of 86400 s: five leap seconds since
        at = at + TimeDelta(5.0, format="sec")
        angle = at.sidereal_time("mean", "greenwich").rad
    turn = Rotation.from_euler("z", angle)
    x, g = turn.inv().apply(place), np.array([-1450.9e-9, 4652.5e-9, -29404.8e-9])
    r = np.linalg.norm(x)
    return turn.apply((6371.2e3 / r) ** 3 * (3.0 * (g @ x) * x / r**2 - g))


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize("resistance", [100.0, 2000.0])
def test_forces_on_both_ends(resistance: float) -> None:
    """Each end bears half of I rho x B; the power of it against the turning air is -I E. In turned axes the same."""
    terms = {"reel": "locked", "electrodynamic": "dipole"}
    found = []
    for turning, elapsed in ((np.zeros(3), 0.0), (np.array([2e-3, -3e-3, 1e-3]), 40.0)):
        record = MODEL.interface(terms).make_record()
        record["state_total_mass"] = 3000.0
        record["state_chaser_share"], record["state_target_share"] = MASSES / 3000.0
        record["state_turning"][0], record["state_begin"] = turning, 500.0 - elapsed
        record["orbit_epoch"], record["electrodynamic_resistance"] = low.EPOCH, resistance
        back = Rotation.from_rotvec(turning * elapsed)
        there, rate = back.inv().apply(STATE.reshape(-1, 3)).ravel(), np.zeros(12)
        make_perturbing(MODEL.interface(terms)).add(record.view(np.recarray), there, rate, elapsed, elapsed)
        found.append(back.apply(rate.reshape(-1, 3)).ravel())
    assert found[1] == pytest.approx(found[0], rel=1e-9, abs=1e-18)
    center, apart, share = found[0][3:6], found[0][9:12], MASSES / 3000.0
    force = np.array([MASSES[0] * (center - share[1] * apart), MASSES[1] * (center + share[0] * apart)])
    assert force[0] == pytest.approx(force[1], rel=1e-12)
    chaser, target = STATE[0:3] - share[1] * STATE[6:9], STATE[0:3] + share[0] * STATE[6:9]
    speeds = STATE[3:6] - share[1] * STATE[9:12], STATE[3:6] + share[0] * STATE[9:12]
    middle, velocity = 0.5 * (chaser + target), 0.5 * (speeds[0] + speeds[1])
    b, wind = field(middle, 500.0), velocity - np.cross(SPIN, middle)
    emf = np.cross(wind, b) @ STATE[6:9]
    current = np.sign(emf) * min((abs(emf) - 30.0) / resistance, 1.2110807)
    total = force.sum(axis=0)
    assert total == pytest.approx(current * np.cross(STATE[6:9], b), rel=1e-4, abs=1e-6)
    assert total @ wind == pytest.approx(-current * emf, rel=1e-4)
    assert total @ wind < -50.0
    assert (abs(current) == 1.2110807) == (resistance == 100.0)


def test_what_it_takes_from_the_orbit(validated: Validated) -> None:
    """Energy that the orbit loses in a third of a revolution: the work of the force at the middle of the line, by
    Simpson's rule over what is told, the power told and that worked out; and nothing once the line is cut."""
    i = low.tow(air__chaser_area=0.0, air__target_area=0.0, release__at=2400.0)
    work, energy, lost = [], [i["energy.orbital"]], []
    for _ in range(41):
        r_c, r_t = i.array("chaser_position"), i.array("target_position")
        middle, velocity = 0.5 * (r_c + r_t), 0.5 * (i.array("chaser_velocity") + i.array("target_velocity"))
        b = field(middle, i.time)
        wind = velocity - np.cross(SPIN, middle)
        emf = np.cross(wind, b) @ (r_t - r_c)
        assert i["electrodynamic.emf"] == pytest.approx(emf, rel=1e-4)
        assert i["electrodynamic.field"] == pytest.approx(np.linalg.norm(b), rel=1e-4)
        force = i["electrodynamic.current"] * np.cross(r_t - r_c, b)
        assert i["electrodynamic.power"] == pytest.approx(-force @ wind, rel=1e-4)
        assert i["electrodynamic.force"] == pytest.approx(np.linalg.norm(force), rel=1e-4)
        lost.append(i["electrodynamic.orbit_power"])
        work.append(float(force @ i.array("center_velocity")))
        if len(work) < 41:
            i.step(59.9)
            energy.append(i["energy.orbital"])
    weights = np.array([1.0, *[4.0, 2.0] * 19, 4.0, 1.0]) * 59.9 / 3.0
    simpson = weights @ np.array(work)
    assert energy[0] - energy[-1] == pytest.approx(weights @ np.array(lost), rel=2e-2)
    gained = energy[-1] - energy[0]
    work_of = other_code("work of I l x B by Simpson's rule, field and Greenwich by astropy")
    validated(work_of, "conducting line: what it takes from the orbit", gained, simpson, "J", rel=2e-2)
    assert simpson < -1e6
    i.step(60.0)
    assert i["release.released"]
    assert i["electrodynamic.current"] == 0.0
    assert i["electrodynamic.force"] == 0.0
